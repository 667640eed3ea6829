"""In light that is the same from everywhere, everything that swallows nothing looks the same."""

import itertools

import numpy as np
import pytest

import scenes
import sim

RADIANCE = 2.0
FILM = {"first_nm": 450.0, "last_nm": 650.0, "bands": 3}
SKY = scenes.Environment(radiance=RADIANCE, spectrum="E")
SPECTRAL = RADIANCE / (830.0 - 360.0)
"""Per nanometre: "E" spreads it evenly over 360 to 830 nm."""

FLINT = scenes.Dielectric(medium="SF11")
BALL = scenes.SceneObject(
    name="ball", shape=scenes.Sphere(position=(0.0, 0.5, 0.0), radius=0.3), material=FLINT
)
WHITE = scenes.SceneObject(
    name="white",
    shape=scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=0.05),
    material=scenes.Lambertian(reflectance=1.0),
)
PLATE = scenes.SceneObject(
    name="plate",
    shape=scenes.Box(
        position=(0.0, 0.3, 0.0), size=(0.6, 0.05, 0.6), rotation_deg=(0.0, 0.0, 20.0)
    ),
    material=FLINT,
)


def render(objects, camera, *, size, **settings):
    width, height = size
    scene = scenes.Scene(
        objects=objects, emitters=(SKY,), camera=camera,
        film=scenes.Film(width=width, height=height, **FILM),
    )
    return sim.render(scene, sim.RenderSettings(**settings))


def assert_furnace(picture, expected, assert_mean, *, slack=0.0):
    """The mean over all pixels, by the spread of the pixels, which are independent."""
    found = picture.spectral_radiance.reshape(-1, FILM["bands"]) / expected
    assert_mean(found, 1.0, slack=slack)
    assert abs(picture.energy.residual) < 1e-12


def test_lossless_glass_is_invisible(assert_mean):
    camera = scenes.Camera(position=(0.0, 0.5, 2.0), look_at=(0.0, 0.5, 0.0), fov_deg=15.0)
    # There is nothing diffuse: the sky is all that is to be seen.
    picture = render((BALL,), camera, size=(60, 60), photons=100, passes=2)
    assert_furnace(picture, SPECTRAL, assert_mean)
    # Not in the mean alone: but for chance, which ends or doubles faint branches, everywhere.
    found = picture.spectral_radiance / SPECTRAL
    assert np.percentile(np.abs(found - 1.0), 90) < 0.1


def test_radiance_in_glass_is_its_index_squared_times_that_outside(assert_mean):
    # Radiance over n² is the same along a ray (Born & Wolf 1999, §4.8.1); in the ball's middle
    # every ray meets the surface head on, and what it reflects comes from the other side.
    camera = scenes.Camera(position=(0.0, 0.5, 0.0), look_at=(0.3, 0.7, 0.2), fov_deg=90.0)
    picture = render((BALL,), camera, size=(40, 40), photons=100, passes=2, radius=0.01)
    edges = np.asarray(picture.edges_nm)
    mean_square = [
        np.mean(FLINT.resolved().eta(np.linspace(low, high, 65)) ** 2)
        for low, high in itertools.pairwise(edges)
    ]
    assert_furnace(picture, SPECTRAL * np.array(mean_square), assert_mean)


@pytest.mark.parametrize("direct_light", ["lamps", "photons"])
def test_white_under_glass_is_as_bright_as_the_sky(assert_mean, direct_light):
    # E = π L from above, through the plate or past it, and ρ = 1 sends L back. What the disk sees
    # of itself in the plate, 0.6 m away, is less than R (0.05/0.6)² of that: 1.1e-3.
    camera = scenes.Camera(
        position=(0.0, 0.15, 0.05), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=5.0
    )
    pictures = [
        render(
            (PLATE, WHITE), camera, size=(4, 4), photons=30_000, passes=1, radius=0.02, seed=seed,
            direct_light=direct_light,
        )
        for seed in range(16)
    ]
    found = np.array([one.spectral_radiance.mean(axis=(0, 1)) for one in pictures]) / SPECTRAL
    assert_mean(found, 1.0, slack=1.1e-3)
    assert np.std(found[:, 1]) < 0.1
    assert all(abs(one.energy.residual) < 1e-12 for one in pictures)


def test_white_things_that_light_one_another_are_as_bright_as_the_sky(assert_mean):
    # ρ = 1 everywhere: whatever light meets on its way, it sends on all of it, and L is the same
    # everywhere. The two balls and the glass between them see each other, so that it takes bounces.
    white = scenes.Lambertian(reflectance=1.0)
    balls = tuple(
        scenes.SceneObject(shape=scenes.Sphere(position=(x, 0.5, 0.0), radius=0.3), material=white)
        for x in (-0.62, 0.62)
    )
    # Straight at a place on the left ball that the glass and the right ball take much sky from.
    camera = scenes.Camera(position=(-0.4, 0.5, 1.5), look_at=(-0.42, 0.5, 0.22), fov_deg=3.0)
    pictures = [
        render(
            (BALL, *balls), camera, size=(4, 4), photons=30_000, passes=1, radius=0.02, seed=seed,
            bounces=bounces,
        )
        for bounces in (100, 0)
        for seed in range(8)
    ]
    found = np.array([one.spectral_radiance.mean(axis=(0, 1)) for one in pictures]) / SPECTRAL
    assert_mean(found[:8], 1.0, slack=1e-3)
    assert found[8:].mean() < 0.97  # without bounces it is darker: the test can tell
    assert all(abs(one.energy.residual) < 1e-12 for one in pictures)
