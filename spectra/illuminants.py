"""Light sources: where each one's spectrum comes from."""

import math

import numpy as np
import numpy.typing as npt

from spectra.arrays import read_only
from spectra.emission import EmissionSpectrum
from spectra.errors import SpectraError, UnknownSpectrum
from spectra.line_spectra import LINES
from spectra.tabulated import illuminant_tables
from spectra.units import (
    BOLTZMANN_J_K,
    M_PER_NM,
    PLANCK_J_S,
    SPEED_OF_LIGHT_M_S,
    VISIBLE_RANGE_NM,
)

__all__ = [
    "blackbody",
    "cie_illuminant",
    "laser",
    "line_spectrum",
    "spectrum",
    "spectrum_names",
    "table",
]

# A Gaussian cut at 5 standard deviations has lost 6e-7 of its flux; with 16 knots to one, the
# straight lines between them stay within 5e-4 of its peak (h² / 8 times the second derivative).
_GAUSSIAN_REACH = 5
_KNOTS_PER_DEVIATION = 16
_FWHM_PER_DEVIATION = 2.0 * math.sqrt(2.0 * math.log(2.0))


def blackbody(
    temperature_k: float, range_nm: tuple[float, float] = VISIBLE_RANGE_NM
) -> EmissionSpectrum:
    """A blackbody, by Planck's law: M ∝ λ⁻⁵ / (exp(h c / λ k T) - 1) (Planck 1901).

    The exponent is kept in logarithms and the peak scaled to 1, so that neither 100 K nor 1e9 K
    overflows or vanishes.

    Args:
        temperature_k: Temperature [K], above 0.
        range_nm: Lowest and highest wavelength [nm]; knots stand 1 nm apart or a little less.

    Raises:
        SpectraError: If the temperature or the range is not positive and finite.
    """
    low, high = range_nm
    if not 0.0 < temperature_k < math.inf:
        raise SpectraError(f"blackbody at {temperature_k:g} K; allowed: above 0, finite")
    if not 0.0 < low < high < math.inf:
        raise SpectraError(f"blackbody from {low:g} to {high:g} nm; allowed: 0 < low < high")
    wavelength_nm = np.linspace(low, high, math.ceil(high - low) + 1)
    radiation_constant_m_k = PLANCK_J_S * SPEED_OF_LIGHT_M_S / BOLTZMANN_J_K
    x = radiation_constant_m_k / (wavelength_nm * M_PER_NM * temperature_k)
    log_density = -5.0 * np.log(wavelength_nm) - x - np.log(-np.expm1(-x))
    density = np.exp(log_density - log_density.max())
    return EmissionSpectrum(f"blackbody {temperature_k:g} K", wavelength_nm, density)


def cie_illuminant(name: str) -> EmissionSpectrum:
    """A CIE illuminant, "A", "D50", "D65", "E", "FL1" …, at the steps of its published table.

    Relative power per nm, cut to the visible range.

    Raises:
        UnknownSpectrum: If there is none of exactly this name; lists the nearest.
    """
    tables = illuminant_tables()
    if name not in tables:
        raise UnknownSpectrum(name, tables)
    whole = EmissionSpectrum(name, *tables[name].T)
    return whole.restricted(*VISIBLE_RANGE_NM)


def line_spectrum(name: str) -> EmissionSpectrum:
    """The lines of a spectral lamp: "sodium", "mercury", "helium-neon", "hydrogen" ….

    Raises:
        UnknownSpectrum: If there is none of exactly this name; lists the nearest.
    """
    if name not in LINES:
        raise UnknownSpectrum(name, LINES)
    lines = LINES[name]
    return EmissionSpectrum(
        name,
        line_wavelength_nm=read_only(list(lines.keys())),
        line_flux=read_only(list(lines.values())),
    )


def laser(wavelength_nm: float, width_nm: float = 0.0) -> EmissionSpectrum:
    """A laser: one line, or a Gaussian.

    Args:
        wavelength_nm: Centre [nm].
        width_nm: Full width at half maximum [nm]; 0 is a single line.

    Raises:
        SpectraError: If the centre is not above 0, the width is negative, so wide that the
            Gaussian reaches wavelength 0, or too narrow for float64.
    """
    if not 0.0 < wavelength_nm < math.inf:
        raise SpectraError(f"laser at {wavelength_nm:g} nm; allowed: above 0, finite")
    name = f"laser {wavelength_nm:g} nm"
    if width_nm == 0.0:
        return EmissionSpectrum(
            name, line_wavelength_nm=read_only([wavelength_nm]), line_flux=read_only([1.0])
        )
    deviation_nm = width_nm / _FWHM_PER_DEVIATION
    widest = wavelength_nm / _GAUSSIAN_REACH
    # Knots must remain distinct numbers: 16 to a deviation, each some rounding errors apart.
    narrowest = 8.0 * _KNOTS_PER_DEVIATION * float(np.spacing(wavelength_nm))
    if not narrowest <= deviation_nm < widest:
        raise SpectraError(
            f"{name}: width {width_nm:g} nm; allowed: 0 for a single line, or "
            f"{narrowest * _FWHM_PER_DEVIATION:.3g} to {widest * _FWHM_PER_DEVIATION:.3g}"
        )
    half_count = _GAUSSIAN_REACH * _KNOTS_PER_DEVIATION
    z = np.arange(-half_count, half_count + 1) / _KNOTS_PER_DEVIATION
    return EmissionSpectrum(name, wavelength_nm + deviation_nm * z, np.exp(-0.5 * z * z))


def table(wavelength_nm: npt.ArrayLike, values: npt.ArrayLike) -> EmissionSpectrum:
    """A spectrum of your own: relative flux per nm at wavelengths [nm], linear between them.

    Raises:
        SpectraError: If the lists differ in length, wavelengths do not increase, values are
            negative or not finite, or there is no light at all.
    """
    return EmissionSpectrum("table", read_only(wavelength_nm), read_only(values))


def spectrum_names() -> tuple[str, ...]:
    """Every name :func:`spectrum` knows: CIE illuminants, then lamps."""
    return (*illuminant_tables(), *LINES)


def spectrum(name: str) -> EmissionSpectrum:
    """The light source of exactly this name: a CIE illuminant or a spectral lamp.

    Raises:
        UnknownSpectrum: If there is none; lists the nearest.
    """
    if name in LINES:
        return line_spectrum(name)
    if name in illuminant_tables():
        return cie_illuminant(name)
    raise UnknownSpectrum(name, spectrum_names())
