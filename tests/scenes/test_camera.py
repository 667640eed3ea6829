import numpy as np
import pytest

from scenes import Camera, Scene, SceneError, loads


def test_the_frame_looks_at_the_point_with_up_in_its_plane() -> None:
    camera = Camera(position=(0.0, 3.0, 4.0), look_at=(0.0, 0.0, 0.0), fov_deg=40.0)
    right, up, backward = camera.frame()
    np.testing.assert_allclose(right, [1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(up, [0.0, 0.8, -0.6], atol=1e-15)
    np.testing.assert_allclose(backward, [0.0, 0.6, 0.8], atol=1e-15)


def test_a_camera_that_looks_at_itself() -> None:
    with pytest.raises(SceneError, match="look_at: must be a point other than the camera's"):
        Camera(position=(1.0, 2.0, 3.0), look_at=(1.0, 2.0, 3.0 + 1e-12), fov_deg=40.0)


def test_a_camera_with_up_along_its_line_of_sight() -> None:
    with pytest.raises(SceneError, match="up: must be a direction not parallel"):
        Camera(position=(0.0, 2.0, 0.0), look_at=(0.0, 0.0, 0.0), fov_deg=40.0)


@pytest.mark.parametrize("fov_deg", [0.0, 180.0, -1.0, float("nan"), float("inf")])
def test_a_field_of_view_that_is_none(fov_deg: float) -> None:
    with pytest.raises(SceneError, match="fov_deg: must be"):
        Camera(position=(0.0, 2.0, 1.0), look_at=(0.0, 0.0, 0.0), fov_deg=fov_deg)


VIEW = {"position": (0.0, 0.0, 0.0), "look_at": (0.0, 0.0, -2.0), "fov_deg": 40.0}


def test_a_camera_is_a_pinhole_unless_it_has_an_aperture() -> None:
    assert Camera(**VIEW).lens_radius == 0.0
    assert Camera(**VIEW, aperture_radius=0.0).lens_radius == 0.0
    assert Camera(**VIEW, aperture_radius=0.01).lens_radius == 0.01


def test_an_f_number_is_focal_length_over_diameter() -> None:
    camera = Camera(**VIEW, f_number=2.8, focus_distance=1.5, sensor_height=0.036)
    # v = h / (2 tan(fov/2)) and 1/f = 1/s + 1/v: Hecht (2017), *Optics*, §5.2.3.
    image_distance = 0.018 / np.tan(np.radians(20.0))
    focal_length = image_distance * 1.5 / (image_distance + 1.5)
    assert camera.focal_length == pytest.approx(focal_length, rel=1e-14)
    assert camera.lens_radius == pytest.approx(focal_length / 5.6, rel=1e-14)


def test_a_lens_is_focused_on_what_it_looks_at_unless_told_otherwise() -> None:
    assert Camera(**VIEW, aperture_radius=0.01).sharp_distance == 2.0
    assert Camera(**VIEW, aperture_radius=0.01, focus_distance=3.0).sharp_distance == 3.0


@pytest.mark.parametrize("aperture", [{}, {"aperture_radius": 0.0}])
def test_a_pinhole_with_a_focus(aperture: dict[str, float]) -> None:
    with pytest.raises(SceneError, match="focus_distance: must be left out, or an aperture_radius"):
        Camera(**VIEW, focus_distance=1.0, **aperture)


def test_two_apertures() -> None:
    with pytest.raises(SceneError, match="f_number: allowed: aperture_radius or f_number"):
        Camera(**VIEW, aperture_radius=0.01, f_number=2.0)


def test_a_negative_aperture() -> None:
    with pytest.raises(SceneError, match="aperture_radius: must be"):
        Camera(**VIEW, aperture_radius=-0.01)


def test_a_lens_survives_being_written_and_read() -> None:
    scene = Scene(camera=Camera(**VIEW, f_number=2.0, focus_distance=1.0))
    assert loads(scene.to_toml()).camera == scene.camera


def test_a_lens_in_millimetres() -> None:
    text = 'length_unit = "mm"\n[camera]\nposition = [0.0, 0.0, 0.0]\nlook_at = [0.0, 0.0, -1.0]\n'
    camera = loads(text + "fov_deg = 40.0\naperture_radius = 5.0\nfocus_distance = 250.0\n").camera
    assert camera is not None
    assert (camera.lens_radius, camera.sharp_distance, camera.sensor_height) == (0.005, 0.25, 0.024)
