"""Polarised light at surfaces: Stokes vectors, the frame they are told in, and Mueller matrices.

Light is (q, u, v), its Stokes vector over its flux, in the frame of a unit vector s across the
ray and p = d × s, d the direction: (s, p, d) is right-handed. q is the share that vibrates along s
less the one along p, u the same for (s ± p)/√2, v right-handed less left-handed (Born & Wolf 1999,
§1.4.2). At a surface the frame is first turned about the ray until s is perpendicular to the plane
of incidence; s then stays where it is, and p turns with the ray. There the surface's matrix is

    ( mean  half   .     .  )
    ( half  mean   .     .  )     mean ± half the reflectance (or transmittance) of s and p,
    (  .     .   cosine -sine )   cosine + i sine = r_s r_p*, with amplitudes of exp(-iωt).
    (  .     .   sine  cosine )

A camera path carries the row of sensitivities to (1, q, u, v) instead, from the eye on: in the same
frame about its own direction, against the light, u and v change their signs, and the transposed
matrix is the same but for the sign of `sine`.

References:
    Born & Wolf (1999), *Principles of Optics*, 7th ed., §1.4.2 Stokes parameters, §1.5.2 eq. (21)
    Fresnel's amplitudes, §1.5.4 eq. (61) total reflection, §14.2 metals.
    Chipman, Lam & Young (2018), *Polarized Light and Optical Systems*, §6: Mueller matrices.
    Korger et al. (2013), "The polarization properties of a tilted polarizer", Opt. Express 21,
    27032: what a polariser blocks is its absorbing axis as seen along the ray.
"""

from typing import Any

import warp as wp

__all__ = [
    "apply_surface",
    "conductor_matrix",
    "frame_across",
    "fresnel_amplitudes",
    "seen_part",
    "share_of_flux",
    "total_reflection_phase",
    "turn_frame",
]


@wp.func
def fresnel_amplitudes(cos_theta_i: Any, cos_theta_t: Any, eta: Any):
    """Amplitudes r_s, r_p reflected, and √(T_s T_p) (Born & Wolf 1999, §1.5.2 eq. 20, 21).

    η = η_i/η_t. Equal media reflect nothing at any angle, and grazing light is reflected whole; the
    transmitted amplitudes are in phase, so that √(T_s T_p) is all of r_s r_p* that they have.
    """
    zero = type(eta)(0.0)
    one = type(eta)(1.0)
    if eta == one:
        return zero, zero, one
    if cos_theta_i <= zero:
        return -one, -one, zero
    from_i = eta * cos_theta_i
    from_t = eta * cos_theta_t
    over_s = one / (from_i + cos_theta_t)
    over_p = one / (cos_theta_i + from_t)
    r_s = (from_i - cos_theta_t) * over_s
    r_p = (cos_theta_i - from_t) * over_p
    return r_s, r_p, type(eta)(4.0) * from_i * cos_theta_t * over_s * over_p


@wp.func
def total_reflection_phase(cos_theta_i: Any, cos2_theta_t: Any, eta: Any):
    """Cosine and sine of the phase δ of s over p that total reflection adds, cos²θₜ ≤ 0.

    tan(δ/2) = cosθᵢ √(sin²θᵢ − 1/η²)/sin²θᵢ, η = η_i/η_t (Born & Wolf 1999, §1.5.4 eq. 61).
    """
    one = type(eta)(1.0)
    sin2_theta_i = (one - cos_theta_i) * (one + cos_theta_i)
    tangent = cos_theta_i * wp.sqrt(-cos2_theta_t) / (eta * sin2_theta_i)
    scale = one / (one + tangent * tangent)
    return (one - tangent * tangent) * scale, (tangent + tangent) * scale


@wp.func
def conductor_matrix(cos_theta_i: Any, eta: Any, k: Any):
    """Mean, half difference, cosine and sine of a metal's reflection (Born & Wolf 1999, §14.2).

    With c, s of the angle of incidence and g = a + ib = √((η + ik)² − s²):
    r_s = (c − g)/(c + g) and r_p/r_s = (s² − c g)/(s² + c g).

    Args:
        cos_theta_i: 0 to 1.
        eta: real part of the metal's index over that of the medium before it (η_t/η_i).
        k: its imaginary part, absorbing where positive, over the same.
    """
    one = type(eta)(1.0)
    half = type(eta)(0.5)
    c2 = cos_theta_i * cos_theta_i
    s2 = (one - cos_theta_i) * (one + cos_theta_i)
    real_part = (eta - k) * (eta + k) - s2
    modulus = wp.sqrt(real_part * real_part + type(eta)(4.0) * eta * eta * k * k)  # a² + b²
    a = wp.sqrt(wp.max(half * (modulus + real_part), type(eta)(0.0)))
    b = wp.sqrt(wp.max(half * (modulus - real_part), type(eta)(0.0)))
    r_s2 = (c2 + modulus - (a + a) * cos_theta_i) / (c2 + modulus + (a + a) * cos_theta_i)
    # |s² ∓ c g|² = s⁴ + c² |g|² ∓ 2 s² c a.
    squares = s2 * s2 + c2 * modulus
    mixed = (s2 + s2) * cos_theta_i
    over = r_s2 / (squares + mixed * a)
    r_p2 = (squares - mixed * a) * over
    return (
        half * (r_s2 + r_p2), half * (r_s2 - r_p2), (s2 * s2 - c2 * modulus) * over,
        mixed * b * over,
    )  # fmt: skip


