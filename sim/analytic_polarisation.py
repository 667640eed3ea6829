"""Closed forms of polarised light in float64: Fresnel's amplitudes and Mueller matrices.

Everything broadcasts over arrays. A Stokes vector (I, Q, U, V) is told in a frame across the
ray: its first axis s, its second p = d × s with d where the light goes, so that (s, p, d) is
right-handed; at a surface s is perpendicular to the plane of incidence. Q is what vibrates along s
less what does along p, U the same for the diagonals (s + p)/√2 and (s - p)/√2, and V is what is
right-handed, clockwise for one whom the light comes towards, less what is left-handed (Born & Wolf
1999, §1.4.2). Amplitudes have the time dependence exp(-iωt): an index n + ik absorbs.

Mueller matrices have the shape (..., 4, 4). Those of a surface are told in its plane of incidence,
before and after: p turns with the ray.

References:
    Born, M. and Wolf, E. (1999), Principles of Optics, 7th edition, Cambridge University Press:
    §1.4.2 Stokes parameters, §1.5.2 Fresnel's formulae, §1.5.4 total reflection, §14.2 metals.
    Chipman, R. A., Lam, W.-S. T. and Young, G. (2018), Polarized Light and Optical Systems, CRC
    Press: §6 Mueller matrices of polarisers, rotations, Fresnel's surfaces.
    Stokes, G. G. (1862), "On the intensity of the light reflected from or transmitted through a
    pile of plates", Proc. R. Soc. Lond. 11, 545.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.analytic import fresnel_reflectance
from spectra.arrays import FloatArray

__all__ = [
    "BoundaryMatrices",
    "boundary_matrices",
    "degree_of_polarisation",
    "fresnel_amplitudes",
    "plate_stack_transmittance",
    "polariser_matrix",
    "retarding_incidences",
    "rotation_matrix",
    "total_reflection_retardance",
]

ComplexArray = NDArray[np.complex128]


class BoundaryMatrices(NamedTuple):
    """Mueller matrices of a boundary for the flux it reflects and the flux it lets through."""

    reflection: FloatArray  # (..., 4, 4)
    transmission: FloatArray  # (..., 4, 4); into an absorbing medium: just behind the boundary.


def fresnel_amplitudes(
    cos_theta_i: ArrayLike, eta_i: ArrayLike, eta_t: ArrayLike
) -> tuple[ComplexArray, ComplexArray]:
    """Amplitudes reflected, r_s and r_p (Born & Wolf 1999, §1.5.2, eq. 21; §1.5.4; §14.2).

    With η = η_t/η_i, c = cosθ_i, s = sinθ_i and g = η cosθ_t = √(η² - s²),

        r_s = (c - g)/(c + g) = (1 - η²)/(c + g)²
        r_p = (η² c - g)/(η² c + g) = (η² - 1)(η² c² - s²)/(η² c + g)²

    whose second forms keep their digits where the indices are close. The same formulas hold where
    the reflection is total, g = i√(s² - η²), and for metals, η = n + ik.

    Args:
        cos_theta_i: Cosine of the angle of incidence, 0 to 1.
        eta_i: Index before the boundary, real.
        eta_t: Index behind it, real or complex with k ≥ 0.
    """
    cos_i = np.asarray(cos_theta_i, dtype=np.float64)
    eta, g = _relative_index_and_g(cos_i, eta_i, eta_t)
    contrast = (eta - 1.0) * (eta + 1.0)
    sum_s, sum_p = cos_i + g, eta * eta * cos_i + g
    equal = contrast == 0.0
    sum_s, sum_p = np.where(equal, 1.0, sum_s), np.where(equal, 1.0, sum_p)
    r_s: ComplexArray = -contrast / sum_s**2
    r_p: ComplexArray = contrast * ((eta * cos_i) ** 2 - (1.0 - cos_i) * (1.0 + cos_i)) / sum_p**2
    return r_s[()], r_p[()]


def boundary_matrices(
    cos_theta_i: ArrayLike, eta_i: ArrayLike, eta_t: ArrayLike
) -> BoundaryMatrices:
    """Mueller matrices of a boundary, in its plane of incidence (Chipman et al. 2018, §6).

    Of amplitudes r_s and r_p, ½(|r_s|² + |r_p|²) is on the diagonal of (I, Q), ½(|r_s|² - |r_p|²)
    off it, and r_s r_p* = C + iS turns (U, V) into (C U - S V, S U + C V). Transmitted amplitudes
    t_s = 2c/(c + g) and t_p = 2ηc/(η² c + g) count with the flux's factor Re(g)/c.
    """
    cos_i = np.asarray(cos_theta_i, dtype=np.float64)
    r_s, r_p = fresnel_amplitudes(cos_i, eta_i, eta_t)
    eta, g = _relative_index_and_g(cos_i, eta_i, eta_t)
    # √(4 c Re g) is the factor's root times 2c; equal media let grazing light pass, 0/0 as it is.
    passes = (eta == 1.0) & (g.real == 0.0)
    root = np.sqrt(4.0 * cos_i * g.real)
    sum_s, sum_p = np.where(passes, 1.0, cos_i + g), np.where(passes, 1.0, eta**2 * cos_i + g)
    t_s, t_p = np.where(passes, 1.0, root / sum_s), np.where(passes, 1.0, eta * root / sum_p)
    return BoundaryMatrices(_amplitude_matrix(r_s, r_p), _amplitude_matrix(t_s, t_p))


def _relative_index_and_g(
    cos_i: FloatArray, eta_i: ArrayLike, eta_t: ArrayLike
) -> tuple[ComplexArray, ComplexArray]:
    """η_t/η_i, and g = η cosθ_t with an imaginary part of 0 or more."""
    eta = np.asarray(eta_t, dtype=np.complex128) / np.asarray(eta_i, dtype=np.float64)
    g2 = cos_i * cos_i + (eta - 1.0) * (eta + 1.0)
    g = np.sqrt(g2.real + 1j * np.abs(g2.imag))  # never -0i, whose root is on the other side
    return eta, g


def _amplitude_matrix(of_s: ArrayLike, of_p: ArrayLike) -> FloatArray:
    """The Mueller matrix of complex amplitudes along s and p."""
    a_s, a_p = np.asarray(of_s, dtype=np.complex128), np.asarray(of_p, dtype=np.complex128)
    flux_s, flux_p, mixed = np.abs(a_s) ** 2, np.abs(a_p) ** 2, a_s * np.conj(a_p)
    matrix = np.zeros((*np.broadcast(a_s, a_p).shape, 4, 4))
    matrix[..., 0, 0] = matrix[..., 1, 1] = 0.5 * (flux_s + flux_p)
    matrix[..., 0, 1] = matrix[..., 1, 0] = 0.5 * (flux_s - flux_p)
    matrix[..., 2, 2] = matrix[..., 3, 3] = mixed.real
    matrix[..., 2, 3], matrix[..., 3, 2] = -mixed.imag, mixed.imag
    return matrix


def rotation_matrix(angle: ArrayLike) -> FloatArray:
    """What a Stokes vector becomes in a frame turned by `angle` [rad] from s towards p."""
    cosine, sine = np.cos(2.0 * np.asarray(angle)), np.sin(2.0 * np.asarray(angle))
    matrix = np.zeros((*np.shape(cosine), 4, 4))
    matrix[..., 0, 0] = matrix[..., 3, 3] = 1.0
    matrix[..., 1, 1] = matrix[..., 2, 2] = cosine
    matrix[..., 1, 2], matrix[..., 2, 1] = sine, -sine
    return matrix


def polariser_matrix(angle: ArrayLike) -> FloatArray:
    """An ideal linear polariser that passes what vibrates at `angle` [rad] from s towards p.

    The outer product ½ w wᵀ of w = (1, cos 2α, sin 2α, 0), the light that passes whole.
    """
    doubled = 2.0 * np.asarray(angle, dtype=np.float64)
    one = np.ones_like(doubled)
    passed = np.stack([one, np.cos(doubled), np.sin(doubled), 0.0 * one], axis=-1)
    matrix: FloatArray = 0.5 * passed[..., :, None] * passed[..., None, :]
    return matrix


def degree_of_polarisation(stokes: ArrayLike) -> FloatArray:
    """√(Q² + U² + V²)/I of Stokes vectors (..., 4), shape (...) (Born & Wolf 1999, §10.9.3)."""
    vectors = np.asarray(stokes, dtype=np.float64)
    degree: FloatArray = np.linalg.norm(vectors[..., 1:], axis=-1) / vectors[..., 0]
    return degree


def total_reflection_retardance(
    theta_i: ArrayLike, eta_i: ArrayLike, eta_t: ArrayLike
) -> FloatArray:
    """Phase δ of s over p that total reflection adds [rad] (Born & Wolf 1999, §1.5.4, eq. 61).

    tan(δ/2) = cosθ_i √(sin²θ_i - n²)/sin²θ_i, n = η_t/η_i; NaN where the reflection is not total.
    """
    theta, n = np.asarray(theta_i, dtype=np.float64), np.asarray(eta_t) / np.asarray(eta_i)
    sine = np.sin(theta)
    beyond = (sine - n) * (sine + n)
    half = np.cos(theta) * np.sqrt(np.where(beyond >= 0.0, beyond, np.nan)) / sine**2
    retardance: FloatArray = 2.0 * np.arctan(half)
    return retardance


def retarding_incidences(retardance: ArrayLike, eta: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """The two angles of incidence at which total reflection retards by `retardance` [rad].

    With T = tan(δ/2), n = 1/η and x = sin²θ, eq. (61) of Born & Wolf 1999, §1.5.4, is
    (1 + T²) x² - (1 + n²) x + n² = 0. A Fresnel rhomb reflects twice at one of those for 45°.

    Args:
        retardance: wanted of one reflection, 0 to its maximum, tan(δ/2) = (1 - n²)/(2n).
        eta: Index of the glass over that of what surrounds it.

    Returns:
        The lesser and the greater angle [rad]; NaN where no angle retards as much.
    """
    n2 = 1.0 / np.asarray(eta, dtype=np.float64) ** 2
    scale = 1.0 / np.cos(0.5 * np.asarray(retardance, dtype=np.float64)) ** 2  # 1 + T²
    discriminant = (1.0 + n2) ** 2 - 4.0 * n2 * scale
    root = np.sqrt(np.where(discriminant >= 0.0, discriminant, np.nan))
    sum_of_roots = 1.0 + n2
    lesser, greater = (0.5 * (sum_of_roots + sign * root) / scale for sign in (-1.0, 1.0))
    return np.arcsin(np.sqrt(lesser)), np.arcsin(np.sqrt(greater))


def plate_stack_transmittance(
    theta_i: ArrayLike, eta: ArrayLike, plates: int
) -> tuple[FloatArray, FloatArray]:
    """Transmittance for s and p of parallel plates, all reflections between them summed.

    2m surfaces of reflectance r in turn send on T = (1 - r)/(1 + (2m - 1) r) (Stokes 1862).

    Args:
        theta_i: angle of incidence [rad], 0 to less than π/2.
        eta: Index of the plates over that of what surrounds them.
        plates: How many, m.
    """
    faces = fresnel_reflectance(np.cos(np.asarray(theta_i, dtype=np.float64)), 1.0, eta)
    of_s, of_p = ((1.0 - r) / (1.0 + (2 * plates - 1) * r) for r in faces)
    return of_s, of_p
