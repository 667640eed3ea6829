"""Metals: complex refractive indices η + ik as functions of wavelength, by name.

With the time dependence exp(-iωt) that makes k positive where light is absorbed (Born & Wolf 1999,
§14.1). Names are resolved exactly or not at all.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from spectra.arrays import FloatArray, FloatOrArray, float_tuple, like, read_only
from spectra.dispersion import require_in_range
from spectra.errors import SpectraError, UnknownConductor
from spectra.metal_tables import METALS

__all__ = ["Conductor", "conductor", "conductors"]


@dataclass(frozen=True)
class Conductor:
    """A metal: a table of its complex index, linear between the entries.

    Attributes:
        name: What people call it.
        wavelength_nm: Wavelengths of the entries [nm], 2 or more, strictly increasing.
        eta_values: Real part η of the index at each, above 0.
        k_values: Imaginary part k at each, the extinction coefficient, 0 or more.
        source: Publication the numbers come from.
    """

    name: str
    wavelength_nm: tuple[float, ...]
    eta_values: tuple[float, ...]
    k_values: tuple[float, ...]
    source: str

    def __post_init__(self) -> None:
        """Check the table."""
        for field in ("wavelength_nm", "eta_values", "k_values"):
            checked = float_tuple(getattr(self, field), f"{self.name}: {field}")
            object.__setattr__(self, field, checked)
        count = len(self.wavelength_nm)
        if not 2 <= count == len(self.eta_values) == len(self.k_values):
            raise SpectraError(
                f"{self.name}: {count} wavelengths, {len(self.eta_values)} values of eta and"
                f" {len(self.k_values)} of k; allowed: 2 or more, as many of each"
            )
        if self.wavelength_nm[0] <= 0.0 or not np.all(np.diff(self.wavelength_nm) > 0.0):
            raise SpectraError(
                f"{self.name}: wavelengths {self.wavelength_nm} nm;"
                " allowed: above 0, strictly increasing"
            )
        if not min(self.eta_values) > 0.0 or not min(self.k_values) >= 0.0:
            raise SpectraError(
                f"{self.name}: eta down to {min(self.eta_values):g} and k down to"
                f" {min(self.k_values):g}; allowed: eta above 0, k 0 or more"
            )

    @property
    def wavelength_range_nm(self) -> tuple[float, float]:
        """Lowest and highest wavelength of the table [nm]."""
        return self.wavelength_nm[0], self.wavelength_nm[-1]

    @cached_property
    def knots_nm(self) -> FloatArray:
        """Wavelengths of the entries [nm], shape (n,), read-only."""
        return read_only(self.wavelength_nm)

    @cached_property
    def eta_knots(self) -> FloatArray:
        """Real part of the index at the knots, shape (n,), read-only."""
        return read_only(self.eta_values)

    @cached_property
    def k_knots(self) -> FloatArray:
        """Imaginary part of the index at the knots, shape (n,), read-only."""
        return read_only(self.k_values)

    def eta(self, wavelength_nm: FloatOrArray) -> FloatOrArray:
        """Real part of the complex index.

        Args:
            wavelength_nm: Wavelength [nm], a number or an array of any shape.

        Returns:
            η, a float or a float64 array of the same shape.

        Raises:
            WavelengthOutOfRange: Outside the table, and for NaN.
        """
        return self._between(wavelength_nm, self.eta_knots)

    def k(self, wavelength_nm: FloatOrArray) -> FloatOrArray:
        """Imaginary part of the complex index, the extinction coefficient.

        Args:
            wavelength_nm: Wavelength [nm], a number or an array of any shape.

        Returns:
            k, a float or a float64 array of the same shape.

        Raises:
            WavelengthOutOfRange: Outside the table, and for NaN.
        """
        return self._between(wavelength_nm, self.k_knots)

    def _between(self, wavelength_nm: FloatOrArray, values: FloatArray) -> FloatOrArray:
        wavelengths = np.asarray(wavelength_nm, dtype=np.float64)
        require_in_range(wavelengths, self.name, self.wavelength_range_nm)
        return like(np.asarray(np.interp(wavelengths, self.knots_nm, values)), wavelength_nm)


_BY_NAME: Mapping[str, Conductor] = MappingProxyType(
    {name: Conductor(name, *table) for name, table in METALS.items()}
)


def conductor(name: str) -> Conductor:
    """The metal of exactly this name.

    Raises:
        UnknownConductor: If there is none; the error lists the nearest names.
    """
    try:
        return _BY_NAME[name]
    except (KeyError, TypeError):
        raise UnknownConductor(name, _BY_NAME) from None


def conductors() -> tuple[str, ...]:
    """Names of all built-in metals."""
    return tuple(_BY_NAME)
