"""Kronecker sequences: their steps, their shifts, and how evenly they lie."""

import numpy as np
import pytest
import warp as wp

from sim.sampling.kronecker import r1_point, r2_point

COUNT = 4096
GOLDEN = (1.0 + np.sqrt(5.0)) / 2.0
PLASTIC = 1.324717957244746
"""The real root of g³ = g + 1."""


@wp.kernel(module="unique", enable_backward=False)
def draw(key: wp.uint64, first: wp.uint32, out: wp.array2d(dtype=wp.float64)):
    i = wp.tid()
    x, y = r2_point(key, first + wp.uint32(i), wp.float64(0.0))
    out[i, 0] = x
    out[i, 1] = y
    out[i, 2] = r1_point(key, first + wp.uint32(i), wp.float64(0.0))


def points(key=1, first=0):
    out = wp.zeros((COUNT, 3), dtype=wp.float64, device="cpu")
    wp.launch(draw, dim=COUNT, inputs=[key, first, out], device="cpu")
    return out.numpy()


@pytest.mark.parametrize("first", [0, 10**9])
def test_each_point_is_one_step_on(first):
    # x_{i+1} = x_i + α mod 1, also far out, where i α in float32 has no fraction left: exactly, but
    # for the last of a step's 32 bits, which was made odd.
    steps = np.diff(points(first=first), axis=0) % 1.0
    expected = [1.0 / PLASTIC, 1.0 / PLASTIC**2, 1.0 / GOLDEN]
    np.testing.assert_allclose(steps, np.broadcast_to(expected, steps.shape), rtol=0, atol=2.0**-32)


def test_keys_shift_it():
    offset = (points(key=2) - points(key=1)) % 1.0
    assert np.ptp(offset[:, 0]) == 0.0
    assert not np.allclose(offset[0], 0.0, atol=1e-3)


def test_boxes_hold_their_share():
    # Random points miss each of 64 boxes' shares by √(p (1 − p)/n), p = 1/64, root mean square;
    # the sequence by less than a third of that.
    x = points()
    unit = ((0.0, 1.0), (0.0, 1.0))
    shares = np.histogram2d(x[:, 0], x[:, 1], bins=8, range=unit)[0] / COUNT
    p = 1.0 / 64.0
    assert np.sqrt(np.mean((shares - p) ** 2)) < np.sqrt(p * (1.0 - p) / COUNT) / 3.0
    assert x.min() >= 0.0
    assert x.max() < 1.0
