"""From CIE XYZ to a picture: linear sRGB, gamut mapping, the 8-bit encoding.

Reference:
    IEC 61966-2-1:1999, "Multimedia systems and equipment - Colour measurement and management -
    Part 2-1: Default RGB colour space - sRGB".
"""

from typing import Final, Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

from spectra.arrays import FloatArray, read_only
from spectra.errors import SpectraError
from spectra.observer import observer
from spectra.piecewise import interpolate

__all__ = [
    "GAMUT_METHODS",
    "PRIMARIES_XY",
    "Gamut",
    "encode_srgb",
    "luminance",
    "map_to_gamut",
    "wavelength_to_srgb",
    "xyz_to_linear_srgb",
]

# IEC 61966-2-1, §5.2, as printed. Its inverse is computed, not the rounded one of the standard, so
# that luminance() of a converted colour is Y again to the last digits.
_LINEAR_SRGB_TO_XYZ = read_only(
    [
        [0.4124, 0.3576, 0.1805],
        [0.2126, 0.7152, 0.0722],
        [0.0193, 0.1192, 0.9505],
    ]
)
_XYZ_TO_LINEAR_SRGB = read_only(np.linalg.inv(_LINEAR_SRGB_TO_XYZ))

PRIMARIES_XY: Final = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06))
"""Chromaticities x, y of red, green and blue (IEC 61966-2-1, table 1)."""

Gamut: TypeAlias = Literal["desaturate", "clip", "preserve"]
"""How colours are brought into what sRGB can show, see `map_to_gamut`."""

GAMUT_METHODS: Final[tuple[Gamut, ...]] = get_args(Gamut)
"""The gamut mappings there are, the default one first."""

# How wavelength_to_srgb dims towards the ends of the visible, so that a drawing still shows there
# is a ray: full from 420 to 680 nm, down to a third at and beyond the ends.
_BRIGHTNESS_KNOTS_NM = read_only([380.0, 420.0, 680.0, 750.0])
_BRIGHTNESS = read_only([1.0 / 3.0, 1.0, 1.0, 1.0 / 3.0])

# Beyond these the CIE 1931 table is an extrapolation whose hue turns back; the ends keep theirs.
_HUE_RANGE_NM = (380.0, 700.0)


def xyz_to_linear_srgb(xyz: npt.ArrayLike) -> FloatArray:
    """Linear sRGB of XYZ values scaled so that white has Y = 1 (IEC 61966-2-1, §5.2).

    Args:
        xyz: Tristimulus values, shape (..., 3).

    Returns:
        Linear sRGB, shape (..., 3); negative, or above 1, for what is out of gamut.
    """
    linear: FloatArray = np.asarray(xyz, dtype=np.float64) @ _XYZ_TO_LINEAR_SRGB.T
    return linear


def luminance(linear_rgb: npt.ArrayLike) -> FloatArray:
    """Y of linear sRGB, 1 for white: 0.2126 R + 0.7152 G + 0.0722 B.

    Args:
        linear_rgb: Linear sRGB, shape (..., 3).

    Returns:
        Luminance, shape (...).
    """
    y: FloatArray = np.asarray(linear_rgb, dtype=np.float64) @ _LINEAR_SRGB_TO_XYZ[1]
    return y


