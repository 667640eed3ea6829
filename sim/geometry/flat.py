"""Ray and plane: the ground of rectangles, disks and endless planes."""

from typing import Any

import warp as wp

__all__ = ["intersect_plane", "plane_coordinates"]


@wp.func
def intersect_plane(origin: Any, direction: Any, normal: Any):
    """Distance to the plane through the frame's origin, or −1 where the ray runs away from it."""
    zero = type(origin[0])(0.0)
    approach = wp.dot(direction, normal)
    if approach == zero:
        return type(approach)(-1.0)
    t = -wp.dot(origin, normal) / approach
    if t < zero:
        t = type(approach)(-1.0)
    return t


@wp.func
def plane_coordinates(point: Any, frame: Any):
    """Coordinates (along u, along v) of a point relative to the flat's centre.

    The rows of `frame` are u, v and the normal.
    """
    local = frame * point
    return local[0], local[1]
