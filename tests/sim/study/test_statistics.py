"""Intervals hold the truth as often as they say, on data whose truth is known."""

import math

import numpy as np
import pytest

from sim.study.statistics import (
    fit_power_law,
    gram_matrix,
    mean_interval,
    pareto_set,
    separate_errors,
)

REPEATS = 600
# Of 600 repeats 95% are 570 ± 5.3 (binomial); 3.5 σ on either side.
COVERED = (570 - 19, 570 + 19)


def covered(holds):
    return COVERED[0] <= sum(holds) <= COVERED[1]


def test_a_power_law_is_found_and_its_slope_lies_in_the_interval():
    # y = 3 x^-0.65 with lognormal scatter: log y is linear with normal errors, where the interval
    # of the slope by Student's t is exact.
    rng = np.random.default_rng(1)
    x = np.repeat([1e3, 4e3, 16e3, 64e3], 3)
    laws = [
        fit_power_law(x, 3.0 * x**-0.65 * np.exp(0.2 * rng.standard_normal(len(x))))
        for _ in range(REPEATS)
    ]
    assert covered([law.slope.low <= -0.65 <= law.slope.high for law in laws])
    # Without scatter it is exact, and so is the line.
    law = fit_power_law(x, 3.0 * x**-0.65)
    assert law.slope == pytest.approx((-0.65, -0.65, -0.65), abs=1e-9)
    assert law.at(2e4) == pytest.approx((3.0 * 2e4**-0.65,) * 3)


def test_the_line_lies_in_its_own_interval():
    rng = np.random.default_rng(2)
    x = np.repeat([1.0, 2.0, 8.0], 4)
    holds = []
    for _ in range(REPEATS):
        found = fit_power_law(x, x**-0.5 * np.exp(0.3 * rng.standard_normal(len(x)))).at(16.0)
        holds.append(found.low <= 0.25 <= found.high)  # 16^-0.5
    assert covered(holds)


def test_points_without_a_logarithm_are_left_out_and_two_make_no_law():
    assert fit_power_law([1.0, 2.0, 4.0], [1.0, 0.5, 0.0]) is None
    assert fit_power_law([2.0, 2.0, 2.0], [1.0, 2.0, 3.0]) is None
    assert fit_power_law([1.0, 2.0, 4.0, 8.0], [1.0, 0.5, 0.25, math.nan]).points == 3


def test_a_mean_lies_in_the_interval_of_student():
    rng = np.random.default_rng(3)
    found = [mean_interval(rng.standard_normal(4)) for _ in range(REPEATS)]
    assert covered([one.low <= 0.0 <= one.high for one in found])
    # Student's t of 3 degrees of freedom is 3.182 at 97.5%.
    one = mean_interval([1.0, 2.0, 3.0, 4.0])
    assert one.high - one.value == pytest.approx(3.182446 * np.std([1, 2, 3, 4], ddof=1) / 2.0)


NOISE, BIAS = 0.03, 0.04
CELLS, REPLICATES = 400, 8


def synthetic(rng, reference_noise=0.0):
    """Replicates about 1 + BIAS with scatter NOISE, and the reference 1 with its own noise."""
    reference = 1.0 + reference_noise * rng.standard_normal(CELLS)
    replicates = 1.0 + BIAS + NOISE * rng.standard_normal((REPLICATES, CELLS))
    return gram_matrix(list(replicates), reference)


def test_noise_and_bias_are_told_apart():
    rng = np.random.default_rng(4)
    found = [separate_errors(synthetic(rng)) for _ in range(100)]
    # Means over 100 studies of 8 × 400 normal numbers: the squares' relative errors are below
    # √(2/3200)/10 = 0.25% for the noise, and 2 σ/(b √3200)/10 = 0.27% for the bias; 5 σ is 1.4%.
    noise2 = np.mean([one.noise.value**2 for one in found])
    bias2 = np.mean([one.bias.value**2 for one in found])
    error2 = np.mean([one.error.value**2 for one in found])
    assert noise2 == pytest.approx(NOISE**2, rel=0.014)
    assert bias2 == pytest.approx(BIAS**2, rel=0.014)
    assert error2 == pytest.approx(NOISE**2 + BIAS**2, rel=0.014)
    for name, truth in (("noise", NOISE), ("bias", BIAS), ("error", math.hypot(NOISE, BIAS))):
        holds = [getattr(one, name).low <= truth <= getattr(one, name).high for one in found]
        assert 88 <= sum(holds) <= 100, name  # 95 ± 2.2 of 100, 3 σ


def test_noise_does_not_count_as_bias_nor_the_references_noise_as_any():
    rng = np.random.default_rng(5)
    biases = []
    for _ in range(200):
        pure = gram_matrix(list(1.0 + NOISE * rng.standard_normal((4, CELLS))), np.ones(CELLS))
        gram = np.asarray(pure)
        biases.append((gram.sum() - np.trace(gram)) / 12.0)
        assert separate_errors(gram).bias.low == 0.0 or biases[-1] > 0.0
    # Each product dᵢ·dⱼ has mean 0 and standard deviation σ²/√400; six of them, 200 times.
    assert abs(np.mean(biases)) < 4.0 * NOISE**2 / 20.0 / math.sqrt(6 * 200)
    noisy = [
        separate_errors(synthetic(rng, 0.05), reference_variance=0.05**2).bias.value ** 2
        for _ in range(200)
    ]
    # Each has the scatter of the reference's square, √(2/400) · 0.05², and of twice its product
    # with the bias, 2 · 0.05 · 0.04/√400: 2.7e-4 together; 200 of them, 4 σ.
    assert np.mean(noisy) == pytest.approx(BIAS**2, abs=4.0 * 2.7e-4 / math.sqrt(200))


def test_a_single_certain_result_has_bias_alone():
    found = separate_errors(gram_matrix([np.full(4, 1.1)], np.ones(4)))
    assert found.bias == pytest.approx((0.1, 0.1, 0.1))
    assert found.noise == (0.0, 0.0, 0.0)
    pair = separate_errors(gram_matrix([np.full(4, 1.1), np.full(4, 1.1)], np.ones(4)))
    assert pair.bias.value == pytest.approx(0.1)
    assert pair.noise.value == pytest.approx(0.0, abs=1e-9)


def test_the_pareto_set_is_what_nothing_beats():
    #        0    1    2    3    4    5
    cost = [1.0, 2.0, 2.0, 3.0, 0.5, 4.0]
    error = [5.0, 4.0, 3.0, 3.5, 6.0, 3.0]
    # 2 beats 1 (same cost), 3 (cheaper and better) and 5 (cheaper, as good).
    assert pareto_set(cost, error) == [4, 0, 2]
    assert pareto_set([1.0, 1.0], [2.0, 2.0]) == [0]
