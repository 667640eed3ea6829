"""A point of the scene appears where perspective puts it, and glass shifts it as it should."""

import numpy as np
import pytest

import scenes
from sim.analytic import plate_lateral_shift

WIDTH, HEIGHT, PASSES = 60, 40, 32
ETA, THICKNESS, TILT_DEG = 1.5, 0.4, (15.0, 0.0, -30.0)
RADIUS = 0.07

CAMERA = scenes.Camera(
    position=(0.3, 3.0, 1.2), look_at=(0.1, 0.0, 0.0), up=(0.3, 1.0, 0.0), fov_deg=20.0
)


def make_plate(position):
    return scenes.SceneObject(
        name="plate",
        shape=scenes.Box(position=position, size=(1.5, THICKNESS, 1.5), rotation_deg=TILT_DEG),
        material=scenes.Dielectric(
            medium=scenes.SellmeierMedium(
                b=(ETA**2 - 1.0,), c_um2=(0.0,), range_nm=(300.0, 900.0)
            )
        ),
    )


def pixel_of(target, camera=CAMERA):
    """Pixel coordinates (x, y) of a point, (0, 0) being the upper left corner of the picture.

    With (a, b, c) the point in the camera's frame (right, up, back), x = w/2 + f a/(−c) and
    y = h/2 − f b/(−c), f = h / (2 tan(fov/2)).
    """
    a, b, c = np.stack(camera.frame()) @ (np.asarray(target) - camera.position)
    f = 0.5 * HEIGHT / np.tan(0.5 * np.radians(camera.fov_deg))
    return np.array([0.5 * WIDTH - f * a / c, 0.5 * HEIGHT + f * b / c])


def centroid(room):
    """Centre of the light in the picture, in pixel coordinates."""
    film = room.create_film(width=WIDTH, height=HEIGHT, passes=PASSES)
    for index in range(PASSES):
        room.expose(film, CAMERA, index)
    light = film.radiance().sum(axis=2)
    # The whole spot is in the picture.
    assert 10 < (light > 0.0).sum() < 100
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    return np.array([(light * x).sum(), (light * y).sum()]) / light.sum()


def make_room(darkroom, target, plate_at):
    """A white disk that faces the camera, lit from aside, below the plate."""
    toward = np.array(CAMERA.position) - target
    disk = scenes.SceneObject(
        name="disk",
        shape=scenes.Disk(position=tuple(target), normal=tuple(toward), radius=RADIUS),
        material=scenes.Lambertian(reflectance=1.0),
    )
    aside = np.array([-1.5, 0.6, 0.3])
    beam = scenes.Beam(
        position=tuple(target + aside), direction=tuple(-aside), flux=1.0, spectrum="E",
        profile=scenes.RoundProfile(radius=2.0 * RADIUS),
    )
    scene = scenes.Scene(
        objects=(disk, make_plate(plate_at)), emitters=(beam,),
        film=scenes.Film(first_nm=450, last_nm=650, bands=2),
    )
    return darkroom(scene, photons=3000, radius=0.2 * RADIUS, passes=PASSES)


@pytest.mark.parametrize("target", [(0.1, 0.0, 0.0), (0.6, 0.1, 0.3), (-0.5, -0.1, -0.3)])
def test_a_spot_is_where_perspective_puts_it(darkroom, target):
    room = make_room(darkroom, np.array(target), (9.0, 0.0, 0.0))
    # It is 5 pixels wide: each of its 20 pixels and 4 passes places its edge within 1/√12 pixel.
    np.testing.assert_allclose(centroid(room), pixel_of(target), atol=0.15)


def test_look_at_is_the_middle_of_the_picture():
    np.testing.assert_allclose(pixel_of(CAMERA.look_at), [0.5 * WIDTH, 0.5 * HEIGHT], atol=1e-9)


def test_a_tilted_plate_shifts_the_spot(darkroom):
    target = np.array([0.1, 0.0, 0.0])
    room = make_room(darkroom, target, (0.2, 1.5, 0.6))
    # The ray that ends at the spot is the one that aims beside it by the plate's lateral shift,
    # t sinθ (1 − cosθ / √(η² − sin²θ)) (Born & Wolf 1999, §1.5.1): a fixed point in few steps.
    inward = scenes.rotation_matrix(TILT_DEG) @ [0.0, -1.0, 0.0]
    aim = target
    for _ in range(20):
        way = aim - CAMERA.position
        way /= np.linalg.norm(way)
        toward = inward - (inward @ way) * way
        toward /= np.linalg.norm(toward)
        theta = np.arccos(inward @ way)
        aim = target - plate_lateral_shift(theta, ETA, THICKNESS) * toward
    expected = pixel_of(aim)
    assert np.linalg.norm(expected - pixel_of(target)) > 2.0
    np.testing.assert_allclose(centroid(room), expected, atol=0.15)
