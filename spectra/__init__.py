"""Spectra: refractive indices, light sources and colour, as functions of wavelength.

Floor 0 of the project. NumPy alone is imported here; colour-science (for CIE tables) and SciPy
(for tabulated indices) are imported inside the functions that need them.

Conventions: wavelengths are nanometres (``wavelength_nm``) in air or in vacuum as each medium's
``relative_to`` says; everything else is SI.
"""

from spectra.absorption import Absorption
from spectra.absorption_tables import absorbing_media, published_absorption
from spectra.colorimetry import (
    ColourTemperature,
    chromaticity,
    colour_temperature,
    luminous_efficacy,
    tristimulus,
)
from spectra.conductors import Conductor, conductor, conductors
from spectra.dispersion import Cauchy, Dispersion, Sellmeier, Tabulated, air_index
from spectra.emission import EmissionSpectrum
from spectra.errors import (
    SpectraError,
    UnknownAbsorption,
    UnknownConductor,
    UnknownGlass,
    UnknownName,
    UnknownObserver,
    UnknownSpectrum,
    WavelengthOutOfRange,
)
from spectra.glasses import Medium, glass, glasses
from spectra.illuminants import (
    blackbody,
    cie_illuminant,
    laser,
    line_spectrum,
    spectrum,
    spectrum_names,
    table,
)
from spectra.observer import Observer, observer
from spectra.srgb import (
    encode_srgb,
    luminance,
    map_to_gamut,
    wavelength_to_srgb,
    xyz_to_linear_srgb,
)
from spectra.units import VISIBLE_RANGE_NM

__all__ = [
    "VISIBLE_RANGE_NM",
    "Absorption",
    "Cauchy",
    "ColourTemperature",
    "Conductor",
    "Dispersion",
    "EmissionSpectrum",
    "Medium",
    "Observer",
    "Sellmeier",
    "SpectraError",
    "Tabulated",
    "UnknownAbsorption",
    "UnknownConductor",
    "UnknownGlass",
    "UnknownName",
    "UnknownObserver",
    "UnknownSpectrum",
    "WavelengthOutOfRange",
    "absorbing_media",
    "air_index",
    "blackbody",
    "chromaticity",
    "cie_illuminant",
    "colour_temperature",
    "conductor",
    "conductors",
    "encode_srgb",
    "glass",
    "glasses",
    "laser",
    "line_spectrum",
    "luminance",
    "luminous_efficacy",
    "map_to_gamut",
    "observer",
    "published_absorption",
    "spectrum",
    "spectrum_names",
    "table",
    "tristimulus",
    "wavelength_to_srgb",
    "xyz_to_linear_srgb",
]
