"""Counter-based random bits: SplitMix64, without collisions, and uniform."""

import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.sampling.counter import fold_key, hash64, seed_words, to_unit


@wp.kernel(enable_backward=False, module="tests_counter")
def hash_pairs(
    keys: wp.array(dtype=wp.uint64),
    counters: wp.array(dtype=wp.uint64),
    out_bits: wp.array(dtype=wp.uint64),
    out_single: wp.array(dtype=wp.float32),
    out_double: wp.array(dtype=wp.float64),
):
    i = wp.tid()
    bits = hash64(keys[i], counters[i])
    out_bits[i] = bits
    out_single[i] = to_unit(bits, wp.float32(0.0))
    out_double[i] = to_unit(bits, wp.float64(0.0))


@wp.kernel(enable_backward=False, module="tests_counter")
def bits_to_unit(
    bits: wp.array(dtype=wp.uint64),
    out_single: wp.array(dtype=wp.float32),
    out_double: wp.array(dtype=wp.float64),
):
    i = wp.tid()
    out_single[i] = to_unit(bits[i], wp.float32(0.0))
    out_double[i] = to_unit(bits[i], wp.float64(0.0))


@pytest.fixture(scope="module", autouse=True)
def _device():
    start_device("cpu")


def hashed(keys, counters):
    keys, counters = np.broadcast_arrays(np.uint64(keys), np.asarray(counters, dtype=np.uint64))
    outs = [
        wp.zeros(keys.size, dtype=dtype, device="cpu")
        for dtype in (wp.uint64, wp.float32, wp.float64)
    ]
    inputs = [wp.array(np.ascontiguousarray(a), dtype=wp.uint64, device="cpu")
              for a in (keys, counters)]  # fmt: skip
    wp.launch(hash_pairs, dim=keys.size, inputs=inputs, outputs=outs, device="cpu")
    return [out.numpy() for out in outs]


def test_the_bits_are_those_of_splitmix64():
    # Steele, Lea & Flood (2014), fig. 12, seeded with 0: the first outputs, as they are printed in
    # the test vectors of the generator's many implementations.
    bits, _, _ = hashed(0, [0, 1, 2])
    assert [hex(one) for one in bits.tolist()] == [
        "0xe220a8397b1dcdaf", "0x6e789e6aa1b965f4", "0x6c45d188009454f",
    ]  # fmt: skip


@pytest.mark.parametrize("key", [0, 1, 2**64 - 1, fold_key(3, 1)])
def test_distinct_counters_never_collide(key):
    # A bijection of 64 bits: the counters at both ends of the range, and their neighbours.
    counters = np.concatenate([
        np.arange(200_000, dtype=np.uint64),
        np.arange(2**32 - 1000, 2**32 + 1000, dtype=np.uint64),
        np.uint64(2**64 - 1) - np.arange(1000, dtype=np.uint64),
    ])
    bits, _, _ = hashed(key, counters)
    assert len(np.unique(bits)) == len(counters)


def test_keys_of_neighbouring_passes_share_no_draw():
    keys = [fold_key(0, index) for index in range(20)]
    bits = np.concatenate([hashed(key, np.arange(20_000))[0] for key in keys])
    # Random 64-bit words: 400,000² / 2⁶⁵ = 4e-9 collisions expected.
    assert len(np.unique(bits)) == len(bits)


def test_numbers_are_uniform():
    count, bins = 1_000_000, 256
    for values in hashed(fold_key(5), np.arange(count))[1:]:
        assert values.min() >= 0.0
        assert values.max() < 1.0
        observed, _ = np.histogram(values, bins=bins, range=(0.0, 1.0))
        chi2 = np.sum((observed - count / bins) ** 2) / (count / bins)
        # 255 degrees of freedom: mean 255, σ = √510; the seed is fixed, so 5 σ either passes or not
        assert abs(chi2 - (bins - 1)) < 5.0 * np.sqrt(2.0 * (bins - 1))


def test_neighbouring_counters_and_keys_are_uncorrelated():
    a = hashed(fold_key(1), np.arange(200_000))[2]
    b = hashed(fold_key(2), np.arange(200_000))[2]
    # The correlation of n independent pairs has σ = 1/√n.
    bound = 5.0 / np.sqrt(len(a))
    assert abs(np.corrcoef(a[:-1], a[1:])[0, 1]) < bound
    assert abs(np.corrcoef(a, b)[0, 1]) < bound


def test_the_ends_of_the_range():
    # Of 24 bits in float32, of 53 in float64: nothing rounds up to 1.
    for column, digits in enumerate((24, 53)):
        last = 2 ** (64 - digits)
        bits = np.array([0, last - 1, last, 2**64 - 1], dtype=np.uint64)
        outs = [wp.zeros(4, dtype=dtype, device="cpu") for dtype in (wp.float32, wp.float64)]
        inputs = [wp.array(bits, dtype=wp.uint64, device="cpu")]
        wp.launch(bits_to_unit, dim=4, inputs=inputs, outputs=outs, device="cpu")
        expected = [0.0, 0.0, 2.0**-digits, 1.0 - 2.0**-digits]
        assert outs[column].numpy().tolist() == expected


def test_keys_depend_on_every_part_and_on_their_order():
    keys = {fold_key(*parts) for parts in [(0,), (1,), (0, 0), (0, 1), (1, 0), (-1,), (2**64 - 2,)]}
    assert len(keys) == 7
    assert all(0 <= key < 2**64 for key in keys)
    assert fold_key(-1) == fold_key(2**64 - 1)  # integers of any size, modulo 2⁶⁴


def test_seed_words_are_one_a_dimension():
    words = seed_words(5, 3, 1)
    assert words.dtype == np.uint32
    assert len(set(words.tolist())) == 5
    np.testing.assert_array_equal(words, seed_words(5, 3, 1))
    assert not set(words.tolist()) & set(seed_words(5, 3, 2).tolist())
