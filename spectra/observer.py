"""Colour matching functions: from spectral radiance to CIE XYZ."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from spectra.arrays import FloatArray
from spectra.errors import SpectraError, UnknownObserver
from spectra.piecewise import band_edges, integrate_bands
from spectra.tabulated import observer_tables
from spectra.units import LUMINOUS_EFFICACY_LM_W

__all__ = ["Observer", "observer"]


@dataclass(frozen=True, eq=False)
class Observer:
    """A standard observer.

    Attributes:
        name: What the CIE calls it, in short.
        wavelength_nm: Wavelengths of the table [nm], shape (n,).
        cmf: x̄, ȳ, z̄ at each, linear in between and 0 outside, shape (n, 3).
    """

    name: str
    wavelength_nm: FloatArray
    cmf: FloatArray

    def band_response(self, edges_nm: npt.ArrayLike) -> FloatArray:
        """∫ x̄, ȳ, z̄ dλ over each band, exact for the linear interpolant.

        Args:
            edges_nm: Band edges [nm], strictly increasing, shape (bands + 1,).

        Returns:
            Integrals [nm], shape (bands, 3).

        Raises:
            SpectraError: If the edges do not increase strictly.
        """
        return integrate_bands(band_edges(edges_nm), self.wavelength_nm, self.cmf)

    def xyz(self, spectral_radiance: npt.ArrayLike, edges_nm: npt.ArrayLike) -> FloatArray:
        """Tristimulus values (CIE 015:2018, §7.1, with K_m in place of the free constant).

        The functions are integrated over each band, not sampled at its centre, so that light
        constant over each band is seen exactly.

        Args:
            spectral_radiance: Band means [W m⁻² sr⁻¹ nm⁻¹], shape (..., bands).
            edges_nm: Band edges [nm], strictly increasing, shape (bands + 1,).

        Returns:
            X, Y, Z, shape (..., 3); Y is luminance [cd/m²].

        Raises:
            SpectraError: If the edges do not increase strictly or their number does not fit.
        """
        radiance = np.asarray(spectral_radiance, dtype=np.float64)
        response = self.band_response(edges_nm)
        if radiance.shape[-1:] != response.shape[:1]:
            raise SpectraError(
                f"spectral radiance of shape {radiance.shape} over {len(response)} bands; "
                f"allowed: (..., {len(response)})"
            )
        xyz: FloatArray = LUMINOUS_EFFICACY_LM_W * (radiance @ response)
        return xyz


@cache
def observer(name: str = "CIE 1931 2 degree") -> Observer:
    """The standard observer of exactly this name.

    Args:
        name: "CIE 1931 2 degree" or "CIE 2015 2 degree".

    Raises:
        UnknownObserver: If there is none; lists the nearest.
    """
    tables = observer_tables()
    if name not in tables:
        raise UnknownObserver(name, tables)
    rows = tables[name]
    return Observer(name=name, wavelength_nm=rows[:, 0], cmf=rows[:, 1:])
