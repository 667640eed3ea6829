"""Points of Kronecker sequences: well spread, however many are taken.

The sequences run in 32-bit fixed point, where a float32 product would have no digits left of its
fraction after some 10⁶ points, and are shifted at random for each of their users.

Reference:
    Roberts (2018), "The unreasonable effectiveness of quasirandom sequences": steps 1/φ on the
    line, and 1/g and 1/g² on the square, with g the real root of g³ = g + 1.
"""

from typing import Any

import warp as wp

from sim.sampling.counter import hash64, to_unit

__all__ = ["r1_point", "r2_point"]

STEP = wp.constant(wp.uint32(0x9E3779B9))
"""1/φ = 0.6180339887… in units of 2⁻³²; all steps are odd, and so return only after 2³² points."""
STEP_X = wp.constant(wp.uint32(0xC13FA9A9))
"""1/g = 0.7548776662… in units of 2⁻³²."""
STEP_Y = wp.constant(wp.uint32(0x91E10DA5))
"""1/g² = 0.5698402910… in units of 2⁻³²."""


@wp.func
def unit_of(bits: wp.uint32, like: Any):
    """A number in [0, 1) of the precision of `like`: all 32 bits, in float32 the top 24."""
    return to_unit(wp.uint64(bits) << wp.uint64(32), like)


@wp.func
def r1_point(key: wp.uint64, index: wp.uint32, like: Any):
    """Number `index` in [0, 1) of the golden sequence that `key` shifts."""
    return unit_of(wp.uint32(hash64(key, wp.uint64(0))) + STEP * index, like)


@wp.func
def r2_point(key: wp.uint64, index: wp.uint32, like: Any):
    """Point (x, y) in [0, 1)² number `index` of the R2 sequence that `key` shifts."""
    shift = hash64(key, wp.uint64(0))
    x = wp.uint32(shift) + STEP_X * index
    y = wp.uint32(shift >> wp.uint64(32)) + STEP_Y * index
    return unit_of(x, like), unit_of(y, like)
