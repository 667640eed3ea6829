"""Russian roulette: few paths with enough weight instead of many with too little.

Reference:
    Arvo & Kirk (1990), "Particle transport and image synthesis", SIGGRAPH, §4.
"""

from typing import Any

import warp as wp

from sim.sampling.counter import hash64, to_unit

__all__ = ["play_roulette"]


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
