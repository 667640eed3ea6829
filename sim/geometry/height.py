"""How high a point lies above a surface, negative inside it, and which way is up there.

A ray's vertex may lie on the surfaces of two objects at once, or inside another: these heights
tell. They are exact distances near the surface, where they decide.
"""

from typing import Any

import warp as wp

from sim.geometry.lens import BACK_FACE, FRONT_FACE, RIM_FACE, lens_normal

__all__ = [
    "height_above_flat",
    "height_above_lens",
    "height_above_polyhedron",
    "height_above_sphere",
]


@wp.func
def height_above_sphere(point: Any, radius: Any):
    """Height [m] above a sphere about the origin, and the outward unit normal."""
    distance = wp.length(point)
    if distance == type(radius)(0.0):
        return -radius, point
    return distance - radius, point / distance


@wp.func
def height_above_polyhedron(point: Any, planes: Any, first: int, count: int):
    """Height [m] above a convex polyhedron about the origin, the nearest face, its normal."""
    height = -type(point[0])(wp.inf)
    nearest = int(first)
    face = int(first)
    while face < first + count:
        above = wp.dot(planes[face].normal, point) - planes[face].offset
        if above > height:
            height = above
            nearest = face
        face += 1
    return height, nearest, planes[nearest].normal


@wp.func
def height_above_flat(point: Any, flat: Any):
    """Height [m], ≥ 0, above a flat's nearer side, infinite beyond its limits; its normal."""
    u = wp.dot(point, flat.frame[0])
    v = wp.dot(point, flat.frame[1])
    height = wp.abs(wp.dot(point, flat.frame[2]))
    if wp.abs(u) > flat.half_u or wp.abs(v) > flat.half_v or u * u + v * v > flat.radius2:
        height = type(point[0])(wp.inf)
    return height, flat.frame[2]


@wp.func
def cap_sag(rho2: Any, curvature: Any, one_plus_conic: Any):
    """Height of a cap above its vertex's tangent plane, `rho2` = ρ² off the axis."""
    one = type(curvature)(1.0)
    root2 = one - one_plus_conic * curvature * curvature * rho2
    return curvature * rho2 / (one + wp.sqrt(wp.max(root2, type(curvature)(0.0))))


@wp.func
def cap_cosine(rho2: Any, curvature: Any, one_plus_conic: Any):
    """Cosine of a cap's slope against its vertex's tangent plane, `rho2` = ρ² off the axis."""
    zero = type(curvature)(0.0)
    one = type(curvature)(1.0)
    slope2 = curvature * curvature * rho2
    root2 = wp.max(one - one_plus_conic * slope2, zero)
    if root2 + slope2 == zero:
        return one
    return wp.sqrt(root2 / (root2 + slope2))


@wp.func
def height_above_lens(lens: Any, point: Any):
    """Height [m] above a lens, the nearest face, its outward normal; all in the lens's frame."""
    rho2 = point[0] * point[0] + point[1] * point[1]
    within2 = wp.min(rho2, lens.radius * lens.radius)
    z_front = cap_sag(within2, lens.curvature_front, lens.one_plus_conic_front)
    z_back = cap_sag(within2, lens.curvature_back, lens.one_plus_conic_back)
    # Along the axis first; the slope of the cap turns that into a distance.
    height = (z_front - lens.half_thickness - point[2]) * cap_cosine(
        within2, lens.curvature_front, lens.one_plus_conic_front
    )
    face = int(FRONT_FACE)
    above_back = (point[2] - lens.half_thickness - z_back) * cap_cosine(
        within2, lens.curvature_back, lens.one_plus_conic_back
    )
    if above_back > height:
        height = above_back
        face = BACK_FACE
    above_rim = wp.sqrt(rho2) - lens.radius
    if above_rim > height:
        height = above_rim
        face = RIM_FACE
    return height, face, wp.normalize(lens_normal(lens, face, point))
