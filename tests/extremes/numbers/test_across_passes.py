"""Photons of different passes, seeds and streams: replicates, if their numbers are independent.

Within one scramble points are anything but independent, and those of two passes at the same index
share the order in which they fill the square: over the indices of two given passes χ² means
nothing. What makes passes replicates is that *one* photon's numbers, over many passes, seeds and
streams, are uniform and independent of each other and of those of the neighbours: then every pass
estimates without bias, and passes do not know of each other (Owen 1998). Here χ² is right, at both
ends, for every sampler.
"""

import itertools

import numpy as np
import pytest

SEEDS, PASSES, ROWS = 64, 256, 2
INDICES = (0, 1, (1 << 16) - 1, (1 << 28) - 1)
"""Photons looked at: first, second, and last, of few and of as many as there can be."""

NUMBERS = range(10)
SAMPLERS = ("sobol", "r2", "random")


@pytest.fixture(scope="module", params=SAMPLERS)
def numbers(request, draw_numbers):
    """(seeds, passes, streams, indices, 10): five numbers of emission and five other draws."""
    streams = itertools.product(range(SEEDS), range(PASSES), range(ROWS))
    found = draw_numbers(request.param, streams, INDICES)
    return found.reshape(SEEDS, PASSES, ROWS, len(INDICES), len(NUMBERS))


def every_pair(one, other):
    """Pairs of every number of one photon and every number of the other, index by index."""
    return [
        (one[..., k, a], other[..., k, b])
        for k in range(len(INDICES)) for a in NUMBERS for b in NUMBERS
    ]


def test_one_photons_numbers_are_uniform_and_independent(numbers, assert_independent):
    assert_independent(
        [
            (numbers[:, :, row, k, a], numbers[:, :, row, k, b])
            for row in range(ROWS) for k in range(len(INDICES))
            for a, b in itertools.combinations(NUMBERS, 2)
        ]
    )


def test_neighbouring_passes_are_independent(numbers, assert_independent):
    assert_independent(every_pair(numbers[:, 0::2], numbers[:, 1::2]))


def test_neighbouring_seeds_are_independent(numbers, assert_independent):
    assert_independent(every_pair(numbers[0::2], numbers[1::2]))


def test_streams_of_one_pass_are_independent(numbers, assert_independent):
    assert_independent(every_pair(numbers[:, :, 0], numbers[:, :, 1]))


def test_scrambling_leaves_pairs_of_photons_as_free_as_owen_does(draw_numbers, assert_independent):
    # Owen (1998): of two points of a dimension that agree in k digits, the scrambled ones do too;
    # digit k + 1 differs; all further digits of both are uniform and independent. The variance of
    # every scrambled net's estimate rests on it.
    streams = list(itertools.product(range(SEEDS), range(PASSES)))
    photons = np.array([0, 1, 2, 3, 5, 6, 1000, 65535, 65536, (1 << 28) - 1])
    x = draw_numbers("sobol", [(*one, 0) for one in streams], photons)[..., :5]
    words = (x * 2.0**32).astype(np.uint64)
    pairs = []
    for (i, j), d in itertools.product(itertools.combinations(range(len(photons)), 2), range(5)):
        one, other = words[:, i, d], words[:, j, d]
        common = 32 - np.floor(np.log2((one ^ other).astype(np.float64))).astype(int) - 1
        k = common[0]
        assert np.all(common == k)
        if k < 24:  # eight further digits for χ² to look at
            pairs.append(tuple((x[:, n, d] * 2.0 ** (k + 1)) % 1.0 for n in (i, j)))
    assert len(pairs) > 200
    assert_independent(pairs, boxes=8)


def test_the_r_sequence_is_shifted_as_a_whole(draw_numbers):
    # It is no scrambling: two photons keep their distance modulo 1, and only the shift is random.
    x = draw_numbers("r2", [(0, p, 0) for p in range(50)], INDICES)[..., :5]
    distance = (x[:, 1:] - x[:, :1]) % 1.0
    off = np.abs(distance - distance[:1])
    assert np.minimum(off, 1.0 - off).max() < 2.0**-51
