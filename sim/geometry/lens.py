"""Ray and lens: two conic caps and the cylinder between their edges, in the lens's own frame.

The axis is z and the frame's origin lies midway between the two vertices. A cap with vertex
curvature c and conic constant κ is the sheet through its vertex of
``F = c (x² + y² + (1 + κ) z²) − 2 z = 0``, which is a plane at c = 0: no special case.

Reference:
    Welford (1986), *Aberrations of Optical Systems*, §4.2: quadrics in vertex form.
    Press et al. (2007), *Numerical Recipes*, §5.6: roots of a quadratic without cancellation.
"""

from typing import Any

import warp as wp

__all__ = ["cap_normal", "intersect_cap", "intersect_rim"]


@wp.func
def quadratic_roots(a: Any, half_b: Any, c: Any):
    """Roots of a t² + 2 b t + c in ascending order; (inf, inf) for none, inf for one at infinity."""
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
def on_cap(point: Any, curvature: Any, one_plus_conic: Any, rho2_limit: Any):
    """Whether a point of the quadric lies on the sheet of its vertex and inside the aperture."""
    zero = type(rho2_limit)(0.0)
    rho2 = point[0] * point[0] + point[1] * point[1]
    above = type(rho2_limit)(1.0) - one_plus_conic * curvature * point[2]
    return rho2 <= rho2_limit and above >= zero


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
def cap_normal(point: Any, curvature: Any, one_plus_conic: Any):
    """Unit normal of a cap at a point relative to its vertex, toward −z at the vertex."""
    gradient = type(point)(
        curvature * point[0],
        curvature * point[1],
        one_plus_conic * curvature * point[2] - type(curvature)(1.0),
    )
    return wp.normalize(gradient)
