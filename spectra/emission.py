"""Emission spectra: how the flux of a light source is spread over wavelengths."""

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from spectra.arrays import FloatArray, FloatOrArray, like, read_only
from spectra.errors import SpectraError
from spectra.piecewise import band_edges, integrate_bands, interpolate

__all__ = ["EmissionSpectrum"]


def _nothing() -> FloatArray:
    return read_only([])


@dataclass(frozen=True, eq=False)
class EmissionSpectrum:
    """A continuous density, spectral lines, or both.

    Only ratios count: an emitter gives the whole spectrum its flux in watts. Density and lines are
    on one scale, so that ``density * nm`` and ``line_flux`` add up. Arrays are copied and made
    read-only.

    Attributes:
        name: What people call it.
        wavelength_nm: Knots of the density [nm], strictly increasing, shape (n,), n = 0 or n >= 2.
        density: Relative flux per nm at the knots, linear between them and 0 outside, shape (n,).
        line_wavelength_nm: Wavelengths of the lines [nm], strictly increasing, shape (m,).
        line_flux: Relative flux of each line, shape (m,).

    Raises:
        SpectraError: If shapes differ, wavelengths are not positive and increasing, a value is
            negative or not finite, or there is no light at all.
    """

    name: str
    wavelength_nm: FloatArray = field(default_factory=_nothing)
    density: FloatArray = field(default_factory=_nothing)
    line_wavelength_nm: FloatArray = field(default_factory=_nothing)
    line_flux: FloatArray = field(default_factory=_nothing)

    def __post_init__(self) -> None:
        """Copy and check."""
        self._adopt("wavelength_nm", "density")
        self._adopt("line_wavelength_nm", "line_flux")
        if len(self.wavelength_nm) == 1:
            raise SpectraError(f"{self.name}: 1 sample; allowed: 2 or more, or a line")
        if not 0.0 < self.total < math.inf:
            raise SpectraError(f"{self.name}: total flux {self.total:g}; allowed: above 0, finite")

    def _adopt(self, wavelength_field: str, value_field: str) -> None:
        wavelengths = read_only(getattr(self, wavelength_field))
        values = read_only(getattr(self, value_field))
        object.__setattr__(self, wavelength_field, wavelengths)
        object.__setattr__(self, value_field, values)
        if wavelengths.ndim != 1 or wavelengths.shape != values.shape:
            raise SpectraError(
                f"{self.name}: {wavelength_field} has shape {wavelengths.shape} and {value_field} "
                f"{values.shape}; allowed: one list each, of the same length"
            )
        if not np.all(np.isfinite(values) & (values >= 0.0)):
            raise SpectraError(f"{self.name}: {value_field} must be finite and 0 or more")
        increasing = np.all(np.diff(wavelengths, prepend=0.0) > 0.0)
        if not (increasing and np.all(np.isfinite(wavelengths))):
            raise SpectraError(
                f"{self.name}: {wavelength_field} must be finite, above 0 and strictly increasing"
            )

    @property
    def support_nm(self) -> tuple[float, float]:
        """Lowest and highest wavelength of a knot or a line [nm]; equal for a single line."""
        every = np.concatenate([self.wavelength_nm, self.line_wavelength_nm])
        return float(every.min()), float(every.max())

    @property
    def total(self) -> float:
        """Flux over all wavelengths, on the scale of the attributes: ∫ density dλ + Σ lines."""
        return float(np.trapezoid(self.density, self.wavelength_nm) + self.line_flux.sum())

    def density_at(self, wavelength_nm: FloatOrArray) -> FloatOrArray:
        """Continuous part at a wavelength [nm], relative flux per nm; lines have no density."""
        at = np.asarray(wavelength_nm, dtype=np.float64)
        if not len(self.wavelength_nm):
            return like(np.zeros_like(at), wavelength_nm)
        density = interpolate(at, self.wavelength_nm, self.density)
        return like(density, wavelength_nm)

    def band_flux(self, edges_nm: npt.ArrayLike) -> FloatArray:
        """Flux in each band, exact for the linear density and including lines.

        A line on an edge belongs to the band above it; on the last edge, to the last band.

        Args:
            edges_nm: Band edges [nm], strictly increasing, shape (bands + 1,).

        Returns:
            Relative flux, shape (bands,). Over edges that enclose the support it sums to
            :attr:`total`.

        Raises:
            SpectraError: If the edges do not increase strictly.
        """
        edges = band_edges(edges_nm)
        flux = np.histogram(self.line_wavelength_nm, bins=edges, weights=self.line_flux)[0]
        if len(self.wavelength_nm):
            flux = flux + integrate_bands(edges, self.wavelength_nm, self.density)
        return flux

    def restricted(self, low_nm: float, high_nm: float) -> "EmissionSpectrum":
        """The part between two wavelengths [nm], lines on either end included.

        Nothing is rescaled: ``restricted(lo, hi).total`` is the flux that lay between.

        Raises:
            SpectraError: If nothing is left.
        """
        if not low_nm <= high_nm:
            raise SpectraError(
                f"{self.name}: restricted to {low_nm:g} to {high_nm:g} nm; allowed: low <= high"
            )
        knots = self._knots_between(low_nm, high_nm)
        kept = (self.line_wavelength_nm >= low_nm) & (self.line_wavelength_nm <= high_nm)
        density = self.density_at(knots)
        if not (self.line_flux[kept].any() or density.any()):
            low, high = self.support_nm
            raise SpectraError(
                f"{self.name}: no light between {low_nm:g} and {high_nm:g} nm; "
                f"it emits between {low:g} and {high:g} nm"
            )
        return EmissionSpectrum(
            name=self.name,
            wavelength_nm=knots,
            density=density,
            line_wavelength_nm=self.line_wavelength_nm[kept],
            line_flux=self.line_flux[kept],
        )

    def _knots_between(self, low_nm: float, high_nm: float) -> FloatArray:
        """Knots of the density cut to an interval, its ends made knots; empty without overlap."""
        knots = self.wavelength_nm
        if not len(knots):
            return _nothing()
        low, high = max(low_nm, knots[0]), min(high_nm, knots[-1])
        if low >= high:
            return _nothing()
        return np.concatenate([[low], knots[(knots > low) & (knots < high)], [high]])
