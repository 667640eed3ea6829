"""The random numbers of any photon of any stream: what it is made of, and what befalls it."""

import functools

import numpy as np
import pytest
import warp as wp
from scipy.stats import chi2

from sim.device import start_device
from sim.precision import precision_types
from sim.sampling.counter import fold_key, hash64, to_unit
from sim.sampling.draws import BOUNCE, BOUNCE_ROULETTE, FAINT_BRANCH, LOT, SPLIT, first_draw
from sim.sampling.photon_numbers import make_photon_numbers
from sim.sampling.sobol import DIMENSIONS, sobol_tables


@functools.cache
def make_draw(precision, sampler):
    """Kernel: of photon `indices[i]` of stream `rows[i]`, the numbers that it may use.

    Five of its emission, and one each for the other purposes, of one surface.
    """
    real = precision_types(precision).real
    photon_numbers = make_photon_numbers(precision, sampler)

    @wp.kernel(module="unique", enable_backward=False)
    def draw(
        sobol: wp.array(dtype=wp.uint32), seeds: wp.array(dtype=wp.uint32),
        keys: wp.array(dtype=wp.uint64), rows: wp.array(dtype=int),
        indices: wp.array(dtype=wp.uint32), step: int, out: wp.array2d(dtype=real),
    ):
        i = wp.tid()
        key = keys[rows[i]]
        u0, u1, u2, u3, u4 = photon_numbers(sobol, seeds, 5 * rows[i], indices[i], key)
        out[i, 0] = u0
        out[i, 1] = u1
        out[i, 2] = u2
        out[i, 3] = u3
        out[i, 4] = u4
        counter = first_draw(indices[i], 0) + wp.uint64(step)
        out[i, 5] = to_unit(hash64(key + SPLIT, counter), u0)
        out[i, 6] = to_unit(hash64(key + FAINT_BRANCH, counter), u0)
        out[i, 7] = to_unit(hash64(key + BOUNCE, counter), u0)
        out[i, 8] = to_unit(hash64(key + BOUNCE_ROULETTE, counter), u0)
        out[i, 9] = to_unit(hash64(key + LOT, counter), u0)

    return draw


@functools.cache
def seeds_and_keys(streams):
    """As `Lamps.seed` and `make_job` have them; test_delivery.py holds that they do."""
    seeds = [
        fold_key(seed, pass_index, row * DIMENSIONS + k) & 0xFFFFFFFF
        for seed, pass_index, row in streams for k in range(DIMENSIONS)
    ]
    keys = [fold_key(*stream) for stream in streams]
    return np.array(seeds, dtype=np.uint32), np.array(keys, dtype=np.uint64)


@pytest.fixture(scope="session")
def draw_numbers():
    """Function of a sampler and (seed, pass, stream) triples: (streams, indices, 10) numbers."""
    return _draw_numbers


def _draw_numbers(sampler, streams, indices, *, step=0, precision="float64"):
    device = start_device("cpu")
    seeds, keys = seeds_and_keys(tuple(streams))
    rows, index = np.meshgrid(np.arange(len(keys)), indices, indexing="ij")
    out = wp.zeros((rows.size, 10), dtype=precision_types(precision).real, device=device)
    inputs = [
        wp.array(sobol_tables(), dtype=wp.uint32, device=device),
        wp.array(seeds, dtype=wp.uint32, device=device),
        wp.array(keys, dtype=wp.uint64, device=device),
        wp.array(rows.ravel(), dtype=int, device=device),
        wp.array(index.ravel().astype(np.uint32), dtype=wp.uint32, device=device),
        step, out,
    ]  # fmt: skip
    wp.launch(make_draw(precision, sampler), dim=rows.size, inputs=inputs, device=device)
    return out.numpy().reshape(*rows.shape, 10)


@pytest.fixture(scope="session")
def assert_independent():
    """Assert that pairs of numbers fill boxes as uniform, independent ones do; see below."""
    return _assert_independent


def _assert_independent(pairs, *, boxes=16, fixed=0):
    """χ² over boxes × boxes, of all pairs together at a level of 1e-3.

    Both tails count: numbers that lie too evenly are not independent either. Each of M tests may
    be off by 1e-3/(2 M) at each end (Bonferroni); seeds are fixed, so it either passes or not.
    The sums have boxes² − 1 degrees of freedom if all is left to chance. `fixed` counts the
    numbers of a pair of which each of the `boxes` intervals has its exact share already: each
    takes boxes − 1 away.
    """
    dof = boxes**2 - 1 - fixed * (boxes - 1)
    tail = 1e-3 / (2.0 * len(pairs))
    for number, (u, v) in enumerate(pairs):
        cell = (np.ravel(u) * boxes).astype(int) * boxes + (np.ravel(v) * boxes).astype(int)
        expected = cell.size / boxes**2
        assert expected >= 64.0  # so that the sum is distributed as χ²
        counts = np.bincount(cell, minlength=boxes**2)
        p = chi2.cdf(np.sum((counts - expected) ** 2) / expected, dof)
        assert tail < p < 1.0 - tail, f"pair {number} of {len(pairs)}: p = {p:.3g}"
