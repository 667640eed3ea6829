"""Sobol points against SciPy's, and the nested scrambling that keeps them nets."""

import itertools

import numpy as np
import pytest
import warp as wp
from scipy.stats import kstest, qmc

from sim.device import start_device
from sim.sampling.counter import seed_words
from sim.sampling.sobol import (
    DIMENSIONS,
    make_sobol_uniform,
    reverse_bits,
    reversed_point,
    scramble_reversed,
    sobol_tables,
)

uniform64 = make_sobol_uniform("float64")
uniform32 = make_sobol_uniform("float32")


@wp.kernel(enable_backward=False, module="tests_sobol")
def sobol_words(
    tables: wp.array(dtype=wp.uint32),
    indices: wp.array(dtype=wp.uint32),
    seeds: wp.array(dtype=wp.uint32),
    out_plain: wp.array2d(dtype=wp.uint32),
    out_scrambled: wp.array2d(dtype=wp.uint32),
):
    """32-bit words of the points, plain and scrambled; one seed a dimension."""
    i = wp.tid()
    for dimension in range(DIMENSIONS):
        x = reversed_point(tables, indices[i], dimension)
        out_plain[i, dimension] = reverse_bits(x)
        out_scrambled[i, dimension] = reverse_bits(scramble_reversed(x, seeds[dimension]))


@wp.kernel(enable_backward=False, module="tests_sobol")
def scramble_words(
    words: wp.array(dtype=wp.uint32),
    seeds: wp.array(dtype=wp.uint32),
    out_words: wp.array(dtype=wp.uint32),
):
    i = wp.tid()
    out_words[i] = reverse_bits(scramble_reversed(reverse_bits(words[i]), seeds[i]))


@wp.kernel(enable_backward=False, module="tests_sobol")
def sobol_numbers(
    tables: wp.array(dtype=wp.uint32),
    indices: wp.array(dtype=wp.uint32),
    seed: wp.uint32,
    low_bits: wp.array(dtype=wp.uint32),
    out_double: wp.array2d(dtype=wp.float64),
    out_single: wp.array2d(dtype=wp.float32),
):
    i = wp.tid()
    for dimension in range(DIMENSIONS):
        out_double[i, dimension] = uniform64(tables, indices[i], dimension, seed, low_bits[i])
        out_single[i, dimension] = uniform32(tables, indices[i], dimension, seed, low_bits[i])


@pytest.fixture(scope="module", autouse=True)
def _device():
    start_device("cpu")


def on_device(values):
    return wp.array(np.asarray(values, dtype=np.uint32), dtype=wp.uint32, device="cpu")


def words(indices, seeds=(0,) * DIMENSIONS):
    """(n, DIMENSIONS) 32-bit words, plain and scrambled."""
    shape = (len(indices), DIMENSIONS)
    outs = [wp.zeros(shape, dtype=wp.uint32, device="cpu") for _ in range(2)]
    inputs = [on_device(sobol_tables()), on_device(indices), on_device(seeds)]
    wp.launch(sobol_words, dim=len(indices), inputs=inputs, outputs=outs, device="cpu")
    return [out.numpy() for out in outs]


def scrambled(values, seeds):
    out = wp.zeros(len(values), dtype=wp.uint32, device="cpu")
    inputs = [on_device(values), on_device(np.broadcast_to(seeds, len(values)))]
    wp.launch(scramble_words, dim=len(values), inputs=inputs, outputs=[out], device="cpu")
    return out.numpy()


def numbers(indices, seed, low_bits):
    shape = (len(indices), DIMENSIONS)
    outs = [wp.zeros(shape, dtype=dtype, device="cpu") for dtype in (wp.float64, wp.float32)]
    inputs = [on_device(sobol_tables()), on_device(indices), np.uint32(seed), on_device(low_bits)]
    wp.launch(sobol_numbers, dim=len(indices), inputs=inputs, outputs=outs, device="cpu")
    return [out.numpy() for out in outs]


def test_points_are_those_of_joe_and_kuo():
    # SciPy walks the same points in Gray-code order: its i-th is ours of index i ^ (i >> 1).
    m = 14
    reference = qmc.Sobol(DIMENSIONS, scramble=False, bits=32).random_base2(m)
    i = np.arange(2**m)
    plain, _ = words(i ^ (i >> 1))
    np.testing.assert_array_equal(plain / 2.0**32, reference)


def test_every_byte_of_the_index_counts():
    # Points are linear over the bits of the index: x(i ^ j) = x(i) ^ x(j), x(0) = 0.
    rng = np.random.default_rng(1)
    i, j = rng.integers(0, 2**32, (2, 1000), dtype=np.uint32)
    np.testing.assert_array_equal(words(i ^ j)[0], words(i)[0] ^ words(j)[0])
    assert not words([0])[0].any()


def test_high_bits_of_the_index_refine_the_points():
    # Bit k of the index turns digit k + 1 of every coordinate, and none after it: each dimension
    # alone is a (0, 1)-sequence, up to the 2³² points there are.
    k = np.arange(32)
    plain, _ = words(np.uint32(1) << k.astype(np.uint32))
    lowest_set = plain & (~plain + np.uint32(1))
    expected = np.uint32(1) << (31 - k).astype(np.uint32)
    np.testing.assert_array_equal(lowest_set, np.tile(expected[:, None], DIMENSIONS))


