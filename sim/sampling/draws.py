"""What a photon's random numbers are for, and why no two of them are the same one.

Under a stream's key every purpose has an offset d of its own, and `hash64(key + d, c)` mixes
key + d + G (c + 1), one to one. So two draws are the same only if their counters differ by
(d − d′) G⁻¹ modulo 2⁶⁴. For the offsets below that is more than 2⁵⁹ either way, and counters stay
below 2⁵² + 2²⁴: of 2²⁸ photons, each has 2²⁴ numbers of every kind.

Keys of streams are hashes of seed, pass and stream. Those of 2²⁰ passes of a hundred streams are
all different but with probability 2⁻¹²; and where two streams of n draws start at random places of
the 2⁶⁴, they overlap with probability n 2⁻⁶³.
"""

import warp as wp

__all__ = [
    "BOUNCE",
    "BOUNCE_ROULETTE",
    "EMISSION",
    "FAINT_BRANCH",
    "LOT",
    "SPLIT",
    "first_draw",
]

EMISSION = wp.constant(wp.uint64(0))
"""The numbers that a photon is made of."""
SPLIT = wp.constant(wp.uint64(1))
"""Which branches of a split go on."""
FAINT_BRANCH = wp.constant(wp.uint64(2))
"""Whether the stronger branch, once it is faint, goes on."""
BOUNCE = wp.constant(wp.uint64(3))
"""Where a diffuse surface reflects."""
BOUNCE_ROULETTE = wp.constant(wp.uint64(4))
"""Whether it does."""
LOT = wp.constant(wp.uint64(0x5E2504))
"""Whether a ray stays on a sensor that has no room for all."""


@wp.func
def first_draw(index: wp.uint32, colour: int):
    """The counter of what befalls colour number `colour` of a photon at its first surface.

    The next surface has the next counter: there is room for 2¹⁷ of them, and for 2⁷ colours.
    """
    return (wp.uint64(index) << wp.uint64(24)) + (wp.uint64(colour) << wp.uint64(17))
