"""Closed forms of geometrical optics in float64: the reference the simulator is held against.

Everything broadcasts over arrays, and answers numbers with NumPy scalars. Throughout:

- Angles are in radians, lengths in any one unit, and so are the answers.
- ``eta_i`` and ``eta_t`` are the indices on the side light comes from and on the one it goes to;
  ``eta`` alone is the index of the glass over that of what surrounds it.
- ``theta_i`` is an angle of incidence, between the ray and the normal.
- ``apex`` is the angle between the two faces of a prism, 0 to π.
- Radii are positive when the centre lies beyond the surface; ±inf is a plane.

References:
    Born, M. and Wolf, E. (1999), Principles of Optics, 7th edition, Cambridge University Press.
    Duffie, J. A. and Beckman, W. A. (2013), Solar Engineering of Thermal Processes, 4th edition,
    Wiley.
    Hecht, E. (2017), Optics, 5th edition, Pearson.
    Kahan, W. (2006), "How Futile are Mindless Assessments of Roundoff in Floating-Point
    Computation?", §12 (angles between vectors).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spectra.arrays import FloatArray

__all__ = [
    "Refraction",
    "SlabSplit",
    "angle_between",
    "ball_lens_back_focal_length",
    "ball_lens_focal_length",
    "brewster_angle",
    "critical_angle",
    "fresnel_reflectance",
    "lensmaker_back_focal_length",
    "lensmaker_focal_length",
    "plate_lateral_shift",
    "prism_deviation",
    "prism_incidence_at_minimum_deviation",
    "prism_minimum_deviation",
    "slab_split",
    "slab_transmittance",
    "snell_angle",
]


class Refraction(NamedTuple):
    """What Snell's law says of a ray."""

    theta_t: FloatArray  # Angle of refraction [rad]; the evanescent wave's, ±π/2, if total.
    is_total: NDArray[np.bool_]  # Whether all light is reflected: there is no refracted ray.


class SlabSplit(NamedTuple):
    """Where the light that meets a slab ends up: shares of it, which add up to 1."""

    reflected: FloatArray  # Sent back, by both faces together.
    transmitted: FloatArray  # Sent on.
    absorbed: FloatArray  # Left inside.


def snell_angle(theta_i: ArrayLike, eta_i: ArrayLike, eta_t: ArrayLike) -> Refraction:
    """Angle of refraction, η_i sin θ_i = η_t sin θ_t (Born & Wolf 1999, §1.5.1, eq. 8).

    Never NaN: total internal reflection is said, and the boundary itself is total.

    Args:
        theta_i: -π/2 to π/2; θ_t takes its sign.
        eta_i: Index before the interface.
        eta_t: Index behind it.
    """
    sin_theta_t = np.sin(_float64(theta_i)) * _float64(eta_i) / _float64(eta_t)
    # At grazing incidence onto a denser medium or an equal one, sin θ_t reaches 1 without any
    # total reflection; only light coming from the denser side can be totally reflected.
    is_total = (np.abs(sin_theta_t) >= 1.0) & np.greater(eta_i, eta_t)
    return Refraction(np.arcsin(np.clip(sin_theta_t, -1.0, 1.0)), is_total)


def critical_angle(eta_i: ArrayLike, eta_t: ArrayLike) -> FloatArray:
    """Least angle of total internal reflection, sin θ_c = η_t / η_i (Born & Wolf 1999, §1.5.4).

    NaN where there is none, η_t > η_i.
    """
    sin_theta_c = _float64(eta_t) / _float64(eta_i)
    return _arcsin_or_nan(sin_theta_c, sin_theta_c <= 1.0)


def brewster_angle(eta_i: ArrayLike, eta_t: ArrayLike) -> FloatArray:
    """Angle at which no p light is reflected, tan θ_B = η_t / η_i (Born & Wolf 1999, §1.5.3)."""
    return np.arctan2(_float64(eta_t), _float64(eta_i))


