"""A spot out of focus is a disk as large as the thin-lens formula says."""

import numpy as np
import pytest

import scenes
import sim

PIXELS, PASSES = 160, 24
SPOT_RADIUS, SHARP_DISTANCE, F_NUMBER = 1e-2, 1.0, 0.5


def camera(**fields):
    return scenes.Camera(position=(0.0, 0.0, 0.0), look_at=(0.0, 0.0, -1.0), fov_deg=12.0, **fields)


def pictures(taken_by, distance):
    """(passes, height, width) independent pictures of a white disk that faces the camera."""
    position = (0.0, 0.0, -distance)
    spot = scenes.SceneObject(
        shape=scenes.Disk(position=position, normal=(0.0, 0.0, 1.0), radius=SPOT_RADIUS),
        material=scenes.Lambertian(reflectance=1.0),
    )
    lamp = scenes.Point(position=(0.5, 0.0, -distance + 0.5), flux=1.0, spectrum="E")
    film = scenes.Film(width=PIXELS, height=PIXELS, first_nm=500, last_nm=600, bands=2)
    scene = scenes.Scene(objects=(spot,), emitters=(lamp,), film=film, camera=taken_by)
    settings = [
        sim.RenderSettings(photons=1, passes=1, radius=SPOT_RADIUS, seed=seed)
        for seed in range(PASSES)
    ]
    return np.array([sim.render(scene, one).spectral_radiance.sum(axis=2) for one in settings])


def spot_radiance():
    """ρ E/π, summed over both bands, E = I cos θ/d² at 45° from a point lamp of I = Φ/(4π)."""
    irradiance = 1.0 / (4.0 * np.pi) * np.sqrt(0.5) / 0.5
    return 2.0 * irradiance / np.pi / (830.0 - 360.0)


@pytest.mark.parametrize("distance", [0.7, 1.6])
def test_the_blur_circle_is_as_large_as_the_thin_lens_formula_says(assert_mean, distance):
    taken_by = camera(f_number=F_NUMBER, focus_distance=SHARP_DISTANCE)
    # c = A |s₂ − s₁| / s₂ · f / (s₁ − f), on the sensor, with the aperture's diameter A = f / N
    # (Ray 2002, *Applied Photographic Optics*, ch. 22); and f from the sensor and its field.
    height = taken_by.sensor_height
    image_distance = 0.5 * height / np.tan(np.radians(6.0))
    focal = 1.0 / (1.0 / SHARP_DISTANCE + 1.0 / image_distance)
    blur = focal / F_NUMBER * abs(distance - SHARP_DISTANCE) / distance
    blur *= focal / (SHARP_DISTANCE - focal) * PIXELS / height
    assert 50.0 < blur < 80.0  # pixels
    # Mean r² of a uniform disk of radius ρ is ρ²/2. The picture is the convolution of the blur
    # circle (ρ = c/2), of the spot's image and of the pixel (1/12 along x and along y).
    image_radius = SPOT_RADIUS / distance * image_distance * PIXELS / height
    expected = 0.5 * (0.5 * blur) ** 2 + 0.5 * image_radius**2 + 2.0 / 12.0
    x = np.arange(PIXELS) + 0.5 - 0.5 * PIXELS
    r2 = x[:, None] ** 2 + x**2
    light = pictures(taken_by, distance)
    excess = (light * (r2 - expected)).sum(axis=(1, 2)) / (light.mean(axis=0).sum() * expected)
    assert_mean(excess, 0.0)
    # Four points of the lens a pass, of which a part p sees the spot and its radiance L: a pixel's
    # variance is at most that of four independent ones, L² p (1 − p)/4 < L mean/4, and a fourth of
    # that of a single one, L² p (1 − p). Some 1e4 hits decide, so that 5 σ are 0.05.
    hit = light.mean(axis=0).sum() * spot_radiance()
    assert light.var(axis=0, ddof=1).sum() < 0.25 * 1.05 * hit
    # Nothing beyond the circle, by more than the spot's image and half a pixel's diagonal.
    assert not light[:, r2 > (0.5 * blur + image_radius + 0.71) ** 2].any()


def test_what_lies_in_focus_is_as_sharp_as_through_a_pinhole():
    sharp, pinhole = (
        pictures(taken_by, SHARP_DISTANCE)
        for taken_by in (camera(f_number=F_NUMBER), camera())
    )
    # The same points of the same pixels: all rays of a pixel meet where the pinhole's does.
    np.testing.assert_allclose(sharp, pinhole, rtol=1e-9)
