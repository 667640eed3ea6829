"""The numbers photons are made of: well spread or independent, and never out of range."""

import functools
from decimal import Decimal, localcontext

import numpy as np
import pytest
import warp as wp

from sim.precision import precision_types
from sim.sampling.counter import seed_words
from sim.sampling.photon_numbers import R5_STEPS, make_photon_numbers
from sim.sampling.sobol import sobol_tables

COUNT = 4096
SAMPLERS = ["sobol", "r2", "random"]


@functools.cache
def make_draw(precision, sampler):
    real = precision_types(precision).real
    photon_numbers = make_photon_numbers(precision, sampler)

    @wp.kernel(module="unique", enable_backward=False)
    def draw(
        sobol: wp.array(dtype=wp.uint32), seeds: wp.array(dtype=wp.uint32), first: wp.uint32,
        key: wp.uint64, out: wp.array2d(dtype=real),
    ):
        i = wp.tid()
        u0, u1, u2, u3, u4 = photon_numbers(sobol, seeds, 0, first + wp.uint32(i), key)
        out[i, 0] = u0
        out[i, 1] = u1
        out[i, 2] = u2
        out[i, 3] = u3
        out[i, 4] = u4

    return draw


def numbers(sampler, *, precision="float64", key=1, first=0):
    out = wp.zeros((COUNT, 5), dtype=precision_types(precision).real, device="cpu")
    tables = wp.array(sobol_tables(), dtype=wp.uint32, device="cpu")
    seeds = wp.array(seed_words(5, key), dtype=wp.uint32, device="cpu")
    inputs = [tables, seeds, first, key, out]
    wp.launch(make_draw(precision, sampler), dim=COUNT, inputs=inputs, device="cpu")
    return out.numpy()


def test_the_steps_are_powers_of_the_root():
    # Roberts (2018): α_k = g⁻ᵏ, g⁶ = g + 1. Truncated to 64 bits, and made odd.
    with localcontext() as context:
        context.prec = 50
        g = Decimal("1.13")
        for _ in range(20):
            g -= (g**6 - g - 1) / (6 * g**5 - 1)
        expected = [int(Decimal(2) ** 64 / g**k) | 1 for k in range(1, 6)]
    assert list(R5_STEPS) == expected


@pytest.mark.parametrize("first", [0, 4_000_000_000])
def test_each_point_of_r5_is_one_step_on(first):
    # To the last of 53 bits, also where i α in float64 would have 20 left.
    steps = np.diff(numbers("r2", first=first), axis=0) % 1.0
    expected = np.array(R5_STEPS) / 2.0**64
    np.testing.assert_allclose(steps, np.broadcast_to(expected, steps.shape), atol=2.0**-52)


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("sampler", SAMPLERS)
def test_numbers_are_uniform_in_each_dimension_and_pair(sampler, precision):
    # n = 4096 random numbers fill 16 boxes with variance n p (1 − p): χ² with 15 degrees of
    # freedom exceeds 50 by chance once in 10⁵. What is well spread is below it by far.
    x = numbers(sampler, precision=precision)
    assert x.min() >= 0.0
    assert x.max() < 1.0
    expected = COUNT / 16
    for d in range(5):
        counts = np.histogram(x[:, d], bins=16, range=(0.0, 1.0))[0]
        assert np.sum((counts - expected) ** 2 / expected) < 50.0
        for e in range(d):
            square = np.histogram2d(x[:, d], x[:, e], bins=4, range=((0, 1), (0, 1)))[0]
            if sampler == "r2":
                # Some pairs fill in stripes, slowly: 6 α₃ − 4 α₂ = 1.00002 is nearly whole.
                assert np.all(np.abs(square - expected) < 0.3 * expected)
            else:
                assert np.sum((square - expected) ** 2 / expected) < 50.0


def chi2_of_lines(x):
    """Mean over the dimensions of χ² per degree of freedom, in 64 boxes."""
    expected = COUNT / 64
    counts = [np.histogram(u, bins=64, range=(0.0, 1.0))[0] for u in x.T]
    return np.mean([np.sum((n - expected) ** 2 / expected) / 63 for n in counts])


def test_random_numbers_are_random_and_the_others_even():
    # χ²/63 = 1 ± √(2/63/5) = 0.08 for random numbers.
    assert 0.6 < chi2_of_lines(numbers("random")) < 1.4
    assert chi2_of_lines(numbers("sobol")) < 0.05
    assert chi2_of_lines(numbers("r2")) < 0.1


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_keys_give_other_numbers(sampler):
    one, other = numbers(sampler, key=1), numbers(sampler, key=2)
    assert not np.any(np.all(one == other, axis=0))
    # And of a shift, every dimension gets its own.
    offsets = (other - one)[0] % 1.0
    assert len(np.unique(np.round(offsets, 6))) == 5


def test_double_precision_has_its_digits():
    # The last of 53 bits is set in half of the numbers.
    for sampler in ("r2", "random"):
        bits = (numbers(sampler) * 2.0**53).astype(np.uint64) & np.uint64(1)
        assert 0.4 < bits.mean() < 0.6


def test_random_numbers_are_used_once():
    x = numbers("random")
    assert len(np.unique(x)) == x.size
