"""Closed form of a metal's reflectance in float64: the reference for polished metals.

Reference:
    Born, M. and Wolf, E. (1999), Principles of Optics, 7th edition, Cambridge University Press,
    §14.2: reflection and refraction at a metal surface.
"""

import numpy as np
from numpy.typing import ArrayLike

from spectra.arrays import FloatArray

__all__ = ["conductor_reflectance"]


def conductor_reflectance(
    cos_theta_i: ArrayLike, eta_i: ArrayLike, eta_t: ArrayLike, k_t: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Reflectance of a metal's surface, without complex numbers (Born & Wolf 1999, §14.2).

    With c = cos θ_i, s = sin θ_i, the index η + ik = (η_t + ik_t)/η_i and the real and imaginary
    parts of √((η + ik)² - s²) = a + ib, the amplitudes r_s = (c - a - ib)/(c + a + ib) and r_p have

        a² + b² = √((η² - k² - s²)² + 4 η² k²),  2a² = a² + b² + (η² - k² - s²)
        Rs = (a² + b² - 2ac + c²) / (a² + b² + 2ac + c²)
        Rp = Rs ((a² + b²) c² - 2ac s² + s⁴) / ((a² + b²) c² + 2ac s² + s⁴)

    With k = 0 they are Fresnel's of a dielectric, total reflection included.

    Args:
        cos_theta_i: Cosine of the angle of incidence, 0 to 1.
        eta_i: Index before the surface, real.
        eta_t: Real part of the metal's index, above 0.
        k_t: Imaginary part of it, the extinction coefficient, 0 or more.

    Returns:
        Rs and Rp: both 1 at grazing incidence, equal at normal incidence.
    """
    cos_i, index_i = np.asarray(cos_theta_i, np.float64), np.asarray(eta_i, np.float64)
    eta, k = np.asarray(eta_t, np.float64) / index_i, np.asarray(k_t, np.float64) / index_i
    cos2, sin2 = cos_i * cos_i, (1.0 - cos_i) * (1.0 + cos_i)
    real, imaginary = (eta - k) * (eta + k) - sin2, 2.0 * eta * k
    modulus = np.hypot(real, imaginary)
    # The larger of a and b has no cancellation, and ab = ηk gives the other.
    larger = np.sqrt(0.5 * (modulus + np.abs(real)))
    ac = cos_i * np.where(real >= 0.0, larger, 0.5 * imaginary / larger)
    r_s = (modulus - 2.0 * ac + cos2) / (modulus + 2.0 * ac + cos2)
    with_s2, with_c2 = sin2 * sin2, modulus * cos2
    room = with_c2 + 2.0 * ac * sin2 + with_s2
    r_p = r_s * ((with_c2 - 2.0 * ac * sin2 + with_s2) / room)
    return r_s[()], r_p[()]
