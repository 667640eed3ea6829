"""How far a flat shape reaches from one of its points, direction by direction.

A gather disc that overhangs its receiver's edge loses light: a uniform irradiance would read one
half at a straight edge and a quarter at a corner. These distances let the kernel be normalised
over the part of the disc that lies on the receiver.
"""

from typing import Any

import warp as wp

__all__ = ["distance_to_circle", "distance_to_planes", "distance_to_sides"]


@wp.func
def distance_to_sides(u: Any, v: Any, half_u: Any, half_v: Any, cos_phi: Any, sin_phi: Any):
    """Distance from (u, v) inside a rectangle to its boundary in direction (cosφ, sinφ)."""
    distance = type(u)(wp.inf)
    if cos_phi > type(u)(0.0):
        distance = (half_u - u) / cos_phi
    elif cos_phi < type(u)(0.0):
        distance = (-half_u - u) / cos_phi
    if sin_phi > type(u)(0.0):
        distance = wp.min(distance, (half_v - v) / sin_phi)
    elif sin_phi < type(u)(0.0):
        distance = wp.min(distance, (-half_v - v) / sin_phi)
    return wp.max(distance, type(u)(0.0))


@wp.func
def distance_to_circle(u: Any, v: Any, radius2: Any, cos_phi: Any, sin_phi: Any):
    """Distance from (u, v) inside a circle about the origin to it in direction (cosφ, sinφ)."""
    along = u * cos_phi + v * sin_phi
    across = u * sin_phi - v * cos_phi
    return wp.sqrt(wp.max(radius2 - across * across, type(u)(0.0))) - along


@wp.func
def distance_to_planes(
    point: Any, direction: Any, planes: Any, first: int, count: int, face: int
):
    """Distance on face `face` of a convex polyhedron to that face's boundary.

    `point` is relative to the polyhedron's centre and `direction` a unit vector in the face.
    """
    distance = type(point[0])(wp.inf)
    for other in range(first, first + count):
        if other != face:
            plane = planes[other]
            approach = wp.dot(plane.normal, direction)
            if approach > type(point[0])(0.0):
                room = plane.offset - wp.dot(plane.normal, point)
                distance = wp.min(distance, room / approach)
    return wp.max(distance, type(point[0])(0.0))
