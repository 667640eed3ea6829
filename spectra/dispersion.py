"""Dispersion formulas: refractive index as a function of wavelength.

The formulas are published with the wavelength in micrometres. The one conversion from nanometres
happens at the top of each formula, and names after it say ``_um2``.

References:
    Sellmeier, W. (1871), "Zur Erklärung der abnormen Farbenfolge im Spectrum einiger Substanzen",
    Annalen der Physik 219, 272-282.
    Cauchy, A.-L. (1836), "Mémoire sur la dispersion de la lumière".
    Fritsch, F. N. and Carlson, R. E. (1980), "Monotone piecewise cubic interpolation", SIAM Journal
    on Numerical Analysis 17, 238-246.
    Ciddor, P. E. (1996), "Refractive index of air: new equations for the visible and near
    infrared", Applied Optics 35, 1566-1573.
"""

import abc
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from spectra.arrays import FloatArray, FloatOrArray, float_tuple, like, read_only
from spectra.errors import SpectraError, WavelengthOutOfRange
from spectra.units import NM_PER_UM

__all__ = [
    "MAX_TERMS",
    "Cauchy",
    "Dispersion",
    "Sellmeier",
    "Tabulated",
    "air_index",
    "require_in_range",
]

MAX_TERMS = 4
"""Most terms a Sellmeier or Cauchy formula may have."""

_CIDDOR_RANGE_NM = (230.0, 1690.0)


class Dispersion(abc.ABC):
    """A refractive index as a function of wavelength, without a statement of where it is valid."""

    @property
    @abc.abstractmethod
    def is_dispersive(self) -> bool:
        """Whether the index depends on the wavelength at all."""

    @abc.abstractmethod
    def _index(self, wavelength_nm: FloatArray) -> FloatArray:
        """The formula itself, not finite where it has no real value; may warn."""

    def eta(self, wavelength_nm: FloatOrArray) -> FloatOrArray:
        """Refractive index.

        Args:
            wavelength_nm: Wavelength [nm], a number or an array of any shape.

        Returns:
            Refractive index, a float or a float64 array of the same shape.

        Raises:
            SpectraError: Where there is no positive, finite index, as next to a resonance.
            WavelengthOutOfRange: Outside a table.
        """
        wavelength = np.asarray(wavelength_nm, dtype=np.float64)
        with np.errstate(all="ignore"):  # What these would warn of is raised below.
            index = self._index(wavelength)
        broken = ~((wavelength > 0.0) & np.isfinite(index) & (index > 0.0))
        if np.any(broken):
            raise SpectraError(
                f"{type(self).__name__} formula gives no refractive index at "
                f"{wavelength[broken].flat[0]:g} nm; "
                "allowed: wavelengths above 0 where n² is positive, away from resonances"
            )
        return like(index, wavelength_nm)


@dataclass(frozen=True)
class Sellmeier(Dispersion):
    """Sellmeier's formula, n² - 1 = Σ Bᵢ λ² / (λ² - Cᵢ), λ in micrometres (Sellmeier 1871).

    Sources print either Cᵢ itself or its square root, the wavelength of the resonance. This
    class holds Cᵢ; :meth:`from_roots` takes the roots.

    Attributes:
        b: Strengths Bᵢ, 1 to 4 of them.
        c_um2: Squared resonance wavelengths Cᵢ [µm²], as many.
    """

    b: tuple[float, ...]
    c_um2: tuple[float, ...]

    def __post_init__(self) -> None:
        """Check the coefficients."""
        object.__setattr__(self, "b", float_tuple(self.b, "Sellmeier b"))
        object.__setattr__(self, "c_um2", float_tuple(self.c_um2, "Sellmeier c_um2"))
        if not 1 <= len(self.b) == len(self.c_um2) <= MAX_TERMS:
            raise SpectraError(
                f"Sellmeier b has {len(self.b)} terms and c_um2 has {len(self.c_um2)}; "
                f"allowed: 1 to {MAX_TERMS}, as many of each"
            )

    @classmethod
    def from_roots(cls, b: tuple[float, ...], c_um: tuple[float, ...]) -> Self:
        """From coefficients printed as n² - 1 = Σ Bᵢ λ² / (λ² - cᵢ²), with cᵢ in micrometres."""
        return cls(b=b, c_um2=tuple(c * c for c in c_um))

    @property
    def is_dispersive(self) -> bool:
        """Whether any term has a resonance at a wavelength other than zero."""
        return any(b * c != 0.0 for b, c in zip(self.b, self.c_um2, strict=True))

    @property
    def resonances_nm(self) -> tuple[float, ...]:
        """Wavelengths at which the formula has a pole [nm], ascending."""
        terms = zip(self.b, self.c_um2, strict=True)
        return tuple(sorted(NM_PER_UM * c**0.5 for b, c in terms if b != 0.0 and c > 0.0))

    def _index(self, wavelength_nm: FloatArray) -> FloatArray:
        squared_um2 = (wavelength_nm / NM_PER_UM) ** 2
        terms = (
            b * squared_um2 / (squared_um2 - c) for b, c in zip(self.b, self.c_um2, strict=True)
        )
        return np.sqrt(1.0 + sum(terms, start=np.zeros_like(squared_um2)))