def fresnel_reflectance(
    cos_theta_i: ArrayLike, eta_i: ArrayLike, eta_t: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Reflectance of an interface between dielectrics (Born & Wolf 1999, §1.5.2, eq. 21).

    The textbook's numerators cancel where the indices are close. With η = η_t/η_i, c = cos θ_i,
    s = sin θ_i and g = η cos θ_t = √(c² + η² - 1), multiplying r_s = (c - g)/(c + g) and
    r_p = (η² c - g)/(η² c + g) above and below by their denominators leaves products alone:

        r_s = -(η² - 1) / (c + g)²
        r_p = (η² - 1) (η² c² - s²) / (η² c + g)²

    Args:
        cos_theta_i: Cosine of the angle of incidence, 0 to 1.
        eta_i: Index before the interface.
        eta_t: Index behind it.

    Returns:
        Rs and Rp: 1 with total internal reflection, its boundary included, and at grazing
        incidence; 0 where the indices are equal, at any angle.
    """
    cos_i, index_i, index_t = _float64(cos_theta_i), _float64(eta_i), _float64(eta_t)
    eta = index_t / index_i
    contrast = (index_t - index_i) / index_i * (eta + 1.0)  # η² - 1; the difference is exact.
    g2 = cos_i * cos_i + contrast
    is_total = (g2 <= 0.0) & (contrast != 0.0)
    special = is_total | (contrast == 0.0)
    g2 = np.where(special, 1.0, g2)
    g = np.sqrt(g2)
    sin2_i = (1.0 - cos_i) * (1.0 + cos_i)
    # (x + g)² as g² + x (x + 2g), so that grazing incidence divides η² - 1 by itself: exactly 1.
    p_cos_i = eta * eta * cos_i
    r_s = -contrast / (g2 + cos_i * (cos_i + 2.0 * g))
    r_p = contrast * ((eta * cos_i) ** 2 - sin2_i) / (g2 + p_cos_i * (p_cos_i + 2.0 * g))
    known = is_total.astype(np.float64)
    return np.where(special, known, r_s * r_s)[()], np.where(special, known, r_p * r_p)[()]


def slab_split(theta_i: ArrayLike, eta: ArrayLike, *, optical_depth: ArrayLike = 0.0) -> SlabSplit:
    """Unpolarised light on a plane-parallel slab, all internal reflections summed incoherently.

    With the reflectance r of either face and the transmittance a = exp(-α d / cos θ_t) of one
    crossing, the geometric series sum, for each polarisation, to (Duffie and Beckman 2013, §5.3,
    eq. 5.3.1 to 5.3.3):

        transmitted T = (1 - r)² a / (1 - r² a²)
        reflected = r (1 + a T)
        absorbed = (1 - a) (1 - r) / (1 - r a)

    Args:
        theta_i: 0 to π/2.
        eta: Index of the slab.
        optical_depth: Napierian absorption coefficient times thickness, α d, 0 or more.
    """
    path = _float64(optical_depth) / np.cos(snell_angle(theta_i, 1.0, eta).theta_t)
    faces = fresnel_reflectance(np.cos(_float64(theta_i)), 1.0, eta)
    of_s, of_p = (_slab_split_polarised(face, path) for face in faces)
    return SlabSplit(*(0.5 * (s + p) for s, p in zip(of_s, of_p, strict=True)))


def _slab_split_polarised(face: FloatArray, path: FloatArray) -> SlabSplit:
    """One polarisation of :func:`slab_split`: face reflectance, optical depth of one crossing."""
    crossing, lost = np.exp(-path), -np.expm1(-path)
    entering = 1.0 - face
    kept = face * crossing
    # A perfect mirror lets nothing in: 0 over 0 is 0.
    room = np.where(kept == 1.0, 1.0, 1.0 - kept)
    transmitted = entering * entering * crossing / (room * (1.0 + kept))
    absorbed = lost * entering / room
    return SlabSplit(face * (1.0 + crossing * transmitted), transmitted, absorbed)


def slab_transmittance(
    theta_i: ArrayLike, eta: ArrayLike, *, optical_depth: ArrayLike = 0.0
) -> FloatArray:
    """Share of unpolarised light that a plane-parallel slab sends on; see :func:`slab_split`."""
    return slab_split(theta_i, eta, optical_depth=optical_depth).transmitted


def prism_deviation(apex: ArrayLike, theta_i: ArrayLike, eta: ArrayLike) -> FloatArray:
    """Deviation of a ray straight through a prism's two faces (Born & Wolf 1999, §4.7.2).

    δ = θ_i + θ_e - A, with θ_e from Snell's law at the second face, which the ray meets at the
    angle A - θ_t: refracted twice in the plane across the apex's edge, reflected nowhere.

    Args:
        apex: Angle between the faces.
        theta_i: -π/2 to π/2; positive when the ray comes from the base's side of the normal.
        eta: Index of the prism.

    Returns:
        Deviation, positive toward the base; NaN where the ray is totally reflected at either face,
        leaves along the second, or runs away from it.
    """
    theta_i, apex = _float64(theta_i), _float64(apex)
    inside, never_entered = snell_angle(theta_i, 1.0, eta)
    theta_e, never_left = snell_angle(apex - inside, eta, 1.0)
    # Beyond a right angle the ray inside runs away from the second face and does not meet it.
    misses = np.abs(apex - inside) >= 0.5 * np.pi
    deviation = theta_i + theta_e - apex
    return np.where(never_entered | never_left | misses, np.nan, deviation)[()]


def prism_minimum_deviation(apex: ArrayLike, eta: ArrayLike) -> FloatArray:
    """Least deviation, sin((δ + A) / 2) = η sin(A / 2) (Born & Wolf 1999, §4.7.2).

    NaN where no ray passes, η sin(A/2) >= 1.
    """
    return 2.0 * prism_incidence_at_minimum_deviation(apex, eta) - _float64(apex)


def prism_incidence_at_minimum_deviation(apex: ArrayLike, eta: ArrayLike) -> FloatArray:
    """Incidence of the symmetric path, sin θ_i = η sin(A / 2) (Born & Wolf 1999, §4.7.2).

    NaN where no ray passes, η sin(A/2) >= 1.
    """
    sin_theta_i = _float64(eta) * np.sin(0.5 * _float64(apex))
    return _arcsin_or_nan(sin_theta_i, sin_theta_i < 1.0)


def lensmaker_focal_length(
    eta: ArrayLike, r1: ArrayLike, r2: ArrayLike, thickness: ArrayLike
) -> FloatArray:
    """Effective focal length of a thick lens (Hecht 2017, §6.1, eq. 6.2).

    1/f = (η - 1) [1/R₁ - 1/R₂ + (η - 1) d / (η R₁ R₂)]

    Args:
        eta: Index of the lens.
        r1: Radius R₁ of the first surface.
        r2: Radius R₂ of the second surface.
        thickness: Distance d between the vertices.

    Returns:
        Focal length, negative for a diverging lens, inf without power.
    """
    index, c1, c2 = _float64(eta), 1.0 / _float64(r1), 1.0 / _float64(r2)
    excess = index - 1.0
    power = excess * (c1 - c2 + excess * _float64(thickness) * c1 * c2 / index)
    return _reciprocal_or_inf(power)


def lensmaker_back_focal_length(
    eta: ArrayLike, r1: ArrayLike, r2: ArrayLike, thickness: ArrayLike
) -> FloatArray:
    """Distance from the second vertex to the focus (Hecht 2017, §6.1, eq. 6.4 and 6.2).

    f_b = f (1 - (η - 1) d / (η R₁)); arguments as for :func:`lensmaker_focal_length`. Negative when
    the focus is not behind the lens, inf without power.
    """
    index = _float64(eta)
    focal_length = lensmaker_focal_length(eta, r1, r2, thickness)
    return focal_length * (1.0 - (index - 1.0) * _float64(thickness) / (index * _float64(r1)))


def ball_lens_focal_length(eta: ArrayLike, diameter: ArrayLike) -> FloatArray:
    """Effective focal length of a ball, from its centre: f = η D / (4 (η - 1))."""
    radius = 0.5 * _float64(diameter)
    return lensmaker_focal_length(eta, radius, -radius, diameter)


def ball_lens_back_focal_length(eta: ArrayLike, diameter: ArrayLike) -> FloatArray:
    """Distance from a ball's rear vertex to the focus, f_b = f - D / 2; negative inside it."""
    return ball_lens_focal_length(eta, diameter) - 0.5 * _float64(diameter)


def plate_lateral_shift(theta_i: ArrayLike, eta: ArrayLike, thickness: ArrayLike) -> FloatArray:
    """Sideways shift of a ray through a plane-parallel plate (Born & Wolf 1999, §1.5.1, eq. 8).

    The ray runs t / cos θ_t inside, at θ_i - θ_t to where it was going; with Snell's law that is
    t sin(θ_i - θ_t) / cos θ_t = t sin θ_i (1 - cos θ_i / √(η² - sin² θ_i)).
    """
    theta_i = _float64(theta_i)
    sin_theta_i, cos_theta_i, index = np.sin(theta_i), np.cos(theta_i), _float64(eta)
    eta_cos_theta_t = np.sqrt((index - sin_theta_i) * (index + sin_theta_i))
    shift: FloatArray = _float64(thickness) * sin_theta_i * (1.0 - cos_theta_i / eta_cos_theta_t)
    return shift


def angle_between(a: ArrayLike, b: ArrayLike) -> FloatArray:
    """Angle between vectors, atan2(‖a × b‖, a · b), exact to rounding at any angle (Kahan 2006).

    The arc cosine of the dot product loses half its digits near 0 and π. Vectors may have any
    length but 0, shape (..., 3); angles are 0 to π, shape (...).
    """
    a, b = _float64(a), _float64(b)
    x, y, z = np.moveaxis(np.cross(a, b), -1, 0)
    sine = np.hypot(np.hypot(x, y), z)  # Squares of the smallest angles would vanish.
    angle: FloatArray = np.arctan2(sine, np.sum(a * b, axis=-1))
    return angle


def _float64(values: ArrayLike) -> FloatArray:
    return np.asarray(values, dtype=np.float64)


def _arcsin_or_nan(sine: FloatArray, exists: NDArray[np.bool_]) -> FloatArray:
    angle: FloatArray = np.where(exists, np.arcsin(np.clip(sine, -1.0, 1.0)), np.nan)[()]
    return angle


def _reciprocal_or_inf(values: FloatArray) -> FloatArray:
    infinite = np.full(np.shape(values), np.inf)
    reciprocal: FloatArray = np.divide(1.0, values, out=infinite, where=values != 0.0)[()]
    return reciprocal
