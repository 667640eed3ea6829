"""How fast exact bins converge where light has three dimensions: the caustic of a point lamp.

Over place and wavelength jointly, scrambled points leave bins an error of at most the order
N^(-1/2 - 1/(2d)) (He & Wang 2015), with d = 3 here: two of direction, one of wavelength.
"""

import numpy as np

import scenes
from sim.settings import RenderSettings
from sim.study.expected_slope import expected_slope, sampled_dimensions
from sim.study.glass_chain import bin_chain, find_chain, select_chain
from sim.study.setup import SeedSource, Setup
from sim.study.statistics import fit_power_law
from sim.study.workshop import Workshop

REPLICATES = 8
PHOTONS = (6_000, 12_000, 24_000, 48_000, 96_000, 192_000)


def test_bins_of_a_point_lamps_caustic_fall_as_theory_says():
    scene = scenes.load("ball")
    lamp = scene.emitters[0]
    point = scenes.Point(
        name=lamp.name, flux=lamp.flux, spectrum=lamp.spectrum, position=lamp.position
    )
    scene = scene.model_copy(update={"emitters": (point,)})
    setup = Setup(scene, RenderSettings(threads=2, photons=PHOTONS[-1]).resolved(scene))
    workshop, seeds = Workshop(threads=2), SeedSource(1)

    def trace(photons):
        made, seed = setup.with_settings(photons=photons), seeds.take()
        return workshop.trace(made, workshop.lamps(made, seed), seed, 0)

    chain = find_chain(scene, trace(PHOTONS[-1]), cells=16, bands=8)
    sizes, errors = [], []
    for photons in PHOTONS:
        found = np.stack([
            bin_chain(select_chain(trace(photons), chain), chain) for _ in range(REPLICATES)
        ])
        # Unbiased, so that noise is all: about the replicates' mean, R/(R - 1) times the square.
        mean = found.mean(axis=0)
        squares = np.sum((found - mean) ** 2, axis=(1, 2, 3)) / np.sum(mean**2)
        sizes += REPLICATES * [photons]
        errors += list(np.sqrt(squares * REPLICATES / (REPLICATES - 1)))
    slope = fit_power_law(sizes, errors).slope
    expected = expected_slope(sampled_dimensions(scene, lamp.name))
    assert expected == -2 / 3
    # Theory bounds the order from above: a steeper slope is no contradiction, a flatter one is.
    assert slope.high < -0.65
    assert slope.low < expected
