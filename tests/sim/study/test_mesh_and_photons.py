"""Mesh and photons of the same scene agree, bin by bin, for every kind of lamp."""

import numpy as np
import pytest

import scenes
from sim.study.caustic_mesh import Resolution, trace_caustic_mesh
from sim.study.receiver_bins import lay_bins

PASSES = 16
PHOTONS = 20_000
BANDS = [400.0, 550.0, 700.0]
BALL = scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.5)
FLOOR = scenes.Rectangle(position=(0.0, -0.9, 0.0), size=(0.9, 0.9))
COMMON = {"name": "lamp", "flux": 5.0, "spectrum": "D65"}
ABOVE = (0.2, 2.0, 0.1)
LAMPS = {
    "point": scenes.Point(position=ABOVE, **COMMON),
    "spot": scenes.Spot(position=ABOVE, direction=(0.1, -1.0, 0.0), half_angle_deg=12.0, **COMMON),
    "sphere": scenes.SphereLamp(position=ABOVE, radius=0.15, **COMMON),
    "rectangle": scenes.RectangleLamp(
        position=ABOVE, size=(0.3, 0.2), normal=(0.3, -1.0, 0.0), **COMMON
    ),
    "beam": scenes.Beam(
        position=ABOVE, direction=(-0.1, -1.0, 0.0), divergence_deg=3.0,
        profile=scenes.RoundProfile(radius=0.3), **COMMON,
    ),
    "wide beam": scenes.Beam(
        position=ABOVE, direction=(-0.1, -1.0, 0.0), divergence_deg=3.0,
        profile=scenes.SlitProfile(width=2.0, height=2.0), **COMMON,
    ),
}


@pytest.mark.parametrize("name", LAMPS)
def test_photons_scatter_about_the_mesh(make_bench, compile_bench, trace_passes, name):
    scene = make_bench(LAMPS[name], ball=BALL, floor=FLOOR)
    compiled = compile_bench(scene)
    bins = lay_bins(scene, "floor", rows=10, columns=10)
    mesh = trace_caustic_mesh(
        compiled, bins, emitter="lamp", target="ball", edges_nm=BANDS,
        branches=("refract", "refract"), resolution=Resolution(cells=64, wavelengths=2),
    )
    passes = trace_passes(scene, photons=PHOTONS, passes=PASSES)

    def through_the_ball(photons):
        kept = (photons["refractions"] == 2) & (photons["reflections"] == 0)
        kept &= photons["bounces"] == 0
        return bins.bin_photons({key: one[kept] for key, one in photons.items()}, BANDS)

    found = passes.sums(through_the_ball)
    mean = found.mean(axis=0)
    error = found.std(axis=0, ddof=1) / np.sqrt(PASSES)
    # Dim bins met by a handful of photons have no normal errors: the brighter ones, which hold
    # nearly all of the light, are compared one by one, with what the mesh says of itself.
    bright = mean > 0.05 * mean.mean()
    assert mean[bright].sum() > 0.95 * mean.sum()
    z = (mean - mesh.irradiance)[bright] / np.hypot(error, mesh.error)[bright]
    # Student's t with 15 degrees of freedom: σ² = 15/13, and beyond 5 once in 6,000.
    assert np.sqrt(np.mean(z**2)) < 1.3
    assert np.abs(z).max() < 6.0
    # In the sum over bins errors average out: sharper. The mesh's own, of a few 1e-4, add up.
    total = found.sum(axis=(1, 2))
    off = np.abs(total.mean(axis=0) - mesh.irradiance.sum(axis=(0, 1)))
    sharp = total.std(axis=0, ddof=1) / np.sqrt(PASSES)
    assert np.all(off < 5.0 * sharp + mesh.relative_error * total.mean(axis=0))
    assert np.all(sharp < 0.01 * total.mean(axis=0))
    assert mesh.relative_error < 0.02