@wp.func
def frame_across(direction: Any, up: Any):
    """The unit vector across the ray that is nearest to `up`; any, where that is along the ray."""
    across = up - direction * wp.dot(direction, up)
    length2 = wp.dot(across, across)
    zero = type(length2)(0.0)
    if length2 <= type(length2)(1e-6):
        # x, or y where the ray is within 53° of x: either is then at least 36° away.
        x = type(length2)(1.0)
        y = zero
        if wp.abs(direction[0]) > type(length2)(0.6):
            x = zero
            y = type(length2)(1.0)
        across = type(direction)(x, y, zero)
        across -= direction * wp.dot(direction, across)
        length2 = wp.dot(across, across)
    across *= type(length2)(1.0) / wp.sqrt(length2)
    # Twice, so that it is across to the last digit where `up` was nearly along the ray.
    across -= direction * wp.dot(direction, across)
    return wp.normalize(across)


@wp.func
def turn_frame(light: Any, s: Any, direction: Any, normal: Any):
    """(q, u, v) and s, the frame turned about the ray until s is perpendicular to `normal` too.

    Along the ray one sees the normal as a s + b p, and the new s is (−b s + a p)/√(a² + b²): that
    is perpendicular to the ray as exactly as the old one was, near normal incidence as well,
    where the plane of incidence itself is only known to ε/sinθ and hardly matters. At normal
    incidence it does not matter at all, and the frame stays.
    """
    p = wp.cross(direction, s)
    a = wp.dot(normal, s)
    b = wp.dot(normal, p)
    a2 = a * a
    b2 = b * b
    h2 = a2 + b2
    if h2 == type(a)(0.0):
        return light, s
    over = type(a)(1.0) / wp.sqrt(h2)
    # Of the angle φ between old and new s: cos φ = −b/h, sin φ = a/h.
    turned = s * (-b * over) + p * (a * over)
    cos_2phi = (b2 - a2) * over * over
    sin_2phi = -(a + a) * b * over * over
    q = light[0] * cos_2phi + light[1] * sin_2phi
    u = light[1] * cos_2phi - light[0] * sin_2phi
    # One Newton step of 1/|s|: rounding never adds up along a path.
    length2 = wp.dot(turned, turned)
    turned *= type(a)(1.5) - type(a)(0.5) * length2
    return type(light)(q, u, light[2]), turned


@wp.func
def seen_part(eye: Any, eye_s: Any, light: Any, light_s: Any, direction: Any):
    """1 + the product of sensitivity and Stokes vector: what an eye sees of light, over natural.

    Args:
        eye: what a camera path carries.
        eye_s: its frame.
        light: (q, u, v) of light that comes against the path.
        light_s: its frame.
        direction: of the path; the light goes the other way.
    """
    cosine = wp.dot(eye_s, light_s)
    sine = -wp.dot(eye_s, wp.cross(direction, light_s))  # along the light's own p = −d × s
    cos_2phi = cosine * cosine - sine * sine
    sin_2phi = (cosine + cosine) * sine
    q = light[0] * cos_2phi + light[1] * sin_2phi
    u = light[1] * cos_2phi - light[0] * sin_2phi
    # About its own direction, the path's u and v have the other sign.
    return type(cosine)(1.0) + eye[0] * q - eye[1] * u - eye[2] * light[2]


@wp.func
def share_of_flux(q: Any, mean: Any, half: Any):
    """The share of the flux that a surface sends this way, 0 to 1."""
    return wp.clamp(mean + half * q, type(mean)(0.0), type(mean)(1.0))


@wp.func
def apply_surface(light: Any, mean: Any, half: Any, cosine: Any, sine: Any):
    """(q, u, v) of the light that a surface sends on, by its matrix in the plane of incidence.

    Where it sends none (p light at Brewster's angle) the answer does not matter, and is 0.
    """
    share = mean + half * light[0]
    over = type(mean)(0.0)
    if share > type(mean)(0.0):
        over = type(mean)(1.0) / share
    return type(light)(
        (half + mean * light[0]) * over,
        (cosine * light[1] - sine * light[2]) * over,
        (sine * light[1] + cosine * light[2]) * over,
    )
