"""Lamps that shine on a receiver without anything in between: what their charts must add up to."""

import numpy as np
import pytest

import scenes
from sim.study.caustic_mesh import Resolution, trace_caustic_mesh
from sim.study.metrics import relative_l2
from sim.study.receiver_bins import lay_bins

BANDS = [400.0, 500.0, 550.0, 700.0]
GREEN = {"flux": 1.0, "spectrum": scenes.Laser(wavelength_nm=500.0)}
DOWN = (0.0, -1.0, 0.0)


@pytest.mark.parametrize("kind", ["point", "spot", "sphere"])
def test_direct_light_follows_the_solid_angle(
    make_bench, compile_bench, rectangle_solid_angle, kind
):
    # Φ Ω/4π into each bin; a glowing sphere, all of it above the floor's horizon, lights it as its
    # centre would. A spot has Φ/(2π (1 − cos h)) per solid angle, here over all of the floor.
    where = {"name": "lamp", "position": (0.1, 0.7, 0.05), "flux": 3.0, "spectrum": "E"}
    lamp, density = scenes.Point(**where), 3.0 / (4.0 * np.pi)
    if kind == "spot":
        lamp = scenes.Spot(direction=DOWN, half_angle_deg=60.0, **where)
        density = 3.0 / np.pi
    if kind == "sphere":
        lamp = scenes.SphereLamp(radius=0.05, **where)
    floor = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 0.8))
    compiled = compile_bench(make_bench(lamp, floor=floor))
    bins = lay_bins(compiled.scene, "floor", rows=7, columns=9)
    u = bins.low[0] + np.arange(10) * bins.bin_size[0] - 0.1
    v = bins.low[1] + np.arange(8) * bins.bin_size[1] + 0.05  # v = −z
    share = lamp.emission().band_flux(BANDS) / lamp.emission().total
    flux = density * rectangle_solid_angle(u, v, 0.7)[..., None] * share
    expected = bins.irradiance(flux, BANDS)
    errors = []
    for cells in (32, 64):
        resolution = Resolution(cells=cells, wavelengths=2, lamp_points=2)
        mesh = trace_caustic_mesh(
            compiled, bins, emitter="lamp", target="floor", edges_nm=BANDS, branches=(),
            resolution=resolution,
        )
        errors.append(relative_l2(mesh.irradiance, expected))
        assert mesh.relative_error > 0.5 * errors[-1]
    # The chart is larger than the floor, whose light is from its smoother middle: 4 or better.
    assert errors[0] / errors[1] > 3.5
    assert errors[1] < 1e-3


def test_a_flat_lamp_lights_an_opposite_rectangle_by_their_view_factor(make_bench, compile_bench):
    # Equal, aligned rectangles a × b at distance c, with X = a/c, Y = b/c (Howell 1982, *A Catalog
    # of Radiation Configuration Factors*, C-11).
    a, b, c = 0.3, 0.2, 0.5
    x, y = a / c, b / c
    root_x, root_y = np.sqrt(1.0 + x * x), np.sqrt(1.0 + y * y)
    factor = (2.0 / (np.pi * x * y)) * (
        0.5 * np.log((root_x * root_y) ** 2 / (1.0 + x * x + y * y))
        + x * root_y * np.arctan(x / root_y) + y * root_x * np.arctan(y / root_x)
        - x * np.arctan(x) - y * np.arctan(y)
    )
    lamp = scenes.RectangleLamp(
        name="lamp", position=(0.0, c, 0.0), size=(a, b), normal=DOWN, **GREEN
    )
    floor = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(a, b))
    compiled = compile_bench(make_bench(lamp, floor=floor))
    bins = lay_bins(compiled.scene, "floor", rows=1, columns=1)
    found = []
    for points in (2, 4):
        mesh = trace_caustic_mesh(
            compiled, bins, emitter="lamp", target="floor", edges_nm=[450.0, 550.0], branches=(),
            resolution=Resolution(cells=64, wavelengths=2, lamp_points=points),
        )
        found.append(float(mesh.irradiance.sum()) * bins.bin_area * 100.0)
        assert abs(found[-1] / factor - 1.0) < mesh.relative_error
    # Chords for the floor's edges: (2π/128)²/8 of what goes over them.
    assert found[1] == pytest.approx(factor, rel=1e-3)