@pytest.mark.parametrize("seed", [0, 1, 0x9E3779B9, 0xFFFFFFFF])
def test_scrambling_is_nested(seed):
    # Owen (1998): the first k digits of the scrambled number depend on the first k digits of
    # the number and on nothing else, one to one.
    rng = np.random.default_rng(2)
    a = rng.integers(0, 2**32, 20_000, dtype=np.uint32)
    common = rng.integers(0, 33, a.size)  # leading digits that a and b share
    noise = rng.integers(0, 2**32, a.size, dtype=np.uint64)
    b = a ^ (noise >> common.astype(np.uint64)).astype(np.uint32)
    inputs, outputs = a ^ b, scrambled(a, seed) ^ scrambled(b, seed)

    def leading_zeros(x):
        return 32 - np.ceil(np.log2(x.astype(np.float64) + 1.0)).astype(int)

    np.testing.assert_array_equal(leading_zeros(outputs), leading_zeros(inputs))


@pytest.mark.parametrize("word", [0, 1, 0x80000000, 0x12345678, 0xFFFFFFFF])
def test_one_point_alone_is_uniform_over_the_seeds(word):
    seeds = np.array([seed_words(1, 9, i)[0] for i in range(4000)])
    values = scrambled(np.full(seeds.size, word), seeds) / 2.0**32
    assert kstest(values, "uniform").pvalue > 1e-3


def counts_in_boxes(points, bits_x, bits_y):
    """How many of (n, 2) 32-bit points lie in each box of 2^-bits_x by 2^-bits_y."""
    cells = (points[:, 0].astype(np.uint64) >> np.uint64(32 - bits_x)) << np.uint64(bits_y)
    cells += points[:, 1].astype(np.uint64) >> np.uint64(32 - bits_y)
    return np.bincount(cells.astype(np.int64), minlength=2 ** (bits_x + bits_y))


@pytest.mark.parametrize("block", [0, 1, 5])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_first_two_dimensions_are_a_net_of_quality_zero(seed, block):
    # (0, m, 2)-net: each elementary interval of area 2⁻ᵐ holds one of 2ᵐ points, in every
    # aligned block of them.
    m = 10
    _, points = words(np.arange(block * 2**m, (block + 1) * 2**m), seed_words(DIMENSIONS, seed))
    for bits_x in range(m + 1):
        assert np.all(counts_in_boxes(points[:, :2], bits_x, m - bits_x) == 1)


PAIRS = tuple(itertools.combinations(range(DIMENSIONS), 2))


@pytest.mark.parametrize("pair", PAIRS)
def test_scrambling_keeps_the_quality_of_every_pair(pair):
    # Boxes go to boxes of their shape, so the counts are those of the plain points, shuffled.
    m = 9
    plain, points = words(np.arange(2**m), seed_words(DIMENSIONS, 4))
    for bits_x in range(m + 1):
        counts = [
            np.sort(counts_in_boxes(which[:, pair], bits_x, m - bits_x))
            for which in (plain, points)
        ]
        np.testing.assert_array_equal(*counts)


def test_every_dimension_is_stratified_and_every_seed_differs():
    m = 12
    sets = [words(np.arange(2**m), seed_words(DIMENSIONS, seed))[1] for seed in range(2)]
    for points in sets:
        strata = np.sort(points >> np.uint32(32 - m), axis=0)
        np.testing.assert_array_equal(strata, np.tile(np.arange(2**m)[:, None], DIMENSIONS))
    assert np.mean(sets[0] == sets[1]) < 0.01


def test_numbers_carry_the_words_digits_and_random_ones_below():
    rng = np.random.default_rng(3)
    indices = np.arange(5000)
    low = rng.integers(0, 2**32, indices.size, dtype=np.uint32)
    seed = 12345
    double, single = numbers(indices, seed, low)
    _, points = words(indices, (seed,) * DIMENSIONS)
    digits = (low & np.uint32(0x1FFFFF))[:, None] / 2.0**21
    np.testing.assert_array_equal(double, (points + digits) / 2.0**32)  # 53 bits: exact
    np.testing.assert_array_equal(single, (points >> np.uint32(8)) / np.float32(2.0**24))
    for values in (double, single):
        assert values.min() >= 0.0
        assert values.max() < 1.0


def test_an_integral_converges_faster_than_random_points():
    # ∫ Π (1 + (x - ½)) = 1 over five dimensions. Random points: σ = √((13/12)⁵ - 1) / √n.
    n = 2**14
    errors = []
    for seed in range(8):
        _, points = words(np.arange(n), seed_words(DIMENSIONS, 6, seed))
        errors.append(np.mean(np.prod(0.5 + points / 2.0**32, axis=1)) - 1.0)
    sigma_random = np.sqrt(((13.0 / 12.0) ** 5 - 1.0) / n)
    assert np.sqrt(np.mean(np.square(errors))) < 0.05 * sigma_random
