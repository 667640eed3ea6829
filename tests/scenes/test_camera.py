import numpy as np
import pytest

from scenes import Camera, SceneError


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
