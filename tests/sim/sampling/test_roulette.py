"""Roulette keeps every expectation: of one path, and of two branches with or without room."""

import numpy as np
import pytest
import warp as wp

from sim.sampling.roulette import choose_branches, play_roulette

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


GOLDEN, MIX_1, MIX_2 = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


def counter_of(bits, key):
    """The counter whose `hash64` is `bits`: SplitMix64's steps (Steele et al. 2014) undone."""
    z = bits
    for shift, factor in ((31, MIX_2), (27, MIX_1), (30, 1)):
        x = z
        for _ in range(64 // shift):
            x = z ^ (x >> shift)  # `shift` more of the first bits are right
        z = x * pow(factor, -1, 2**64) % 2**64
    return ((z - key) * pow(GOLDEN, -1, 2**64) - 1) % 2**64


@wp.kernel(module="unique", enable_backward=False)
def play(
    weights: wp.array(dtype=wp.float64), counters: wp.array(dtype=wp.uint64),
    out: wp.array(dtype=wp.float64),
):
    i = wp.tid()
    out[i] = play_roulette(weights[i], wp.float64(0.01), wp.uint64(3), counters[i])


def test_the_faintest_survive_no_more_often_than_they_should():
    # w of threshold t goes on if u < w/t: with p = 2⁻³⁰ not at u = 2⁻²⁹, though its first 24 bits
    # are zero, and with p = 2⁻²⁸ it does. With 24 bits p would be 2⁻²⁴ for both: 64 times p.
    t, u = 0.01, 2.0**-29
    weights = np.array([t * 2.0**-30, t * 2.0**-28, t * 0.75 * u, t * 1.25 * u])
    counters = np.full(4, counter_of(int(u * 2.0**64), 3), dtype=np.uint64)
    out = wp.zeros(4, dtype=wp.float64, device="cpu")
    inputs = [wp.array(weights, dtype=wp.float64, device="cpu"),
              wp.array(counters, dtype=wp.uint64, device="cpu")]  # fmt: skip
    wp.launch(play, dim=4, inputs=inputs, outputs=[out], device="cpu")
    assert out.numpy().tolist() == [0.0, t, 0.0, t]
