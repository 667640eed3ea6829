"""Fresnel's equations at the surface of a metal.

References:
    Born & Wolf (1999), *Principles of Optics*, 7th ed., §14.2 eq. (1) to (12): a metal refracts
    by a complex index n + ik.
    Liddell (1981), *Computer-Aided Techniques for the Design of Multilayer Filters*, §1.4: the
    reflectances in real arithmetic.
"""

from typing import Any

import warp as wp

__all__ = ["conductor_reflectance"]


@wp.func
def conductor_reflectance(cos_theta_i: Any, n: Any, k: Any):
    """Reflectance (R_s, R_p) of a metal of index n + ik, relative to the medium in front of it.

    With a² and b² the real and imaginary part of √((n + ik)² − sin²θ) =: a + ib,

        R_s = (a² + b² − 2 a c + c²)/(a² + b² + 2 a c + c²),    c = cosθ,
        R_p = R_s (c²(a² + b²) − 2 a c s² + s⁴)/(c²(a² + b²) + 2 a c s² + s⁴),    s = sinθ.
    """
    one = type(n)(1.0)
    zero = type(n)(0.0)
    c2 = cos_theta_i * cos_theta_i
    s2 = (one - cos_theta_i) * (one + cos_theta_i)
    real_part = (n - k) * (n + k) - s2
    twice = n * k + n * k
    modulus = wp.sqrt(real_part * real_part + twice * twice)
    a = wp.sqrt(wp.max(type(n)(0.5) * (modulus + real_part), zero))
    across = (a + a) * cos_theta_i
    r_s = (modulus + c2 - across) / (modulus + c2 + across)
    r_p = one
    beside = c2 * modulus + s2 * s2
    if beside + across * s2 > zero:
        r_p = r_s * (beside - across * s2) / (beside + across * s2)
    return r_s, r_p
