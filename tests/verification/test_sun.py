"""The sun lights a surface with the irradiance that the scene states, and is a disk in the sky."""

import numpy as np
import pytest

import scenes
import sim

IRRADIANCE, HALF_ANGLE_DEG = 5.0, 0.2666
PER_NM = 1.0 / (830.0 - 360.0)
"""Of "E", which is even over 360 to 830 nm."""

FILM = {"first_nm": 500.0, "last_nm": 600.0, "bands": 2}
TILT = np.radians(35.0)
DIRECTION = (float(np.sin(TILT)), float(-np.cos(TILT)), 0.0)
FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0)),
    material=scenes.Lambertian(reflectance=0.7),
)
GLASS = scenes.SceneObject(
    name="ball", shape=scenes.Sphere(position=(-2.0, 0.6, -1.0), radius=0.2),
    material=scenes.Dielectric(medium="N-BK7"),
)  # fmt: skip
DOWN = scenes.Camera(
    position=(0.0, 2.0, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=2.0
)


def sun(**fields):
    return scenes.Sun(
        direction=DIRECTION, irradiance=IRRADIANCE, spectrum="E", **fields
    )


def render(objects, lamp, camera, *, size=(8, 8), **settings):
    film = scenes.Film(width=size[0], height=size[1], **FILM)
    scene = scenes.Scene(objects=objects, emitters=(lamp,), camera=camera, film=film)
    return sim.render(scene, sim.RenderSettings(**settings))


@pytest.mark.parametrize("direct_light", ["lamps", "photons"])
@pytest.mark.parametrize("half_angle_deg", [HALF_ANGLE_DEG, 20.0])
def test_a_floor_reflects_the_suns_irradiance(assert_mean, half_angle_deg, direct_light):
    # E = E₀ cosθ: the mean of the cosine over a cone above the horizon is that of its axis, with
    # E₀ as it is defined. L = ρ E / π.
    expected = 0.7 * IRRADIANCE * np.cos(TILT) / np.pi * PER_NM
    found = [
        render(
            (FLOOR, GLASS), sun(half_angle_deg=half_angle_deg), DOWN,
            photons=40_000, passes=1, radius=0.03, seed=seed, direct_light=direct_light,
        )
        for seed in range(8)
    ]
    means = np.array([one.spectral_radiance.mean(axis=(0, 1)) for one in found])
    assert_mean(means / expected, 1.0)
    assert np.std(means) < 0.05 * expected
    assert all(abs(one.energy.residual) < 1e-12 for one in found)


def test_the_flux_of_its_photons_is_what_comes_through_a_sphere_around_the_scene(assert_mean):
    pictures = [
        render((FLOOR, GLASS), sun(), DOWN, size=(1, 1), photons=20_000, passes=1, seed=seed)
        for seed in range(8)
    ]
    # Around the middle of the bounding box of floor and ball.
    corners = np.array([[-2.2, -0.5 * np.sqrt(0.5), -1.2], [0.5, 0.8, 0.5]])
    emitted = [one.energy.emitted for one in pictures]
    assert np.std(emitted) < 0.1 * np.mean(emitted)
    from sim.scene_data import compile_scene

    radius = compile_scene(pictures[0].scene).bounding_radius
    assert 0.5 * np.linalg.norm(corners[1] - corners[0]) < radius * 1.2
    # E₀ is measured on a surface that faces the axis; every line counts alike here: 1/cos²(θ/2).
    flux = IRRADIANCE * np.pi * radius**2 * 200.0 * PER_NM
    assert_mean(emitted, flux / np.cos(0.5 * np.radians(HALF_ANGLE_DEG)) ** 2)


def test_the_sun_is_a_disk_of_the_radiance_that_makes_its_irradiance():
    # L = E₀ / (π sin²θ): Born & Wolf (1999), §4.8.1. The disk spans 2θ of a field of view of 4θ.
    camera = scenes.Camera(
        position=(0.0, 0.1, 0.0), look_at=(-DIRECTION[0], 0.1 - DIRECTION[1], 0.0),
        up=(0.0, 0.0, 1.0), fov_deg=4.0 * HALF_ANGLE_DEG,
    )
    picture = render((FLOOR,), sun(), camera, size=(64, 64), photons=100, passes=4, radius=0.1)
    radiance = picture.spectral_radiance[..., 0]
    expected = IRRADIANCE / (np.pi * np.sin(np.radians(HALF_ANGLE_DEG)) ** 2) * PER_NM
    np.testing.assert_allclose(radiance[28:36, 28:36], expected, rtol=1e-6)
    # It fills π/16 of the picture: its rim is 100 pixels long, each sampled 4 times.
    assert np.mean(radiance) / expected == pytest.approx(np.pi / 16.0, abs=5.0 * 0.5 * 10 / 64**2)
    assert not radiance[:8].any()


def test_photons_under_an_endless_floor_are_not_the_suns():
    # The ball and the disk are below the plane: all light ends on it, also of lines that come to
    # the sphere around the scene under it.
    plane = scenes.SceneObject(
        name="plane", shape=scenes.Plane(position=(0.0, 1.0, 0.0), normal=(0.0, 1.0, 0.0)),
        material=scenes.Lambertian(reflectance=0.5),
    )  # fmt: skip
    low = scenes.Sun(direction=(1.0, -0.05, 0.0), irradiance=IRRADIANCE, spectrum="E")
    camera = DOWN.model_copy(update={"position": (0.0, 0.9, 0.0)})
    picture = render((plane, FLOOR, GLASS), low, camera, photons=20_000, passes=2, radius=0.03)
    assert not picture.spectral_radiance.any()
    assert picture.energy.escaped > 0.1 * picture.energy.emitted
    assert abs(picture.energy.residual) < 1e-12
    with pytest.raises(sim.SettingsError, match=r'"lamps", for emitters\[0\] is infinitely'):
        render((plane, FLOOR), low, camera, photons=100, passes=1, direct_light="photons")
    with pytest.raises(sim.SettingsError, match=r"bounces.* 0, for emitters\[0\] is infinitely"):
        render((plane, FLOOR), low, camera, photons=100, passes=1, bounces=3)
