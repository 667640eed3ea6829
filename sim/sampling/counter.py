"""Counter-based random numbers: a hash of what is being drawn, with no state to collide.

Every number is a function of (key, counter): the key holds the seed, the pass and the photon, the
counter says which draw of that photon it is. Warp's own stream (`wp.randf`) feeds 32 bits of
output back as state, and repeats itself within 10⁸ photons.

Reference:
    Steele, Lea & Flood (2014), "Fast splittable pseudorandom number generators", OOPSLA, fig. 12
    (the finaliser of SplitMix64: a bijection of 64 bits, so distinct counters never collide).
"""

import numpy as np
import warp as wp

__all__ = ["fold_key", "hash64", "seed_words", "to_unit"]

_GOLDEN = 0x9E3779B97F4A7C15
_MIX_1 = 0xBF58476D1CE4E5B9
_MIX_2 = 0x94D049BB133111EB
_MASK = 0xFFFFFFFFFFFFFFFF

GOLDEN = wp.constant(wp.uint64(_GOLDEN))
MIX_1 = wp.constant(wp.uint64(_MIX_1))
MIX_2 = wp.constant(wp.uint64(_MIX_2))


@wp.func
def hash64(key: wp.uint64, counter: wp.uint64):
    """64 random bits of draw number `counter` under `key` (SplitMix64)."""
    z = key + GOLDEN * (counter + wp.uint64(1))
    z = (z ^ (z >> wp.uint64(30))) * MIX_1
    z = (z ^ (z >> wp.uint64(27))) * MIX_2
    return z ^ (z >> wp.uint64(31))


@wp.func
def to_unit(bits: wp.uint64, like: wp.float32):
    """A number in [0, 1) of the precision of `like`: in float32 the top 24 bits, exactly."""
    return wp.float32(bits >> wp.uint64(40)) * wp.float32(5.9604644775390625e-08)


# Warp chooses by the type of `like`.
@wp.func  # type: ignore[no-redef]
def to_unit(bits: wp.uint64, like: wp.float64):  # noqa: F811
    """A number in [0, 1) of the precision of `like`: in float64 the top 53 bits, exactly."""
    return wp.float64(bits >> wp.uint64(11)) * wp.float64(1.1102230246251565e-16)


def fold_key(*parts: int) -> int:
    """Hash integers (seed, pass, purpose …) into one 64-bit key, on the host."""
    key = 0
    for part in parts:
        key = (key ^ (part & _MASK)) + _GOLDEN & _MASK
        key = (key ^ (key >> 30)) * _MIX_1 & _MASK
        key = (key ^ (key >> 27)) * _MIX_2 & _MASK
        key ^= key >> 31
    return key


def seed_words(count: int, *parts: int) -> np.ndarray:
    """`count` uint32 scramble seeds, one a Sobol dimension, from the integers of `fold_key`."""
    return np.array([fold_key(*parts, i) & 0xFFFFFFFF for i in range(count)], dtype=np.uint32)
