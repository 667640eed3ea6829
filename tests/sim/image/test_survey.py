"""The survey finds what pixels see, and how wide they are there."""

import numpy as np
import pytest

import scenes
from sim.analytic import plate_lateral_shift
from sim.device import start_device
from sim.image.camera import compile_camera
from sim.image.survey import survey_view
from sim.scene_data import compile_scene

GROUND = scenes.SceneObject(
    name="ground",
    shape=scenes.Plane(position=(0.0, 0.25, 0.0), normal=(0.0, 1.0, 0.0)),
    material=scenes.Lambertian(reflectance=0.8),
)
CAMERA = scenes.Camera(
    position=(1.0, 2.25, 0.5), look_at=(0.4, 0.25, -0.3), up=(0.2, 1.0, 0.1), fov_deg=30.0
)
ETA, THICKNESS = 1.6, 0.1
TILT_DEG = (10.0, 0.0, 15.0)
WALL_X = 30.0


def make_plate(position):
    return scenes.SceneObject(
        name="plate",
        shape=scenes.Box(position=position, size=(4.0, THICKNESS, 4.0), rotation_deg=TILT_DEG),
        material=scenes.Dielectric(
            medium=scenes.SellmeierMedium(
                b=(ETA**2 - 1.0,), c_um2=(0.0,), range_nm=(300.0, 900.0)
            )
        ),
    )


def survey(*objects, camera=CAMERA, width=300, height=200):
    film = scenes.Film(width=width, height=height)
    scene = scenes.Scene(objects=objects, camera=camera, film=film)
    compiled = compile_scene(scene, device=start_device("cpu"))
    seen = survey_view(compiled, compile_camera(compiled, camera, film), 550.0)
    return seen, seen.points + compiled.origin


def pixel_directions(count, *, camera=CAMERA, width=300, height=200):
    """Unit directions through the centres of count × count parts of the picture, row by row.

    A pixel at (x, y) is (2x/w − 1) tan(fov/2) w/h to the right of the optical axis and
    (1 − 2y/h) tan(fov/2) above it, at unit distance; the camera's frame is (right, up, back).
    """
    right, up, back = camera.frame()
    steps = (np.arange(count) + 0.5) / count
    y, x = np.meshgrid(steps, steps, indexing="ij")
    tangent = np.tan(0.5 * np.radians(camera.fov_deg))
    across = (2.0 * x - 1.0) * tangent * width / height
    above = (1.0 - 2.0 * y) * tangent
    ways = across[..., None] * right + above[..., None] * up - back
    return (ways / np.linalg.norm(ways, axis=-1, keepdims=True)).reshape(-1, 3)


def land(origins, directions):
    """Where rays meet the ground."""
    t = (GROUND.shape.position[1] - origins[..., 1]) / directions[..., 1]
    return origins + t[..., None] * directions


def test_pixels_look_where_perspective_puts_them():
    seen, points = survey(GROUND, make_plate((WALL_X, 0.0, 0.0)))
    ways = pixel_directions(round(np.sqrt(len(points))))
    # Coordinates in the local frame, 30 m from the origin, round by 4e-15.
    np.testing.assert_allclose(points, land(np.array(CAMERA.position), ways), atol=1e-13)
    assert set(seen.objects) == {0}
    assert seen.fraction(0) == 1.0
    assert seen.fraction(1) == 0.0


def test_a_plate_shifts_what_is_behind_it():
    # Sideways by t sinθ (1 − cosθ / √(η² − sin²θ)), toward the plate's normal (Born & Wolf 1999,
    # §1.5.1); the direction stays. One sample in four looks at reflections, which are above.
    plate = make_plate((0.7, 1.4, 0.2))
    _, points = survey(GROUND, plate)
    ways = pixel_directions(round(np.sqrt(len(points) * 4 / 3)))
    inward = scenes.rotation_matrix(TILT_DEG) @ [0.0, -1.0, 0.0]
    cosine = ways @ inward
    toward = inward - cosine[:, None] * ways
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    shift = plate_lateral_shift(np.arccos(cosine), ETA, THICKNESS)
    straight = land(np.array(CAMERA.position), ways)
    expected = land(np.array(CAMERA.position) + shift[:, None] * toward, ways)
    rows, columns = np.divmod(np.arange(len(ways)), round(np.sqrt(len(ways))))
    plain = (rows & columns & 1) == 0
    np.testing.assert_allclose(points, expected[plain], atol=1e-13)
    assert np.linalg.norm(expected - straight, axis=1).min() > 1e-3


