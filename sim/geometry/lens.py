"""Ray and lens: two conic caps and the cylinder between their edges, in the lens's own frame.

The axis is z and the frame's origin lies midway between the two vertices. A cap with vertex
curvature c and conic constant κ is the sheet through its vertex of
``F = c (x² + y² + (1 + κ) z²) − 2 z = 0``, which is a plane at c = 0: no special case.

A ray that has entered the glass goes out where it first passes one of the two caps or the
cylinder (`exit_cap`, `exit_rim`), whatever their edges: there is no seam to slip through.

Reference:
    Welford (1986), *Aberrations of Optical Systems*, §4.2: quadrics in vertex form.
    Press et al. (2007), *Numerical Recipes*, §5.6: roots of a quadratic without cancellation.
"""

from typing import Any

import warp as wp

__all__ = [
    "BACK_FACE",
    "FRONT_FACE",
    "RIM_FACE",
    "cap_normal",
    "exit_cap",
    "exit_rim",
    "intersect_cap",
    "intersect_lens",
    "intersect_rim",
    "lens_normal",
]

FRONT_FACE = wp.constant(0)
BACK_FACE = wp.constant(1)
RIM_FACE = wp.constant(2)


@wp.func
def quadratic_roots(a: Any, half_b: Any, c: Any):
    """Roots of a t² + 2 b t + c in ascending order; inf for one that is not there."""
    zero = type(a)(0.0)
    infinity = type(a)(wp.inf)
    discriminant = half_b * half_b - a * c
    if discriminant < zero:
        return infinity, infinity
    q = -half_b - wp.sqrt(discriminant)
    if half_b < zero:
        q = -half_b + wp.sqrt(discriminant)
    t0 = infinity
    t1 = infinity
    if q != zero:
        t0 = c / q
    if a != zero:
        t1 = q / a
    if t1 < t0:
        return t1, t0
    return t0, t1


@wp.func
def on_sheet(z: Any, curvature: Any, one_plus_conic: Any):
    """Whether a height is on the vertex's sheet, not an ellipsoid's far half or a second sheet."""
    return one_plus_conic * curvature * z <= type(z)(1.0)


@wp.func
def on_cap(point: Any, curvature: Any, one_plus_conic: Any, rho2_limit: Any):
    """Whether a point of the quadric lies on the sheet of its vertex and inside the aperture."""
    rho2 = point[0] * point[0] + point[1] * point[1]
    return rho2 <= rho2_limit and on_sheet(point[2], curvature, one_plus_conic)


@wp.func
def intersect_cap(
    origin: Any, direction: Any, curvature: Any, one_plus_conic: Any, rho2_limit: Any, leaving: bool
):
    """Distance to a cap whose vertex is the frame's origin, or −1.

    Args:
        origin: relative to the cap's vertex [m].
        direction: unit.
        curvature: at the vertex, signed [1/m].
        one_plus_conic: 1 + κ.
        rho2_limit: square of half the clear aperture, a few ulps more [m²].
        leaving: the ray starts on this cap; that root is left out exactly.
    """
    zero = type(rho2_limit)(0.0)
    # From its point of closest approach to the vertex the quadratic keeps its digits.
    shift = -wp.dot(origin, direction)
    if leaving:
        shift = zero
    start = origin + direction * shift
    bulge = one_plus_conic * curvature
    a = curvature * (direction[0] * direction[0] + direction[1] * direction[1])
    a += bulge * direction[2] * direction[2]
    half_b = curvature * (start[0] * direction[0] + start[1] * direction[1])
    half_b += bulge * start[2] * direction[2] - direction[2]
    t0 = type(rho2_limit)(-1.0)
    t1 = type(rho2_limit)(-1.0)
    if leaving:
        if a != zero:
            t1 = -(half_b + half_b) / a
    else:
        c = curvature * (start[0] * start[0] + start[1] * start[1])
        c += bulge * start[2] * start[2] - (start[2] + start[2])
        t0, t1 = quadratic_roots(a, half_b, c)
        t0 += shift
        t1 += shift
    if t0 >= zero and t0 < type(rho2_limit)(wp.inf):
        if on_cap(origin + direction * t0, curvature, one_plus_conic, rho2_limit):
            return t0
    if t1 >= zero and t1 < type(rho2_limit)(wp.inf):
        if not leaving or t1 > zero:
            if on_cap(origin + direction * t1, curvature, one_plus_conic, rho2_limit):
                return t1
    return type(rho2_limit)(-1.0)


@wp.func
def intersect_rim(
    origin: Any, direction: Any, radius: Any, z_low: Any, z_high: Any, leaving: bool
):
    """Distance to the cylinder of `radius` about z between two heights, or −1."""
    zero = type(radius)(0.0)
    a = direction[0] * direction[0] + direction[1] * direction[1]
    half_b = origin[0] * direction[0] + origin[1] * direction[1]
    t0 = type(radius)(-1.0)
    t1 = type(radius)(-1.0)
    if a > zero:
        shift = -half_b / a
        if leaving:
            t1 = shift + shift
        else:
            # From its closest approach to the axis, as with spheres, the chord keeps its digits.
            x = origin[0] + direction[0] * shift
            y = origin[1] + direction[1] * shift
            room = radius * radius - x * x - y * y
            if room >= zero:
                half_chord = wp.sqrt(room / a)
                t0 = shift - half_chord
                t1 = shift + half_chord
    z0 = origin[2] + direction[2] * t0
    if t0 >= zero and t0 < type(radius)(wp.inf) and z0 >= z_low and z0 <= z_high:
        return t0
    z1 = origin[2] + direction[2] * t1
    if t1 >= zero and t1 < type(radius)(wp.inf) and z1 >= z_low and z1 <= z_high:
        if not leaving or t1 > zero:
            return t1
    return type(radius)(-1.0)