def map_to_gamut(linear_rgb: npt.ArrayLike, method: Gamut = "desaturate") -> FloatArray:
    """Bring colours into what sRGB can show, 0 to 1 in each channel.

    "desaturate" moves a colour toward the grey of its own luminance, along a straight line in
    linear light, just until it fits: luminance is kept, and so is dominant wavelength. What is as
    bright as white or brighter becomes white. "clip" cuts each channel, which changes hue and
    luminance, but leaves colours alone that have nothing negative and are not too bright.
    "preserve" keeps the hue of bright colours at the cost of their luminance: it moves a colour
    toward the grey Y of its own luminance just until no channel is negative, C' = Y + s (C − Y)
    with s = min(1, min Y / (Y − C)), and then divides it by its largest channel if that is above
    1, which leaves its chromaticity as it is.

    Args:
        linear_rgb: Linear sRGB, shape (..., 3).
        method: "desaturate", "clip" or "preserve".

    Returns:
        Linear sRGB within 0 to 1, shape (..., 3); NaN where it was NaN.

    Raises:
        SpectraError: If there is no such method.
    """
    if method not in GAMUT_METHODS:
        allowed = ", ".join(map(repr, GAMUT_METHODS))
        raise SpectraError(f"unknown gamut mapping {method!r}; allowed: {allowed}")
    linear = np.asarray(linear_rgb, dtype=np.float64)
    if method == "clip":
        return _clip_to_unit(linear)
    if method == "preserve":
        shown = _desaturated(linear, ceiling=np.inf)
        return _clip_to_unit(shown / np.maximum(shown.max(axis=-1, keepdims=True), 1.0))
    return _clip_to_unit(_desaturated(linear, ceiling=1.0))  # Rounding may leave 1e-17 outside.


def _desaturated(linear: FloatArray, ceiling: float) -> FloatArray:
    """Colours moved toward the grey of their luminance, just until they fit 0 to `ceiling`."""
    grey = np.clip(luminance(linear), 0.0, ceiling)[..., np.newaxis]
    chroma = linear - grey
    # The share of its saturation that a channel leaves the colour: the room between the grey and
    # the wall it heads for, over the way it wants to go.
    room = np.where(chroma > 0.0, ceiling - grey, grey)
    reach = np.abs(chroma)
    share = np.divide(room, reach, out=np.ones_like(reach), where=reach > room)
    kept = share.min(axis=-1, keepdims=True)
    moved: FloatArray = grey + kept * chroma
    return moved


def encode_srgb(linear_rgb: npt.ArrayLike) -> npt.NDArray[np.uint8]:
    """8-bit sRGB (IEC 61966-2-1, §5.2): transfer curve, rounding to nearest; clipped to 0 to 1.

    Args:
        linear_rgb: Linear sRGB, any shape.

    Returns:
        Codes 0 to 255, same shape.

    Raises:
        SpectraError: If a value is NaN, which no colour stands for.
    """
    linear = np.asarray(linear_rgb, dtype=np.float64)
    undefined = int(np.count_nonzero(np.isnan(linear)))
    if undefined:
        raise SpectraError(f"{undefined} of {linear.size} colour values are NaN; allowed: numbers")
    return np.rint(255.0 * _transfer(_clip_to_unit(linear))).astype(np.uint8)


def wavelength_to_srgb(wavelength_nm: npt.ArrayLike) -> FloatArray:
    """A colour to draw a ray of this wavelength in: bright, in gamut, dimmer at the ends.

    This is for diagrams: the brightest channel is full and negative ones are cut, which looks
    purer than desaturating and is no colorimetry. Ultraviolet and infrared are drawn in the dimmed
    colours of the two ends.

    Args:
        wavelength_nm: Wavelength [nm], any shape; (n,) or a number.

    Returns:
        Encoded sRGB, 0 to 1, shape ``wavelength_nm.shape + (3,)``.
    """
    cie = observer()
    wavelengths = np.asarray(wavelength_nm, dtype=np.float64)
    nearest = np.clip(wavelengths, *_HUE_RANGE_NM)
    linear = xyz_to_linear_srgb(interpolate(nearest, cie.wavelength_nm, cie.cmf))
    bright = map_to_gamut(linear / linear.max(axis=-1, keepdims=True), "clip")
    brightness = np.interp(wavelengths, _BRIGHTNESS_KNOTS_NM, _BRIGHTNESS)
    return _transfer(bright * brightness[..., np.newaxis])


def _clip_to_unit(linear: FloatArray) -> FloatArray:
    clipped: FloatArray = np.clip(linear, 0.0, 1.0)
    return clipped


def _transfer(linear: FloatArray) -> FloatArray:
    """Linear 0 to 1 to encoded 0 to 1: the straight foot, then the 1/2.4 power."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