@dataclass(frozen=True)
class Cauchy(Dispersion):
    """Cauchy's formula, n = Σ aₖ λ^(-2k) from k = 0, λ in micrometres (Cauchy 1836).

    Attributes:
        a: Coefficients aₖ [µm^2k], 1 to 4 of them; a single one is a constant index.
    """

    a: tuple[float, ...]

    def __post_init__(self) -> None:
        """Check the coefficients."""
        object.__setattr__(self, "a", float_tuple(self.a, "Cauchy a"))
        if not 1 <= len(self.a) <= MAX_TERMS:
            raise SpectraError(f"Cauchy a has {len(self.a)} terms; allowed: 1 to {MAX_TERMS}")
        if len(self.a) == 1 and self.a[0] <= 0.0:
            raise SpectraError(f"constant index {self.a[0]:g}; allowed: above 0")

    @property
    def is_dispersive(self) -> bool:
        """Whether any coefficient beyond the constant one counts."""
        return any(a != 0.0 for a in self.a[1:])

    def _index(self, wavelength_nm: FloatArray) -> FloatArray:
        inverse_square_per_um2 = (NM_PER_UM / wavelength_nm) ** 2
        index = np.full_like(wavelength_nm, self.a[-1])
        for coefficient in reversed(self.a[:-1]):
            index = index * inverse_square_per_um2 + coefficient
        return index


@dataclass(frozen=True)
class Tabulated(Dispersion):
    """A measured table, interpolated by a monotone cubic (Fritsch and Carlson 1980).

    The interpolant is continuously differentiable and, between two samples, never leaves the
    interval they span. There is no extrapolation.

    Attributes:
        wavelength_nm: Wavelengths of the samples [nm], strictly increasing, 2 or more.
        index: Refractive index at each, above 0.
    """

    wavelength_nm: tuple[float, ...]
    index: tuple[float, ...]

    def __post_init__(self) -> None:
        """Check the table."""
        wavelengths = float_tuple(self.wavelength_nm, "tabulated wavelengths")
        indices = float_tuple(self.index, "tabulated indices")
        object.__setattr__(self, "wavelength_nm", wavelengths)
        object.__setattr__(self, "index", indices)
        if not 2 <= len(wavelengths) == len(indices):
            raise SpectraError(
                f"table has {len(wavelengths)} wavelengths and {len(indices)} indices; "
                "allowed: 2 or more, as many of each"
            )
        if wavelengths[0] <= 0.0 or min(np.diff(wavelengths)) <= 0.0:
            raise SpectraError("tabulated wavelengths must be above 0 and strictly increasing")
        if min(indices) <= 0.0:
            raise SpectraError(f"tabulated index {min(indices):g}; allowed: above 0")

    @property
    def is_dispersive(self) -> bool:
        """Whether the samples differ."""
        return len(set(self.index)) > 1

    @property
    def wavelength_range_nm(self) -> tuple[float, float]:
        """First and last wavelength of the table [nm]."""
        return self.wavelength_nm[0], self.wavelength_nm[-1]

    @cached_property
    def knots_nm(self) -> FloatArray:
        """Wavelengths of the samples [nm], shape (n,), read-only."""
        return read_only(self.wavelength_nm)

    @cached_property
    def coefficients(self) -> FloatArray:
        """Cubics between the knots, shape (n - 1, 4), read-only.

        Row i holds the powers of (λ - knots_nm[i]) in nanometres, highest first, so that
        ``((c0 * t + c1) * t + c2) * t + c3`` is the index anywhere between knots i and i + 1.
        """
        # Imported here: SciPy costs a third of a second, and only tables need it.
        from scipy.interpolate import PchipInterpolator

        cubic = PchipInterpolator(self.knots_nm, np.asarray(self.index, dtype=np.float64))
        return read_only(cubic.c.T)

    def _index(self, wavelength_nm: FloatArray) -> FloatArray:
        require_in_range(wavelength_nm, "table", self.wavelength_range_nm)
        # The first and last cubic own the two ends, so that the last knot is inside.
        last = len(self.coefficients) - 1
        row = np.clip(np.searchsorted(self.knots_nm, wavelength_nm, side="right") - 1, 0, last)
        t = wavelength_nm - self.knots_nm[row]
        c0, c1, c2, c3 = np.moveaxis(self.coefficients[row], -1, 0)
        index: FloatArray = ((c0 * t + c1) * t + c2) * t + c3
        return index


def require_in_range(
    wavelength_nm: FloatArray,
    medium: str,
    range_nm: tuple[float, float],
    *,
    quantity: str = "refractive index",
) -> None:
    """Refuse wavelengths [nm] outside ``range_nm``, ends included; NaN is outside.

    Raises:
        WavelengthOutOfRange: Naming ``medium``, the ``quantity`` that it lacks there, and the
            first wavelength outside.
    """
    low, high = range_nm
    outside = ~((wavelength_nm >= low) & (wavelength_nm <= high))
    if np.any(outside):
        first = float(wavelength_nm[outside].flat[0])
        raise WavelengthOutOfRange(medium, first, range_nm, quantity)


def air_index(wavelength_nm: FloatOrArray) -> FloatOrArray:
    """Refractive index of standard air relative to vacuum (Ciddor 1996, eq. 1 and appendix A).

    Standard air is dry, at 15 °C and 101,325 Pa, with 450 ppm of CO2.

    Args:
        wavelength_nm: Vacuum wavelength [nm], 230 to 1690 for the published fit. Given the
            wavelength in air instead, the answer changes by less than 2e-8 where it is visible.

    Returns:
        Refractive index, a float or a float64 array of the same shape.

    Raises:
        WavelengthOutOfRange: Outside 230 to 1690 nm.
    """
    wavelength = np.asarray(wavelength_nm, dtype=np.float64)
    require_in_range(wavelength, "standard air", _CIDDOR_RANGE_NM)
    squared_wavenumber_per_um2 = (NM_PER_UM / wavelength) ** 2
    index = (
        1.0
        + 0.05792105 / (238.0185 - squared_wavenumber_per_um2)
        + 0.00167917 / (57.362 - squared_wavenumber_per_um2)
    )
    return like(index, wavelength_nm)
