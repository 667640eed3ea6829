"""What a small change of a relative index can do to light at a boundary, in the worst case.

A ray meets a boundary at an angle of sine s, with η = n_i/n_t, and η becomes η (1 + Δ). With
x = η s ≤ 1 the sine of the refracted angle,

- the angle changes by at most arccos(1 − Δ) ≤ (π/2) √Δ: most where it grazes;
- R_s and R_p are f(q) = ((1 − q)/(1 + q))² of q = cosθ_t/(η cosθ_i) and η cosθ_t/cosθ_i (Born &
  Wolf 1999, §1.5.2 eq. 21). |df/dq| ≤ 4, |df/d ln q| ≤ 0.4. Into the denser medium cos²θ_t ≥
  1 − η², so that ln q changes by at most Δ (1 + 1/(m² − 1)), m = max(η, 1/η). Out of it, cosθ_t
  changes by at most √(2Δ), where cos²θ_i ≥ 1 − 1/m²: R_s changes by at most
  4 √(2Δ)/√(m² − 1), R_p by m² as much.

All of it added, a boundary's error is at most

    B(m, Δ) = √Δ (π/2 + 2√2 (1 + m²)/√(m² − 1)) + 0.4 Δ (1 + 1/(m² − 1)),

to first order in Δ, as a part of the photon's flux and, since light goes no further than the
scene's diameter before it meets something, of its place. The square root is total reflection's:
next to the critical angle, everything depends on the last digits of the index.

Not in it: that curved surfaces magnify what is off already. This is what the canary is for.
"""

import math

import numpy as np

from sim.features.registry import Subject
from spectra import Medium, SpectraError, Tabulated, air_index

__all__ = ["BOUNDARIES", "boundary_error", "path_error", "relative_variations"]

BOUNDARIES = 8
"""Boundaries that count: behind these, glass has kept a photon's lesser part."""

_SAMPLES = 257
_ROUNDING = 4.0 * float(np.finfo(np.float64).eps)


def boundary_error(eta: float, variation: float) -> float:
    """B(m, Δ) of this module's head; infinite without contrast, where grazing light decides.

    Args:
        eta: relative index, either way round.
        variation: its relative change, Δ.
    """
    m = max(eta, 1.0 / eta)
    if m == 1.0:
        return math.inf
    contrast = m * m - 1.0
    root = 0.5 * math.pi + 2.0 * math.sqrt(2.0) * (1.0 + m * m) / math.sqrt(contrast)
    return root * math.sqrt(variation) + 0.4 * variation * (1.0 + 1.0 / contrast)


def path_error(eta: float, variation: float) -> float:
    """The bound for a photon's whole path: `BOUNDARIES` of them."""
    return BOUNDARIES * boundary_error(eta, variation)


def relative_variations(subject: Subject) -> list[tuple[float, float]] | None:
    """(η, Δ) of each two media that can meet, over the film's range.

    Each medium meets the ambient one; where solids may touch, any other one too. η is the value of
    least contrast, Δ never less than rounding. None where an index has no value in a part of the
    film's range: nothing is known then.
    """
    edges_nm = subject.scene.film.edges_nm
    wavelength_nm = np.linspace(edges_nm[0], edges_nm[-1], _SAMPLES)
    for medium in subject.media:
        if isinstance(medium.dispersion, Tabulated):  # monotone between its knots
            wavelength_nm = np.union1d(wavelength_nm, medium.dispersion.knots_nm)
    wavelength_nm = wavelength_nm[
        (wavelength_nm >= edges_nm[0]) & (wavelength_nm <= edges_nm[-1])
    ]
    try:
        indices = [
            _index(medium, power, wavelength_nm)
            for medium, power in zip(subject.media, subject.air_powers, strict=True)
        ]
    except SpectraError:
        return None
    found = []
    others = len(indices) if subject.near_pairs else 1
    pairs = [(i, j) for i in range(others) for j in range(i + 1, len(indices))]
    for i, j in pairs or [(0, 0)]:
        eta = indices[j] / indices[i]
        variation = float(np.max(eta) / np.min(eta) - 1.0) + _ROUNDING
        crosses = np.min(eta) <= 1.0 <= np.max(eta)
        least = 1.0 if crosses else float(eta[np.argmin(np.abs(np.log(eta)))])
        found.append((least, variation))
    return found


def _index(medium: Medium, air_power: int, wavelength_nm: np.ndarray) -> np.ndarray:
    index = np.asarray(medium.dispersion.eta(wavelength_nm))
    return index * np.asarray(air_index(wavelength_nm)) ** air_power if air_power else index