def test_widths_are_those_of_discs_of_equal_area():
    # A pixel of solid angle Ω covers Ω d²/cosθ of the ground; a square of that area has its root
    # as width. Ω = (2 tan(fov/2)/h)² cos³ of the angle to the axis.
    seen, points = survey(GROUND, make_plate((WALL_X, 0.0, 0.0)))
    offset = points - CAMERA.position
    d2 = np.sum(offset**2, axis=1)
    back = CAMERA.frame()[2]
    off_axis = -(offset @ back) / np.sqrt(d2)
    pixel = 2.0 * np.tan(0.5 * np.radians(CAMERA.fov_deg)) / 200.0
    ground_cosine = -offset[:, 1] / np.sqrt(d2)
    area = pixel**2 * off_axis**3 * d2 / ground_cosine
    # Rays half a pixel apart see the width of another place: it changes by d log √A/dx, at most
    # 3/2 tanθ + 3/2 tan(off axis) < 4 of a pixel's angle, from one pixel to the next.
    assert pixel < 0.003
    np.testing.assert_allclose(seen.widths, np.sqrt(area), rtol=4.0 * pixel)


def test_pixels_under_glass_are_as_wide_as_its_apparent_depth_says():
    # Straight down through air d and glass t of index η, paraxially, a pixel of the angle p covers
    # p (d + t/η) (Hecht 2017, §4.4.2, apparent depth); at the end of a straight path p (d + t).
    # A pixel enlarged is taken as the geometric mean of both.
    d, t = 1.0, 0.5
    above = scenes.Camera(
        position=(0.0, d + t + 0.25, 0.0), look_at=(0.0, 0.25, 0.0), up=(0.0, 0.0, 1.0),
        fov_deg=2.0,
    )
    slab = make_plate((0.0, 0.25 + 0.5 * t, 0.0))
    shape = scenes.Box(position=(0.0, 0.25 + 0.5 * t, 0.0), size=(4.0, t, 4.0))
    seen, _ = survey(GROUND, slab.model_copy(update={"shape": shape}), camera=above)
    pixel = 2.0 * np.tan(np.radians(1.0)) / 200.0
    expected = pixel * np.sqrt((d + t / ETA) * (d + t))
    # Paraxial up to θ²/2 (1 + 1/η²), θ = 1.8° at the corners, in each factor.
    np.testing.assert_allclose(np.nanmax(seen.width_grid), expected, rtol=1.5e-3)
    np.testing.assert_allclose(np.nanmin(seen.width_grid), expected, rtol=1.5e-3)
    # One sample in four looks at what the glass reflects, the sky.
    assert np.mean(np.isnan(seen.width_grid)) == 0.25


def test_nothing_to_see_is_an_empty_survey():
    up = scenes.Camera(position=(0.0, 1.0, 0.0), look_at=(0.0, 2.0, 0.1), fov_deg=30.0)
    seen, _ = survey(GROUND, make_plate((WALL_X, 0.0, 0.0)), camera=up)
    assert len(seen.widths) == len(seen.points) == len(seen.objects) == 0
    assert seen.fraction(0) == 0.0


def test_objects_are_told_apart():
    # The left half of the picture shows a wall near the camera.
    camera = scenes.Camera(position=(0.0, 1.0, 0.0), look_at=(0.0, 1.0, -1.0), fov_deg=40.0)
    wall = scenes.SceneObject(
        name="wall",
        shape=scenes.Rectangle(position=(-1.0, 1.0, -1.0), size=(2.0, 4.0), normal=(0, 0, 1)),
        material=scenes.Lambertian(reflectance=0.8),
    )
    behind = wall.model_copy(
        update={"name": "behind", "shape": scenes.Rectangle(
            position=(0.0, 1.0, -2.0), size=(9.0, 9.0), normal=(0, 0, 1)
        )}
    )
    seen, points = survey(behind, make_plate((WALL_X, 0.0, 0.0)), wall, camera=camera)
    assert seen.fraction(2) == pytest.approx(0.5)
    assert seen.fraction(0) == pytest.approx(0.5)
    np.testing.assert_allclose(points[seen.objects == 2, 2], -1.0, rtol=1e-12)
    np.testing.assert_allclose(points[seen.objects == 0, 2], -2.0, rtol=1e-12)
