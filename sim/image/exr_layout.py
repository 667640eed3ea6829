"""The spectral EXR layout: how channels are named, and which attributes a file has.

Fichet, Pacanowski and Wilkie (2021), "An OpenEXR Layout for Spectral Images", Journal of
Computer Graphics Techniques 10(3): emissive radiance is in channels ``S0.<wavelength><unit>``
with a decimal comma. Ours adds, in layers that spectral readers skip, the standard error of each
band and the luminance's noise and bias, and string attributes ``nephroid_…`` with all that it
takes to render the file again.
"""

from __future__ import annotations

import re
from typing import Final

from spectra.units import SPEED_OF_LIGHT_M_S

__all__ = [
    "ACCURACY_CHANNELS",
    "ATTRIBUTE_PREFIX",
    "BAND_MEANS",
    "EMISSIVE_UNITS",
    "IRRADIANCE_BAND_MEANS",
    "IRRADIANCE_UNITS",
    "LAYOUT_VERSION",
    "error_channel",
    "error_wavelength_nm",
    "radiance_channel",
    "radiance_wavelength_nm",
]

LAYOUT_VERSION: Final = "1.0"
EMISSIVE_UNITS: Final = "W.m^-2.sr^-1"
BAND_MEANS: Final = "band means, W m^-2 sr^-1 nm^-1"
IRRADIANCE_UNITS: Final = "W.m^-2.nm^-1"
IRRADIANCE_BAND_MEANS: Final = "band means of irradiance, W m^-2 nm^-1"
"""What files of sensors have in the place of `EMISSIVE_UNITS` and `BAND_MEANS`."""
ATTRIBUTE_PREFIX: Final = "nephroid_"
ACCURACY_CHANNELS: Final = {"noise": "luminance.noise", "bias": "luminance.bias"}
"""Channels of the luminance's standard error and of its estimated bias [cd/m²]."""

_ERROR_LAYER: Final = "standardError."
# The units that the layout's reference reader knows.
_WAVELENGTH: Final = re.compile(
    r"(?P<number>\d+(?:,\d*)?|,\d+)(?P<exponent>[Ee][+-]?\d+)?"
    r"(?P<prefix>Y|Z|E|P|T|G|M|k|h|da|d|c|m|u|n|p)?(?P<unit>m|Hz)"
)
_PREFIX_EXPONENT: Final = {
    "Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1,
    "": 0, "d": -1, "c": -2, "m": -3, "u": -6, "n": -9, "p": -12,
}  # fmt: skip


def radiance_channel(wavelength_nm: float) -> str:
    """Name of the channel of unpolarised radiance (Stokes component 0): ``S0.550,000000nm``."""
    return f"S0.{_wavelength_text(wavelength_nm)}"


def error_channel(wavelength_nm: float) -> str:
    """Name of the channel of the standard error: ``standardError.550,000000nm``."""
    return f"{_ERROR_LAYER}{_wavelength_text(wavelength_nm)}"


def radiance_wavelength_nm(channel: str) -> float | None:
    """Wavelength [nm] of a radiance channel, in any unit of the layout; None for all others."""
    return _parsed_nm(channel, "S0.")


def error_wavelength_nm(channel: str) -> float | None:
    """Wavelength [nm] of a standard error channel; None for all others."""
    return _parsed_nm(channel, _ERROR_LAYER)


def _wavelength_text(wavelength_nm: float) -> str:
    return f"{wavelength_nm:.6f}nm".replace(".", ",")


def _parsed_nm(channel: str, layer: str) -> float | None:
    match = _WAVELENGTH.fullmatch(channel.removeprefix(layer))
    if match is None or not channel.startswith(layer):
        return None
    text = match["number"].replace(",", ".") + (match["exponent"] or "")
    exponent = _PREFIX_EXPONENT[match["prefix"] or ""]
    if match["unit"] == "m":
        # One power of ten, from metres to nanometres at once: 550,0nm reads 550.0 exactly.
        return float(text) * 10.0 ** (exponent + 9)
    frequency_hz = float(text) * 10.0**exponent
    return SPEED_OF_LIGHT_M_S / frequency_hz * 1e9 if frequency_hz > 0.0 else None
