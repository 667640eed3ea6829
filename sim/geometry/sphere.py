"""Ray and sphere, the ray's origin taken relative to the centre.

Reference:
    Haines, Günther & Akenine-Möller (2019), "Precision improvements for ray/sphere
    intersection", *Ray Tracing Gems*, ch. 7: the discriminant from the distance of the ray to
    the centre, which keeps its digits far away.
"""

from typing import Any

import warp as wp

__all__ = ["intersect_sphere"]


@wp.func
def intersect_sphere(origin: Any, direction: Any, radius: Any, leaving: bool):
    """Distance to the sphere, or −1 where the ray misses it.

    A ray that leaves the surface excludes the root it stands on: going inward it meets the
    sphere again at −2 (o·d), going outward never.
    """
    zero = type(radius)(0.0)
    miss = type(radius)(-1.0)
    b = -wp.dot(origin, direction)
    if leaving:
        if b > zero:
            return b + b
        return miss
    closest = origin + direction * b
    discriminant = radius * radius - wp.dot(closest, closest)
    if discriminant < zero:
        return miss
    half_chord = wp.sqrt(discriminant)
    t = b - half_chord
    if t < zero:
        t = b + half_chord
    if t < zero:
        t = miss
    return t
