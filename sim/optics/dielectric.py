"""Snell's law and Fresnel's equations at a smooth boundary between two lossless media.

Directions point where light goes; `normal` points to the side the light comes from, so
`cos_theta_i = -dot(direction, normal)` is positive. Relative index: `eta = eta_i / eta_t`.

References:
    Born & Wolf (1999), *Principles of Optics*, 7th ed., §1.5.2 eq. (8) Snell, (21) Fresnel.
    Heckbert (1989), "Writing a ray tracer", in *An Introduction to Ray Tracing*: vector form.
    Schlick (1994), "An inexpensive BRDF model for physically-based rendering", Comput. Graph.
    Forum 13(3), eq. (15).
"""

from typing import Any

import warp as wp

__all__ = [
    "cos2_theta_t",
    "fresnel_reflectance",
    "reflect",
    "refract",
    "renormalize",
    "schlick_reflectance",
]


@wp.func
def cos2_theta_t(cos_theta_i: Any, eta: Any):
    """Squared cosine of the transmitted angle, 1 − η² sin²θᵢ; ≤ 0 reflects totally.

    Towards grazing it is (1 − η)(1 + η) + η² cos²θᵢ, which keeps the digits of small cosines where
    the indices nearly agree. Else (1 − c)(1 + c) keeps those that 1 − c² loses.
    """
    one = type(eta)(1.0)
    from_i = eta * cos_theta_i
    square = (one - eta) * (one + eta) + from_i * from_i
    if cos_theta_i * cos_theta_i > type(eta)(0.5):
        square = one - eta * eta * (one - cos_theta_i) * (one + cos_theta_i)
    return square


@wp.func
def fresnel_reflectance(cos_theta_i: Any, cos_theta_t: Any, eta: Any):
    """Reflectance (R_s, R_p) for s and p light (Born & Wolf 1999, §1.5.2 eq. 21, squared).

    Equal media reflect nothing at any angle, and grazing light is reflected whole; both are the
    limits of a 0/0 and so come first.
    """
    zero = type(eta)(0.0)
    one = type(eta)(1.0)
    if eta == one:
        return zero, zero
    if cos_theta_i <= zero:
        return one, one
    r_s = (eta * cos_theta_i - cos_theta_t) / (eta * cos_theta_i + cos_theta_t)
    r_p = (cos_theta_i - eta * cos_theta_t) / (cos_theta_i + eta * cos_theta_t)
    return r_s * r_s, r_p * r_p


@wp.func
def schlick_reflectance(cos_theta_i: Any, cos_theta_t: Any, eta: Any):
    """Reflectance R₀ + (1 − R₀)(1 − cosθ)⁵ of light without polarisation (Schlick 1994, eq. 15).

    θ is the angle on the side of the lower index, where grazing light is reflected whole; from
    within the denser medium that is the transmitted angle, so that R is the same both ways.
    """
    one = type(eta)(1.0)
    r = (eta - one) / (eta + one)
    r_0 = r * r
    x = one - cos_theta_i
    if eta > one:
        x = one - cos_theta_t
    x2 = x * x
    return r_0 + (one - r_0) * x2 * x2 * x


@wp.func
def renormalize(direction: Any):
    """A nearly unit vector brought back to length 1: one Newton step of 1/|d|, no square root.

    An error ε of the length becomes 3ε²/2, so rounding never accumulates along a path.
    """
    half = type(direction[0])(0.5)
    return direction * (type(direction[0])(1.5) - half * wp.dot(direction, direction))


@wp.func
def reflect(direction: Any, normal: Any, cos_theta_i: Any):
    """Mirror direction, unit: d + 2 cosθᵢ n."""
    return renormalize(direction + normal * (cos_theta_i + cos_theta_i))


@wp.func
def refract(direction: Any, normal: Any, cos_theta_i: Any, cos_theta_t: Any, eta: Any):
    """Transmitted direction, unit: η d + (η cosθᵢ − cosθₜ) n (Heckbert 1989, §5)."""
    return renormalize(direction * eta + normal * (eta * cos_theta_i - cos_theta_t))
