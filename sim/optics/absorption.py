"""Beer–Lambert absorption along a way through a medium.

Reference:
    Born & Wolf (1999), *Principles of Optics*, 7th ed., §4.11.4 and §14.1 eq. (20): the flux falls
    as exp(−α d), α the Napierian absorption coefficient.
"""

from typing import Any

import warp as wp

__all__ = ["absorbed_fraction"]


@wp.func
def absorbed_fraction(alpha: Any, distance: Any):
    """1 − exp(−α d), with all its digits where little is absorbed; everything where d is infinite.

    Args:
        alpha: Napierian coefficient [1/m], 0 or more.
        distance: way through the medium [m]; less than 0, by rounding, counts as 0.
    """
    zero = type(alpha)(0.0)
    one = type(alpha)(1.0)
    if alpha <= zero or distance <= zero:
        return zero  # before ∞ · 0 makes no number
    depth = alpha * distance
    if depth < type(alpha)(1e-3):
        # 1 − exp(−x) keeps only the digits that x has in 1: the series keeps all of x's.
        half = depth * type(alpha)(0.5)
        third = depth / type(alpha)(3.0)
        fourth = depth * type(alpha)(0.25)
        return depth * (one - half * (one - third * (one - fourth)))
    return one - wp.exp(-depth)
