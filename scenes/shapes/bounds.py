"""Spheres around shapes: what emission is aimed at."""

import numpy as np
from numpy.typing import NDArray

__all__ = ["Bounds", "sphere_around"]

Bounds = tuple[NDArray[np.float64], float]
"""A sphere: centre (3,) and radius [m]."""


def sphere_around(points: NDArray[np.float64]) -> Bounds:
    """A sphere around points, centred on the middle of their axis-aligned box.

    Not the smallest one, but for a box it is, and never more than √3 times as large.

    Args:
        points: (k, 3) [m].
    """
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return centre, float(np.linalg.norm(points - centre, axis=1).max())
