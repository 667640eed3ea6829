"""Points on disks and directions in cones and hemispheres, from uniform numbers in [0, 1)².

All maps are continuous where their domain allows it, so that low-discrepancy points stay so.

References:
    Shirley & Chiu (1997), "A low distortion map between disk and square", JGT 2(3), 45.
    Malley's method: Pharr, Jakob & Humphreys (2023), *Physically Based Rendering*, §A.5.3.
"""

from typing import Any

import warp as wp

__all__ = [
    "cone_solid_angle",
    "cone_square",
    "disk_square",
    "frame_of",
    "from_world",
    "sample_cone",
    "sample_cosine_hemisphere",
    "sample_disk",
    "sample_sphere",
    "to_world",
]


@wp.func
def sample_disk(u0: Any, u1: Any):
    """A uniform point (x, y) of the unit disk (Shirley & Chiu 1997)."""
    zero = type(u0)(0.0)
    a = u0 + u0 - type(u0)(1.0)
    b = u1 + u1 - type(u0)(1.0)
    if a == zero and b == zero:
        return zero, zero
    quarter_pi = type(u0)(0.7853981633974483)
    if wp.abs(a) > wp.abs(b):
        angle = quarter_pi * (b / a)
        return a * wp.cos(angle), a * wp.sin(angle)
    angle = quarter_pi * (a / b)
    return b * wp.sin(angle), b * wp.cos(angle)


@wp.func
def disk_square(x: Any, y: Any):
    """The numbers (u0, u1) that `sample_disk` turns into (x, y)."""
    half = type(x)(0.5)
    r = wp.sqrt(x * x + y * y)
    if r == type(x)(0.0):
        return half, half
    four_over_pi = type(x)(1.2732395447351628)
    a = r
    b = r
    if wp.abs(x) > wp.abs(y):
        a = wp.where(x < type(x)(0.0), -r, r)
        b = a * four_over_pi * wp.atan(y / x)
    else:
        b = wp.where(y < type(x)(0.0), -r, r)
        a = b * four_over_pi * wp.atan(x / y)
    return half + half * a, half + half * b


@wp.func
def sample_cone(u0: Any, u1: Any, sin2_half: Any):
    """Local direction (x, y, z) uniform in solid angle in a cone about z.

    `sin2_half` = sin²(θ_max/2). With s = 1 − cosθ = 2 u sin²(θ_max/2), sinθ = √(s (2 − s))
    keeps its digits in cones of an arc-second, where 1 − u (1 − cosθ_max) has none left.
    """
    x, y = sample_disk(u0, u1)
    # r² of a uniform disk point is uniform: it serves as u, and (x, y)/r as the azimuth.
    r2 = x * x + y * y
    s = (r2 + r2) * sin2_half
    scale = wp.sqrt((sin2_half + sin2_half) * wp.max(type(u0)(2.0) - s, type(u0)(0.0)))
    return x * scale, y * scale, type(u0)(1.0) - s


@wp.func
def cone_square(x: Any, y: Any, z: Any, sin2_half: Any):
    """The numbers (u0, u1) that `sample_cone` turns into the unit vector (x, y, z)."""
    smallest = type(x)(1e-30)
    scale2 = (sin2_half + sin2_half) * (type(x)(1.0) + z)
    scale = type(x)(1.0) / wp.sqrt(wp.max(scale2, smallest))
    return disk_square(x * scale, y * scale)


@wp.func
def sample_sphere(u0: Any, u1: Any):
    """Local direction (x, y, z) uniform over the whole sphere (Archimedes)."""
    z = type(u0)(1.0) - u0 - u0
    rho = wp.sqrt(wp.max((type(u0)(1.0) - z) * (type(u0)(1.0) + z), type(u0)(0.0)))
    phi = type(u0)(6.283185307179586) * u1
    return rho * wp.cos(phi), rho * wp.sin(phi), z


@wp.func
def sample_cosine_hemisphere(u0: Any, u1: Any):
    """Local direction (x, y, z) with density cosθ/π about z (Malley)."""
    x, y = sample_disk(u0, u1)
    return x, y, wp.sqrt(wp.max(type(u0)(1.0) - x * x - y * y, type(u0)(0.0)))


@wp.func
def cone_solid_angle(sin2_half: Any):
    """Solid angle of a cone, 2π (1 − cosθ) = 4π sin²(θ/2) [sr]."""
    return type(sin2_half)(12.566370614359172) * sin2_half


@wp.func
def frame_of(axis: Any):
    """Unit vectors u and v of a right-handed frame (u, v, axis) (Duff et al. 2017, JCGT 6(1))."""
    one = type(axis[0])(1.0)
    sign = one
    if axis[2] < type(axis[0])(0.0):
        sign = -one
    a = -one / (sign + axis[2])
    b = axis[0] * axis[1] * a
    u = type(axis)(one + sign * axis[0] * axis[0] * a, sign * b, -sign * axis[0])
    v = type(axis)(b, sign + axis[1] * axis[1] * a, -axis[1])
    return u, v


@wp.func
def to_world(x: Any, y: Any, z: Any, axis: Any):
    """The vector x u + y v + z axis in the frame about `axis`."""
    u, v = frame_of(axis)
    world = u * x + v * y + axis * z
    # Of unit length but for rounding, which one Newton step of 1/|d| takes away.
    return world * (type(x)(1.5) - type(x)(0.5) * wp.dot(world, world))


@wp.func
def from_world(direction: Any, axis: Any):
    """The (x, y, z) that `to_world` turns into `direction`."""
    u, v = frame_of(axis)
    return wp.dot(direction, u), wp.dot(direction, v), wp.dot(direction, axis)
