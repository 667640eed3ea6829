"""Photons of one stream in one pass: how evenly their numbers lie, each sampler by its own measure.

Random numbers are held by χ², at both ends. Owen-scrambled Sobol points are far more even than χ²
can tell, for they are a net: their measure is exact counts. Points of the R sequence are a lattice;
theirs is that boxes hold their share better than random numbers would fill them, in eight pairs of
dimensions of ten; the other two have stripes, whose wave is a known sum.

What is drawn beside them is random whatever the sampler, and is held by χ² against all of them.
"""

import itertools
from fractions import Fraction

import numpy as np
import pytest

from sim.sampling.photon_numbers import R5_STEPS

DIMENSIONS = range(5)
PAIRS = tuple(itertools.combinations(DIMENSIONS, 2))
DRAWS = range(5, 10)
"""What befalls a photon at one surface; see conftest.py."""

RANGE = 14
"""A launch takes 2¹⁴ photons, an aligned block of a stream: each thread works on a net."""

STREAM = (0, 3, 1)
"""Seed, pass and number of the stream that is looked at."""


def test_random_numbers_are_independent_in_every_pair(draw_numbers, assert_independent):
    x = draw_numbers("random", [STREAM], np.arange(1 << 16))[0]
    pairs = [(x[:, a], x[:, b]) for a, b in PAIRS]
    # Of a photon and the next one, and the one that another thread traces at the same time.
    for step in (1, 1 << RANGE):
        pairs += [(x[:-step, a], x[step:, b]) for a in DIMENSIONS for b in DIMENSIONS]
    assert_independent(pairs)


DEGREES = (1, 1, 2, 3, 3)
"""Of the primitive polynomials of Joe & Kuo (2008), and 1 of the radical inverse."""


def quality_of(dimensions):
    """The projection onto some dimensions is a (t, s)-sequence with t = Σ (degree − 1).

    Niederreiter (1992), *Random Number Generation and Quasi-Monte Carlo Methods*, §4.3.
    """
    return sum(DEGREES[d] - 1 for d in dimensions)


def elementary_boxes(dimensions, digits):
    """Every way to share `digits` binary digits out among the dimensions."""
    count = len(dimensions)
    for bars in itertools.combinations(range(digits + count - 1), count - 1):
        edges = (-1, *bars, digits + count - 1)
        yield [b - a - 1 for a, b in itertools.pairwise(edges)]


@pytest.mark.parametrize("first", [0, 5 << RANGE, (1 << 28) - (1 << RANGE)])
@pytest.mark.parametrize("dimensions", [*PAIRS, tuple(DIMENSIONS)], ids=str)
def test_sobol_points_of_a_range_are_a_net(draw_numbers, dimensions, first):
    # (t, m, s)-net: every box of volume 2^(t−m), however its sides share it, holds 2ᵗ of 2ᵐ points.
    t = quality_of(dimensions)
    u = draw_numbers("sobol", [STREAM], first + np.arange(1 << RANGE))[0][:, list(dimensions)]
    words = (u * 2.0**32).astype(np.int64)
    for digits in elementary_boxes(dimensions, RANGE - t):
        cell = np.zeros(len(words), dtype=np.int64)
        for column, k in zip(words.T, digits, strict=True):
            cell = (cell << k) | (column >> (32 - k))
        counts = np.bincount(cell, minlength=1 << (RANGE - t))
        assert np.all(counts == 1 << t), digits


RESONANCES = {(1, 2): (-4, 6), (2, 4): (1, 10)}
"""Pairs of R5 whose steps have a small multiple that is nearly whole: 6 α₃ − 4 α₂ − 1 = 2.3e-5 and
α₃ + 10 α₅ − 6 = −1.6e-5. Their points lie in stripes until so many have closed them."""


def test_the_r_sequence_fills_boxes_better_than_chance(draw_numbers):
    # χ² of random numbers would be 255 ± 23.
    count = 1 << 16
    x = draw_numbers("r2", [STREAM], np.arange(count))[0]
    for a, b in PAIRS:
        if (a, b) not in RESONANCES:
            counts = np.histogram2d(x[:, a], x[:, b], bins=16, range=((0, 1), (0, 1)))[0]
            assert np.sum((counts - count / 256) ** 2) / (count / 256) < 50.0
    for (a, b), (h, k) in RESONANCES.items():
        # Weyl's sum, of the stripes' wave: |sin(π N δ)/(N sin(π δ))|, δ the distance from a whole
        # number; of random numbers it would be 1/√N = 0.004.
        delta = Fraction(h * R5_STEPS[a] + k * R5_STEPS[b], 2**64)
        delta = float(delta - round(delta))
        wave = np.abs(np.mean(np.exp(2j * np.pi * (h * x[:, a] + k * x[:, b]))))
        expected = abs(np.sin(np.pi * count * delta) / (count * np.sin(np.pi * delta)))
        assert wave == pytest.approx(expected, rel=1e-6)
        assert expected > 5.0 / np.sqrt(count)


@pytest.mark.parametrize("sampler", ["sobol", "r2", "random"])
def test_what_befalls_a_photon_is_independent_of_what_it_is(
    draw_numbers, assert_independent, sampler
):
    count = 1 << 16
    now = draw_numbers(sampler, [STREAM], np.arange(count))[0]
    # Each sixteenth of a dimension has its exact share of Sobol points, and its share but for one
    # or two, by the three-distance theorem, of the R sequence's.
    fixed = 0 if sampler == "random" else 1
    assert_independent([(now[:, a], now[:, b]) for a in DIMENSIONS for b in DRAWS], fixed=fixed)
    # Among themselves, at one surface, at the next one, and of the next photon.
    then = draw_numbers(sampler, [STREAM], np.arange(count), step=1)[0]
    pairs = [(now[:, a], now[:, b]) for a, b in itertools.combinations(DRAWS, 2)]
    for u, v in ((now, then), (now[:-1], now[1:])):
        pairs += [(u[:, a], v[:, b]) for a in DRAWS for b in DRAWS]
    assert_independent(pairs)
