"""Waves: the surface of a height field against the sine that it stands for."""

import numpy as np
import pytest

import scenes
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays
from spectra import glass

WAVELENGTH_NM = 550.0
ETA = float(glass("water").eta(WAVELENGTH_NM))
AMPLITUDE, PERIOD = 0.01, 0.5
NUMBER = 2.0 * np.pi / PERIOD


def traced(shape, origins, directions):
    water = scenes.SceneObject(
        name="water", shape=shape, material=scenes.Dielectric(medium="water")
    )
    floor = scenes.SceneObject(
        name="floor",
        shape=scenes.Plane(position=(0.0, -3.0, 0.0), normal=(0.0, 1.0, 0.0)),
        material=scenes.Absorber(),
    )
    compiled = compile_scene(scenes.Scene(objects=(water, floor)))
    return trace_compiled_rays(
        compiled, origins, directions, np.full(len(origins), WAVELENGTH_NM)
    )


def rays_down(x, z):
    origins = np.stack([x, np.full_like(x, 2.0), z], axis=1)
    return origins, np.tile([0.0, -1.0, 0.0], (len(x), 1))


def wavy(cells, depth=2.0):
    return scenes.HeightField(
        position=(0.0, 0.0, 0.0), size=(1.0, 1.0), cells=(cells, cells), depth=depth,
        waves=[scenes.Wave(amplitude=AMPLITUDE, period=PERIOD, phase_deg=90.0)],
    )


def test_still_water_is_a_block() -> None:
    still = scenes.HeightField(
        position=(0.0, 0.0, 0.0), size=(1.0, 1.0), heights=((0.0,) * 5,) * 4, depth=0.5
    )
    block = scenes.Box(position=(0.0, -0.25, 0.0), size=(1.0, 0.5, 1.0))
    rng = np.random.default_rng(1)
    origins = rng.uniform((-0.45, 0.55, -0.45), (0.45, 1.45, 0.45), (100, 3))
    directions = rng.uniform((-0.4, -1.4, -0.4), (0.4, -0.6, 0.4), (100, 3))
    for one, other in zip(
        traced(still, origins, directions), traced(block, origins, directions), strict=True
    ):
        assert one.events == other.events
        np.testing.assert_allclose(one.directions, other.directions, atol=1e-14)
        np.testing.assert_allclose(one.points[1:-1], other.points[1:-1], atol=1e-14)


def test_a_vertical_ray_is_refracted_by_the_slope_of_the_sine() -> None:
    # h = A cos kx has the slope tan a = −k A sin kx; the ray, a off the normal, goes on
    # a − asin(sin a / n) off the vertical. Normals interpolated over cells of width w are off by
    # w²/8 of their second derivative, k² (kA): by 2.5e-5 · kA at 160 cells.
    rng = np.random.default_rng(2)
    x, z = rng.uniform(-0.45, 0.45, (2, 200))
    tilt = np.arctan(NUMBER * AMPLITUDE * np.sin(NUMBER * x))
    expected = tilt - np.arcsin(np.sin(tilt) / ETA)
    bound = 1.0 / 8.0 * (NUMBER / 160) ** 2 * NUMBER * AMPLITUDE
    for path, angle in zip(traced(wavy(160), *rays_down(x, z)), expected, strict=True):
        inside = path.directions[1]
        assert abs(np.arctan2(-inside[0], -inside[1]) - angle) < bound * 1.5


def test_a_crest_focuses_where_its_curvature_says() -> None:
    # Curvature of a crest: A k². Paraxially, R = 1/(A k²) and f = R n/(n − 1) below the crest.
    focus = ETA / (ETA - 1.0) / (AMPLITUDE * NUMBER**2)
    assert focus < 3.0
    x = np.array([-0.01, 0.01])
    paths = traced(wavy(400, depth=2.9), *rays_down(x, np.full(2, 0.0137)))
    depths = [
        AMPLITUDE - (path.points[1][1] - path.points[1][0] * path.directions[1][1]
                     / path.directions[1][0])
        for path in paths
    ]  # fmt: skip
    # Aberration falls with (k x)² = 1.6 %, of which the slope's cubic term is a sixth, and half.
    assert depths == pytest.approx([focus, focus], rel=0.01)