@wp.func
def exit_cap(
    origin: Any, direction: Any, curvature: Any, one_plus_conic: Any, outward: Any, leaving: bool
):
    """Distance at which a ray inside the glass goes out through a cap, or −1.

    `outward` is 1 where the outside is F > 0 (a front cap), −1 where it is F < 0. Going out, a
    ray passes the root at which `outward` · F rises. `leaving`: it starts on this cap.
    """
    zero = type(curvature)(0.0)
    none = type(curvature)(-1.0)
    shift = -wp.dot(origin, direction)
    if leaving:
        shift = zero
    start = origin + direction * shift
    c = curvature * outward
    bulge = one_plus_conic * c
    a = c * (direction[0] * direction[0] + direction[1] * direction[1])
    a += bulge * direction[2] * direction[2]
    half_b = c * (start[0] * direction[0] + start[1] * direction[1])
    half_b += bulge * start[2] * direction[2] - outward * direction[2]
    t = none
    if leaving:
        if a > zero:
            t = -(half_b + half_b) / a
    else:
        f = c * (start[0] * start[0] + start[1] * start[1])
        f += bulge * start[2] * start[2] - outward * (start[2] + start[2])
        discriminant = half_b * half_b - a * f
        if a > zero:
            discriminant = wp.max(discriminant, zero)  # by rounding alone: it is inside
        if discriminant < zero:
            return none
        root = wp.sqrt(discriminant)
        if half_b > zero:
            t = shift - f / (half_b + root)
        elif a != zero:
            t = shift + (root - half_b) / a
        # A start on the edge of another face can lie outside by rounding: it is out already.
        is_rising = half_b > a * shift
        if t < zero and is_rising and on_sheet(origin[2], curvature, one_plus_conic):
            return zero
    if t < zero or not on_sheet(origin[2] + direction[2] * t, curvature, one_plus_conic):
        return none
    return t


@wp.func
def exit_rim(origin: Any, direction: Any, radius: Any, leaving: bool):
    """Distance at which a ray inside the cylinder of `radius` about z goes out, or −1."""
    zero = type(radius)(0.0)
    a = direction[0] * direction[0] + direction[1] * direction[1]
    if a == zero:
        return type(radius)(-1.0)
    shift = -(origin[0] * direction[0] + origin[1] * direction[1]) / a
    if leaving:
        return shift + shift
    x = origin[0] + direction[0] * shift
    y = origin[1] + direction[1] * shift
    room = wp.max(radius * radius - x * x - y * y, zero)
    return wp.max(shift + wp.sqrt(room / a), zero)


@wp.func
def cap_normal(point: Any, curvature: Any, one_plus_conic: Any):
    """Unit normal of a cap at a point relative to its vertex, toward −z at the vertex."""
    gradient = type(point)(
        curvature * point[0],
        curvature * point[1],
        one_plus_conic * curvature * point[2] - type(curvature)(1.0),
    )
    return wp.normalize(gradient)


@wp.func
def lens_normal(lens: Any, face: int, point: Any):
    """Outward normal, of any length, at a point of a face; both in the lens's frame."""
    half = type(point)(type(lens.radius)(0.0), type(lens.radius)(0.0), lens.half_thickness)
    if face == FRONT_FACE:
        return cap_normal(point + half, lens.curvature_front, lens.one_plus_conic_front)
    if face == BACK_FACE:
        return -cap_normal(point - half, lens.curvature_back, lens.one_plus_conic_back)
    return type(point)(point[0], point[1], type(lens.radius)(0.0))


@wp.func
def lens_distances(lens: Any, origin: Any, direction: Any, leaving_face: int):
    """Distances to the front, the back and the rim, −1 for none."""
    zero = type(lens.radius)(0.0)
    one = type(lens.radius)(1.0)
    half = type(origin)(zero, zero, lens.half_thickness)
    leaves_front = leaving_face == FRONT_FACE
    leaves_back = leaving_face == BACK_FACE
    leaves_rim = leaving_face == RIM_FACE
    front = origin + half
    back = origin - half
    if leaving_face >= 0:
        if wp.dot(lens_normal(lens, leaving_face, origin), direction) < zero:
            return (
                exit_cap(
                    front, direction, lens.curvature_front, lens.one_plus_conic_front, one,
                    leaves_front,
                ),
                exit_cap(
                    back, direction, lens.curvature_back, lens.one_plus_conic_back, -one,
                    leaves_back,
                ),
                exit_rim(origin, direction, lens.radius, leaves_rim),
            )
    return (
        intersect_cap(
            front, direction, lens.curvature_front, lens.one_plus_conic_front, lens.rho2_limit,
            leaves_front,
        ),
        intersect_cap(
            back, direction, lens.curvature_back, lens.one_plus_conic_back, lens.rho2_limit,
            leaves_back,
        ),
        intersect_rim(origin, direction, lens.radius, lens.rim_low, lens.rim_high, leaves_rim),
    )


@wp.func
def intersect_lens(lens: Any, origin: Any, direction: Any, leaving_face: int):
    """Distance (−1 for none) and face of the first hit.

    Args:
        lens: struct with the lens's shape.
        origin: in the lens's frame [m].
        direction: unit, in the lens's frame.
        leaving_face: the face the ray has just left, −1 for none.
    """
    zero = type(lens.radius)(0.0)
    t, t_back, t_rim = lens_distances(lens, origin, direction, leaving_face)
    face = int(FRONT_FACE)
    if t_back >= zero and (t < zero or t_back < t):
        t = t_back
        face = BACK_FACE
    if t_rim >= zero and (t < zero or t_rim < t):
        t = t_rim
        face = RIM_FACE
    return t, face
