"""How far a smooth patch of a mesh reaches from one of its points, direction by direction.

A straight line on the surface goes on, from triangle to triangle, in the direction it had turned
into the next one's plane; sharp edges and borders end it.
"""

from typing import Any

import warp as wp

__all__ = ["distance_on_mesh"]

MAX_TRIANGLES = wp.constant(64)
"""A line that crosses as many has not met a border near by."""


@wp.func
def distance_on_mesh(meshes: Any, start_face: int, start: Any, start_way: Any, limit: Any):
    """Distance from a point of a triangle along its surface to the patch's border, or `limit`.

    Args:
        meshes: struct with the arrays of all meshes.
        start_face: the triangle.
        start: the point, relative to the mesh's centre.
        start_way: unit, in the triangle's plane.
        limit: what is farther does not matter.
    """
    zero = type(limit)(0.0)
    point = start * type(limit)(1.0)
    way = start_way * type(limit)(1.0)
    face = int(start_face)
    gone = zero * type(limit)(1.0)
    crossed = int(0)
    while crossed < MAX_TRIANGLES:
        triangle = meshes.triangles[face]
        normal = wp.cross(triangle.b - triangle.a, triangle.c - triangle.a)
        step = type(limit)(wp.inf)
        side = int(0)
        for k in range(3):
            corner = wp.where(k == 0, triangle.a, wp.where(k == 1, triangle.b, triangle.c))
            end = wp.where(k == 0, triangle.b, wp.where(k == 1, triangle.c, triangle.a))
            outward = wp.cross(end - corner, normal)
            approach = wp.dot(outward, way)
            if approach > zero:
                t = wp.max(wp.dot(outward, corner - point) / approach, zero)
                if t < step:
                    step = t
                    side = k
        gone += step
        face = meshes.borders[face].across[side]
        if gone >= limit:
            return limit
        if face < 0:
            return gone
        point += way * step
        ahead = meshes.triangles[face]
        plane = wp.normalize(wp.cross(ahead.b - ahead.a, ahead.c - ahead.a))
        way = wp.normalize(way - plane * wp.dot(way, plane))
        crossed += 1
    return limit
