"""Named media: glasses, crystals and water, each with its source and valid range.

Names are resolved exactly or not at all: N-SF11 is not SF11, and an optician who asks for one must
not be served the other.

Coefficients are as published. Some papers print Cᵢ, others its square root; the constructor says
which (:class:`~spectra.dispersion.Sellmeier` or :meth:`~spectra.dispersion.Sellmeier.from_roots`).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from spectra.absorption import Absorption
from spectra.arrays import FloatOrArray
from spectra.dispersion import Dispersion, Sellmeier, require_in_range
from spectra.errors import SpectraError, UnknownGlass
from spectra.units import FRAUNHOFER_C_NM, FRAUNHOFER_D_NM, FRAUNHOFER_F_NM

__all__ = ["Medium", "glass", "glasses"]

# Where a medium is tried when it is made, so that a formula that fails does so then.
_CHECKED_POINTS = 65


@dataclass(frozen=True)
class Medium:
    """A transparent or coloured medium: its index and its absorption, and how both were measured.

    Attributes:
        name: What people call it.
        dispersion: Index as a function of wavelength.
        wavelength_range_nm: Lowest and highest valid wavelength [nm].
        source: Publication the coefficients come from.
        relative_to: What the index is relative to: the air it was measured in, or vacuum.
        absorption: What it takes of the light on its way; None: nothing, or nobody asks.
    """

    name: str
    dispersion: Dispersion
    wavelength_range_nm: tuple[float, float]
    source: str
    relative_to: Literal["air", "vacuum"]
    absorption: Absorption | None = None

    def __post_init__(self) -> None:
        """Check that the formula gives an index everywhere in the range."""
        low, high = self.wavelength_range_nm
        if not 0.0 <= low < high:
            raise SpectraError(
                f"{self.name}: wavelength range {low:g} to {high:g} nm; allowed: 0 <= low < high"
            )
        if self.relative_to not in {"air", "vacuum"}:
            raise SpectraError(
                f"{self.name}: relative to {self.relative_to!r}; allowed: 'air', 'vacuum'"
            )
        if not self.dispersion.is_dispersive:
            return  # A constant was checked by its formula, and is valid as far as it is said to.
        if math.isinf(high):
            raise SpectraError(f"{self.name}: wavelength range up to inf; allowed: a finite one")
        self._refuse_resonances()
        self.dispersion.eta(np.linspace(low, high, _CHECKED_POINTS))

    def _refuse_resonances(self) -> None:
        low, high = self.wavelength_range_nm
        poles = self.dispersion.resonances_nm if isinstance(self.dispersion, Sellmeier) else ()
        inside = [pole for pole in poles if low <= pole <= high]
        if inside:
            raise SpectraError(
                f"{self.name}: the formula has a resonance at {inside[0]:g} nm, "
                f"inside its wavelength range {low:g} to {high:g} nm"
            )

    @property
    def is_dispersive(self) -> bool:
        """Whether the index depends on the wavelength at all."""
        return self.dispersion.is_dispersive

    @property
    def is_tinted(self) -> bool:
        """Whether what it absorbs depends on the wavelength."""
        return self.absorption is not None and not self.absorption.is_constant

    def eta(self, wavelength_nm: FloatOrArray) -> FloatOrArray:
        """Refractive index, relative to what :attr:`relative_to` says.

        Args:
            wavelength_nm: Wavelength [nm], a number or an array of any shape.

        Returns:
            Refractive index, a float or a float64 array of the same shape.

        Raises:
            WavelengthOutOfRange: Outside :attr:`wavelength_range_nm`, and for NaN.
        """
        wavelengths = np.asarray(wavelength_nm, dtype=np.float64)
        require_in_range(wavelengths, self.name, self.wavelength_range_nm)
        return self.dispersion.eta(wavelength_nm)

    @property
    def n_d(self) -> float:
        """Index at the helium d line, 587.5618 nm.

        Raises:
            WavelengthOutOfRange: If the line is outside the valid range.
        """
        return self.eta(FRAUNHOFER_D_NM)

    @property
    def abbe_number(self) -> float:
        """Abbe number V_d = (n_d - 1) / (n_F - n_C) (Hecht 2017, §6.3.2); infinite if constant.

        Raises:
            WavelengthOutOfRange: If one of the three lines is outside the valid range.
        """
        dispersion = self.eta(FRAUNHOFER_F_NM) - self.eta(FRAUNHOFER_C_NM)
        return (self.n_d - 1.0) / dispersion if dispersion != 0.0 else math.inf


_SCHOTT = "Schott optical glass catalogue, through refractiveindex.info (CC0)"

# What each index is relative to. Minimum-deviation measurements are made with the prism in a
# room, and their authors report the ratio to the index of that air, unless they say otherwise:
# Schott's catalogue states it; so do Malitson's silica (1965) and fluorite (1963); Malitson and
# Dodge's sapphire and Peter's diamond print no correction to vacuum. Daimon and Masumura (2007)
# do correct, and print absolute indices: 1.33340 at d, where water against air is 1.3330.
_MEDIA = (
    Medium(
        name="N-BK7",
        dispersion=Sellmeier(
            b=(1.03961212, 0.231792344, 1.01046945),
            c_um2=(0.00600069867, 0.0200179144, 103.560653),
        ),
        wavelength_range_nm=(300.0, 2500.0),
        source=_SCHOTT,
        relative_to="air",
    ),
    Medium(
        name="SF11",
        dispersion=Sellmeier(
            b=(1.73848403, 0.311168974, 1.17490871),
            c_um2=(0.0136068604, 0.0615960463, 121.922711),
        ),
        wavelength_range_nm=(390.0, 2500.0),
        source=_SCHOTT,
        relative_to="air",
    ),
    Medium(
        name="N-SF11",
        dispersion=Sellmeier(
            b=(1.73759695, 0.313747346, 1.89878101),
            c_um2=(0.013188707, 0.0623068142, 155.23629),
        ),
        wavelength_range_nm=(370.0, 2500.0),
        source=_SCHOTT,
        relative_to="air",
    ),
    Medium(
        name="F2",
        dispersion=Sellmeier(
            b=(1.34533359, 0.209073176, 0.937357162),
            c_um2=(0.00997743871, 0.0470450767, 111.886764),
        ),
        wavelength_range_nm=(320.0, 2500.0),
        source=_SCHOTT,
        relative_to="air",
    ),
    Medium(
        name="fused silica",
        dispersion=Sellmeier.from_roots(
            b=(0.6961663, 0.4079426, 0.8974794),
            c_um=(0.0684043, 0.1162414, 9.896161),
        ),
        wavelength_range_nm=(210.0, 3710.0),
        source=(
            "Malitson, I. H. (1965), Interspecimen comparison of the refractive index of fused "
            "silica, J. Opt. Soc. Am. 55, 1205-1208; 20 °C"
        ),
        relative_to="air",
    ),
    Medium(
        name="CaF2",
        dispersion=Sellmeier.from_roots(
            b=(0.5675888, 0.4710914, 3.8484723),
            c_um=(0.050263605, 0.1003909, 34.649040),
        ),
        wavelength_range_nm=(230.0, 9700.0),
        source=(
            "Malitson, I. H. (1963), A redetermination of some optical properties of calcium "
            "fluoride, Applied Optics 2, 1103-1107; 24 °C"
        ),
        relative_to="air",
    ),
    Medium(
        name="sapphire",
        dispersion=Sellmeier.from_roots(
            b=(1.4313493, 0.65054713, 5.3414021),
            c_um=(0.0726631, 0.1193242, 18.028251),
        ),
        wavelength_range_nm=(200.0, 5000.0),
        source=(
            "Malitson, I. H. and Dodge, M. J. (1972), Refractive index and birefringence of "
            "synthetic sapphire, J. Opt. Soc. Am. 62, 1405; ordinary ray, 20 °C"
        ),
        relative_to="air",
    ),
    Medium(
        name="diamond",
        dispersion=Sellmeier.from_roots(b=(0.3306, 4.3356), c_um=(0.1750, 0.1060)),
        wavelength_range_nm=(226.0, 760.0),
        source=(
            "Peter, F. (1923), Über Brechungsindizes und Absorptionskonstanten des Diamanten "
            "zwischen 644 und 226 mµ, Zeitschrift für Physik 15, 358-368"
        ),
        relative_to="air",
    ),
    Medium(
        name="water",
        dispersion=Sellmeier(
            b=(0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688),
            c_um2=(0.005101829712, 0.01821153936, 0.02620722293, 10.69792721),
        ),
        wavelength_range_nm=(182.0, 1129.0),
        source=(
            "Daimon, M. and Masumura, A. (2007), Measurement of the refractive index of distilled "
            "water from the near-infrared region to the ultraviolet region, Applied Optics 46, "
            "3811-3820; 20 °C"
        ),
        relative_to="vacuum",
    ),
)

_BY_NAME: Mapping[str, Medium] = MappingProxyType({medium.name: medium for medium in _MEDIA})


def glass(name: str) -> Medium:
    """The medium of exactly this name.

    Raises:
        UnknownGlass: If there is none; the error lists the nearest names.
    """
    try:
        return _BY_NAME[name]
    except (KeyError, TypeError):
        raise UnknownGlass(name, _BY_NAME) from None


def glasses() -> tuple[str, ...]:
    """Names of all built-in media."""
    return tuple(_BY_NAME)
