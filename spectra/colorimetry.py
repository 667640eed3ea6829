"""The colour of light: tristimulus values, chromaticity, correlated colour temperature.

References:
    CIE 015:2018, Colorimetry, 4th edition: §7.1 tristimulus values, §7.3 chromaticity, §9.4 and
    §9.5 distribution and correlated colour temperature.
    Ohno, Y. (2014), "Practical use and calculation of CCT and Duv", LEUKOS 10, 47-55.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from spectra.arrays import FloatArray
from spectra.emission import EmissionSpectrum
from spectra.errors import SpectraError
from spectra.illuminants import blackbody
from spectra.observer import observer
from spectra.piecewise import interpolate
from spectra.units import LUMINOUS_EFFICACY_LM_W

__all__ = [
    "ColourTemperature",
    "Share",
    "chromaticity",
    "colour_temperature",
    "luminous_efficacy",
    "tristimulus",
]

Share: TypeAlias = Callable[[FloatArray], FloatArray]
"""What reaches the eye of the light of each wavelength [nm], 0 to 1, shape (n,) for (n,)."""

_OBSERVER: Final = "CIE 1931 2 degree"

_FARTHEST_DUV: Final = 0.05
"""How far from the Planckian locus a colour temperature has a meaning (CIE 015:2018, §9.5)."""

# The locus in mired, 1e6 K over temperature, where it is traversed evenly: 1000 K to 1,000,000 K.
_MIRED: Final = (1.0, 1000.0)
_LOCUS_POINTS: Final = 200
_GOLDEN: Final = (math.sqrt(5.0) - 1.0) / 2.0
_NARROWINGS: Final = 60


class ColourTemperature(NamedTuple):
    """The blackbody most like a light in colour.

    Attributes:
        kelvin: Its temperature, the correlated colour temperature [K].
        duv: Distance from it in the CIE 1960 diagram, positive for the greener side (Ohno 2014).
    """

    kelvin: float
    duv: float


def tristimulus(
    source: EmissionSpectrum, *, share: Share | None = None, by: str = _OBSERVER
) -> FloatArray:
    """Tristimulus values of a light, or of what a filter or a mirror leaves of it (§7.1).

    Exact for the piecewise linear spectrum and colour matching functions, lines included; a share
    is taken as quadratic between points half a nanometre apart.

    Args:
        source: The light.
        share: What is left of it; None: all.
        by: Name of the observer.

    Returns:
        683 lm/W times ∫ x̄, ȳ, z̄ of the flux, shape (3,), on the scale of the spectrum's flux.

    Raises:
        UnknownObserver: If there is no such observer.
    """
    eye = observer(by)
    lines = source.line_wavelength_nm
    response = source.line_flux @ interpolate(lines, eye.wavelength_nm, eye.cmf)
    if share is not None and len(lines):
        kept = source.line_flux * share(lines)
        response = kept @ interpolate(lines, eye.wavelength_nm, eye.cmf)
    if len(source.wavelength_nm):
        knots = np.union1d(eye.wavelength_nm, source.wavelength_nm)
        low = max(eye.wavelength_nm[0], source.wavelength_nm[0])
        high = min(eye.wavelength_nm[-1], source.wavelength_nm[-1])
        inside = knots[(knots >= low) & (knots <= high)]
        middle = 0.5 * (inside[1:] + inside[:-1])

        def seen(at: FloatArray) -> FloatArray:
            density = source.density_at(at) * (1.0 if share is None else share(at))
            return density[:, np.newaxis] * interpolate(at, eye.wavelength_nm, eye.cmf)

        # Simpson's rule is exact for products of two straight lines.
        ends, widths = seen(inside), np.diff(inside) / 6.0
        response = response + widths @ (ends[:-1] + 4.0 * seen(middle) + ends[1:])
    xyz: FloatArray = LUMINOUS_EFFICACY_LM_W * response
    return xyz


def luminous_efficacy(source: EmissionSpectrum) -> float:
    """Luminous efficacy of the radiation itself [lm/W] (CIE 018:2019, §3), of all it emits."""
    return float(tristimulus(source)[1]) / source.total


def chromaticity(xyz: npt.ArrayLike) -> FloatArray:
    """Chromaticity x, y = X, Y over X + Y + Z (§7.3).

    Args:
        xyz: Tristimulus values, shape (..., 3).

    Returns:
        x and y, shape (..., 2).

    Raises:
        SpectraError: If one of the colours is black, which has no chromaticity.
    """
    values = np.asarray(xyz, dtype=np.float64)
    total = values.sum(axis=-1, keepdims=True)
    if not np.all(total > 0.0):
        raise SpectraError("black has no chromaticity; allowed: X + Y + Z above 0")
    xy: FloatArray = values[..., :2] / total
    return xy


def colour_temperature(xyz: npt.ArrayLike) -> ColourTemperature | None:
    """Correlated colour temperature: of the nearest blackbody in the CIE 1960 diagram (§9.5).

    Args:
        xyz: Tristimulus values by the 1931 observer, shape (3,).

    Returns:
        The temperature and the distance; None where it has no meaning: further than 0.05 from the
        Planckian locus, or beyond the locus's 1000 K and 1,000,000 K.

    Raises:
        SpectraError: If the colour is black.
    """
    chromaticity(xyz)
    uv = _uv(np.asarray(xyz, dtype=np.float64))
    mired = np.linspace(*_MIRED, _LOCUS_POINTS)
    distance = np.linalg.norm(np.array([_locus_uv(one) for one in mired]) - uv, axis=1)
    nearest = int(np.argmin(distance))
    if nearest in (0, _LOCUS_POINTS - 1):
        return None
    found = _nearest_mired(uv, float(mired[nearest - 1]), float(mired[nearest + 1]))
    away = uv - _locus_uv(found)
    duv = math.copysign(float(np.hypot(*away)), float(away[1]))
    return ColourTemperature(1e6 / found, duv) if abs(duv) <= _FARTHEST_DUV else None


def _nearest_mired(uv: FloatArray, low: float, high: float) -> float:
    """Where between two places on the locus it comes nearest to a colour: golden section."""
    for _ in range(_NARROWINGS):
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        if _squared(uv - _locus_uv(left)) < _squared(uv - _locus_uv(right)):
            high = right
        else:
            low = left
        if high - low < 1e-6 * low:
            break
    return 0.5 * (low + high)


def _squared(vector: FloatArray) -> float:
    return float(vector @ vector)


@cache
def _locus_uv(mired: float) -> FloatArray:
    return _uv(tristimulus(blackbody(1e6 / mired)))


def _uv(xyz: FloatArray) -> FloatArray:
    """CIE 1960 u, v = 4X, 6Y over X + 15Y + 3Z (CIE 015:2018, §9.5)."""
    x, y, z = xyz
    uv: FloatArray = np.array([4.0 * x, 6.0 * y]) / (x + 15.0 * y + 3.0 * z)
    return uv
