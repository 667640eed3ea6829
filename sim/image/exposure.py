"""How bright a picture is developed: stops, and the automatic choice of them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["WHITE_QUANTILE", "automatic_stops"]

# This share of the lit pixels is developed without burning out in any channel.
WHITE_QUANTILE = 0.99


def automatic_stops(linear_rgb: NDArray[np.float64]) -> float:
    """Choose an exposure that shows nearly everything and burns out only the brightest spots.

    A pixel's level is its largest linear sRGB channel, not its luminance: a saturated blue is at
    its display limit when its luminance is 0.07, and exposing it for a luminance of 1 would wash
    every spectrum out to white. The exposure brings the `WHITE_QUANTILE` quantile of the levels
    of all lit pixels (level > 0) to 1.

    Args:
        linear_rgb: Linear sRGB, shape (height, width, 3), any unit.

    Returns:
        Stops e, such that ``linear_rgb * 2**e`` is the picture with white at 1; 0 for a picture
        that is black all over.
    """
    level = linear_rgb.max(axis=-1)
    lit = level[np.isfinite(level) & (level > 0.0)]
    if lit.size == 0:
        return 0.0
    return -math.log2(float(np.quantile(lit, WHITE_QUANTILE)))
