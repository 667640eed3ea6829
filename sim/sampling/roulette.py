"""Russian roulette: few paths with enough weight instead of many with too little.

Reference:
    Arvo & Kirk (1990), "Particle transport and image synthesis", SIGGRAPH, §4.
"""

from typing import Any

import warp as wp

from sim.sampling.counter import hash64, to_unit

__all__ = ["choose_branches", "play_roulette"]


@wp.func
def play_roulette(weight: Any, threshold: Any, key: wp.uint64, counter: wp.uint64):
    """The weight to go on with: `weight` itself if it reaches `threshold`, else that or 0.

    A smaller weight survives with probability weight/threshold, so the expectation is kept.
    """
    if weight >= threshold:
        return weight
    if to_unit(hash64(key, counter), weight) * threshold < weight:
        return threshold
    return type(weight)(0.0)


@wp.func
def choose_branches(
    stronger: Any, weaker: Any, threshold: Any, room: bool, key: wp.uint64, counter: wp.uint64
):
    """What goes on of the two branches of a split, of which the weaker one needs room to wait.

    With room the stronger one goes on as it is, and the weaker one plays roulette. Without, chance
    lets one of them go on for the light of both.

    Returns:
        The weights that go on at once and that wait, and whether the weaker one goes on at once.
    """
    if room:
        return stronger, play_roulette(weaker, threshold, key, counter), False
    both = stronger + weaker
    swapped = play_roulette(weaker, both, key, counter) > type(weaker)(0.0)
    return both, type(weaker)(0.0), swapped
