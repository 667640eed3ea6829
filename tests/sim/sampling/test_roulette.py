"""Roulette keeps every expectation: of one path, and of two branches with or without room."""

import numpy as np
import pytest
import warp as wp

from sim.sampling.roulette import choose_branches

COUNT = 1 << 16
STRONGER, THRESHOLD = 0.7, 0.1


@wp.kernel(module="unique", enable_backward=False)
def branch(weaker: wp.float64, room: int, out: wp.array2d(dtype=wp.float64)):
    i = wp.tid()
    stronger = wp.float64(0.7)
    now, later, swapped = choose_branches(
        stronger, weaker, wp.float64(0.1), room == 1, wp.uint64(3), wp.uint64(i)
    )
    out[i, 0] = now
    out[i, 1] = later
    if swapped:
        out[i, 2] = wp.float64(1.0)


def branches(weaker, *, room):
    out = wp.zeros((COUNT, 3), dtype=wp.float64, device="cpu")
    wp.launch(branch, dim=COUNT, inputs=[weaker, int(room), out], device="cpu")
    return out.numpy().T


def test_a_branch_that_matters_waits_as_it_is():
    now, later, swapped = branches(0.3, room=True)
    assert np.all(now == STRONGER)
    assert np.all(later == 0.3)
    assert not swapped.any()


@pytest.mark.parametrize("weaker", [0.03, 0.001])
def test_a_faint_one_survives_with_the_thresholds_weight(weaker):
    # With probability p = w/t it weighs t: the mean is w, its σ √(p (1 − p)/n) t.
    now, later, _ = branches(weaker, room=True)
    assert np.all(now == STRONGER)
    assert set(np.unique(later)) == {0.0, THRESHOLD}
    p = weaker / THRESHOLD
    assert abs(later.mean() - weaker) < 5.0 * np.sqrt(p * (1.0 - p) / COUNT) * THRESHOLD


@pytest.mark.parametrize("weaker", [0.3, 0.03])
def test_without_room_one_goes_on_for_both(weaker):
    # Either carries the whole weight, the weaker one with probability p = w/(s + w).
    now, later, swapped = branches(weaker, room=False)
    assert np.all(now == STRONGER + weaker)
    assert not later.any()
    p = weaker / (STRONGER + weaker)
    assert abs(swapped.mean() - p) < 5.0 * np.sqrt(p * (1.0 - p) / COUNT)
