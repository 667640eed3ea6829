"""Across an edge between light and dark, pixels show the filter's distribution function."""

import numpy as np
import pytest

import scenes
import sim

WIDTH, HEIGHT, EDGE = 9, 400, 4.3
"""Light is what is right of `EDGE` [pixels]; every row is a replicate."""


def tent_share(offset, reach):
    """∫ (1 − |x|/r)/r dx up to the offset."""
    x = np.clip(offset / reach, -1.0, 1.0)
    return 0.5 + x - 0.5 * x * np.abs(x)


def gaussian_share(offset, sigma, reach):
    """∫ exp(−ρ²/2σ²) over the part of the disk of this radius left of the offset, by quadrature."""
    x = np.linspace(-reach, reach, 200_001)
    half = np.sqrt(np.maximum(reach**2 - x**2, 0.0))
    across = np.vectorize(_error_function)(half / (sigma * np.sqrt(2.0)))
    density = np.exp(-0.5 * (x / sigma) ** 2) * across
    return np.interp(offset, x, np.cumsum(density) / np.sum(density), left=0.0, right=1.0)


def _error_function(x):
    import math

    return math.erf(x)


FILTERS = [
    (scenes.BoxFilter(), lambda x: np.clip(x + 0.5, 0.0, 1.0)),
    (scenes.TentFilter(), lambda x: tent_share(x, 1.0)),
    (scenes.TentFilter(reach=2.5), lambda x: tent_share(x, 2.5)),
    (scenes.GaussianFilter(), lambda x: gaussian_share(x, 0.5, 1.5)),
    (scenes.GaussianFilter(sigma=1.2, reach=2.0), lambda x: gaussian_share(x, 1.2, 2.0)),
]


@pytest.mark.parametrize(("pixel_filter", "share"), FILTERS, ids=range(5))
def test_an_edge_has_the_filters_distribution_function(assert_mean, pixel_filter, share):
    pixel = 2.0 * np.tan(np.radians(1.0)) / HEIGHT
    left = (EDGE - 0.5 * WIDTH) * pixel
    lamp = scenes.RectangleLamp(
        position=(left + 0.5, 0.0, -1.0), size=(1.0, 1.0), normal=(0.0, 0.0, 1.0), flux=np.pi,
        spectrum="E",
    )
    behind = scenes.SceneObject(
        shape=scenes.Disk(position=(0.0, 0.0, 1.0), normal=(0.0, 0.0, 1.0), radius=0.1),
        material=scenes.Lambertian(reflectance=0.5),
    )
    scene = scenes.Scene(
        film=scenes.Film(
            width=WIDTH, height=HEIGHT, first_nm=500, last_nm=600, bands=2, filter=pixel_filter
        ),
        camera=scenes.Camera(position=(0.0, 0.0, 0.0), look_at=(0.0, 0.0, -1.0), fov_deg=2.0),
        emitters=(lamp,), objects=(behind,),
    )
    picture = sim.render(scene, sim.RenderSettings(photons=1, passes=2, radius=0.1))
    rows = picture.spectral_radiance[..., 0] * (830.0 - 360.0)
    middles = np.arange(WIDTH) + 0.5
    assert_mean(rows, share(middles - EDGE), slack=1e-4)
