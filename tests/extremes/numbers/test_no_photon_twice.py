"""No photon is emitted twice: why, as `sim.sampling.photon_numbers` argues it, and spot checks."""

import itertools
from fractions import Fraction

import numpy as np
import pytest

from sim.sampling.counter import fold_key
from sim.sampling.photon_numbers import R5_STEPS
from sim.sampling.sobol import sobol_tables

WINDOW = 1 << 15
FIRSTS = (0, (1 << 28) - WINDOW, (1 << 30) - WINDOW // 2, 1_000_000_000, (1 << 31) - WINDOW // 2,
          (1 << 32) - WINDOW)  # fmt: skip
"""Where to look: a pass ends at 2²⁸, an index at 2³²; 10⁹ photons are asked for."""

SAMPLERS = ("sobol", "r2", "random")


def distinct(rows):
    """How many different rows there are, to the last bit."""
    return len(np.unique(np.ascontiguousarray(rows).view(f"V{rows.itemsize * rows.shape[-1]}")))


@pytest.mark.parametrize("precision", ["float64", "float32"])
@pytest.mark.parametrize("sampler", SAMPLERS)
def test_photons_from_all_over_a_stream_differ(draw_numbers, sampler, precision):
    index = np.concatenate([first + np.arange(WINDOW) for first in FIRSTS])
    x = draw_numbers(sampler, [(1, 2, 0)], index, precision=precision)[0][:, :5]
    assert distinct(x) == len(index)
    if precision == "float64":
        # Not even one number comes back. Random ones may, once in 2⁵⁴/n² = 5e5 such tests.
        assert all(len(np.unique(u)) == len(index) for u in x.T)


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_photons_of_neighbouring_streams_and_passes_differ(draw_numbers, sampler):
    streams = list(itertools.product((0, 1), range(16), range(4)))
    x = draw_numbers(sampler, streams, np.arange(1024))[..., :5].reshape(-1, 5)
    assert distinct(x) == len(x)


def columns(dimensions, digits):
    """Of each of an index's 32 bits, the first digits of the point that it turns, as one number."""
    tables = sobol_tables().reshape(-1, 4, 256)  # least significant digit first: digit 1 is bit 0
    found = []
    for k in range(32):
        turned = [int(tables[d, k // 8, 1 << k % 8]) % 2**digits for d in dimensions]
        found.append(sum(word << digits * place for place, word in enumerate(turned)))
    return found


def rank(vectors):
    """Rank over the field of two elements."""
    basis = []
    for vector in vectors:
        left = vector
        for one in basis:
            left = min(left, left ^ one)
        if left:
            basis.append(left)
    return len(basis)


def test_sobol_points_are_all_different_by_construction():
    # Points are linear over the bits of the index, and Owen's scramble is one to one on the first
    # digits of each number: if those have rank 32, no two of 2³² photons are alike. In float64 one
    # number is enough; in float32, with 24 digits, the three of a point lamp are, or any two.
    for d in range(5):
        assert rank(columns([d], 32)) == 32
        assert rank(columns([d], 24)) == 24
    for pair in itertools.combinations(range(5), 2):
        assert rank(columns(pair, 24)) == 32


def near_returns(step, most, within):
    """All 0 < k < most with k · step/2⁶⁴ within a distance of whole numbers.

    They are vectors of the lattice of (k, k α − p), short ones in units of `most` and `within`:
    sums of few of its two shortest (Lagrange's reduction).
    """
    alpha, scale = Fraction(step, 2**64), Fraction(within) / most

    def size2(v):
        return (v[0] * scale) ** 2 + v[1] ** 2

    def minus(v, n, w):
        return (v[0] - n * w[0], v[1] - n * w[1])

    a, b = (Fraction(0), Fraction(1)), (Fraction(1), alpha)
    while True:
        if size2(a) > size2(b):
            a, b = b, a
        n = round((a[0] * b[0] * scale**2 + a[1] * b[1]) / size2(a))
        if n == 0:
            break
        b = minus(b, n, a)
    # |n a + m b|² ≥ (n² |a|² + m² |b|²)/2 of a reduced basis; the box's corner has 2 within².
    reach = [int((4 * Fraction(within) ** 2 / size2(v)) ** 0.5) + 1 for v in (a, b)]
    found = set()
    for n in range(-reach[0], reach[0] + 1):
        for m in range(-reach[1], reach[1] + 1):
            k, off = n * a[0] + m * b[0], n * a[1] + m * b[1]
            if 0 < k < most and abs(off) < within:
                found.add(int(k))
    return found


def test_the_r_sequence_does_not_return_by_construction():
    # Two photons share a number of b bits only if k α is within 2⁻ᵇ of a whole number, k being how
    # far apart they are. In float64 that happens in none of the dimensions, below 2³²; in float32
    # in each, but not in all of a point lamp's three at once.
    for step in R5_STEPS:
        assert near_returns(step, 2**32, Fraction(1, 2**53)) == set()
    ever = [near_returns(step, 2**32, Fraction(1, 2**24)) for step in R5_STEPS]
    # Expected 2³² 2⁻²³; lattice points in a box are as many as its area.
    assert all(256 < len(found) < 1024 for found in ever)
    assert ever[0] & ever[1] & ever[2] == set()


def test_near_returns_are_those_that_trying_finds():
    k = np.arange(1, 1 << 20)
    turns = (k.astype(np.uint64) * np.uint64(R5_STEPS[0])) / 2.0**64
    tried = set(k[np.minimum(turns, 1.0 - turns) < 2.0**-16].tolist())
    assert near_returns(R5_STEPS[0], 1 << 20, Fraction(1, 2**16)) == tried


def test_keys_of_many_passes_differ():
    # Hashes of 64 bits: of 2¹⁷ keys two are alike with probability 2³⁴/2⁶⁵ = 5e-10.
    keys = [
        fold_key(seed, pass_index, row)
        for seed in (0, 1, 2**63 - 1)
        for pass_index in (-1, *range(4095), *range(2**20 - 4096, 2**20))
        for row in range(5)
    ]
    assert len(set(keys)) == len(keys) > 2**16
