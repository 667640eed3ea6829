"""How far a result is from its reference, in the measures that a study plots.

References:
    CIE 142:2001, "Improvement to industrial colour-difference evaluation" (CIEDE2000), as
    colour-science computes it.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sim.analytic import angle_between
from sim.errors import SettingsError
from sim.photons.energy import EnergyBooks
from spectra.colour_science import import_colour_science
from spectra.srgb import Gamut, map_to_gamut, xyz_to_linear_srgb

__all__ = [
    "ARCSECONDS",
    "ColourDifference",
    "centroid_error",
    "ciede2000",
    "energy_residual",
    "relative_l2",
    "tempered_error",
]

FloatArray = npt.NDArray[np.float64]

ARCSECONDS = 3600.0 * 180.0 / np.pi
"""Arc-seconds in a radian."""


class ColourDifference(NamedTuple):
    """ΔE₀₀ over the pixels of a picture; about 1 is just noticeable."""

    mean: float
    p95: float  # 95% of the pixels are nearer


def relative_l2(estimate: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """‖estimate − reference‖₂ / ‖reference‖₂ over all bins and bands.

    Args:
        estimate: bin-integrated spectral irradiance, or anything else, any shape.
        reference: same shape and unit, not all zero.

    Raises:
        SettingsError: the shapes differ, or the reference is dark.
    """
    estimated, expected = _alike(estimate, reference)
    norm = float(np.linalg.norm(expected))
    if norm == 0.0:
        raise SettingsError("reference", "all zero", "some light")
    return float(np.linalg.norm(estimated - expected)) / norm


def tempered_error(estimate: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """Root mean square of error / (reference + its mean), as `Accuracy` counts errors of pictures.

    Args:
        estimate: luminance of the pixels, any shape.
        reference: same shape and unit, not all zero.

    Raises:
        SettingsError: the shapes differ, or the reference is dark.
    """
    estimated, expected = _alike(estimate, reference)
    mean = float(np.mean(expected))
    if mean == 0.0:
        raise SettingsError("reference", "all zero", "some light")
    return float(np.sqrt(np.mean(((estimated - expected) / (expected + mean)) ** 2)))


def ciede2000(
    linear_rgb: npt.ArrayLike,
    reference: npt.ArrayLike,
    *,
    exposure_stops: float,
    gamut: Gamut = "desaturate",
) -> ColourDifference:
    """CIEDE2000 between two pictures, each developed at the same exposure.

    Colours are compared as they are shown: exposed and mapped into the sRGB gamut, before they
    are rounded to 8 bits. White is that of sRGB.

    Args:
        linear_rgb: linear sRGB as of `Picture.linear_rgb`, (height, width, 3).
        reference: same shape and unit.
        exposure_stops: both are multiplied by 2 to this power.
        gamut: how colours outside the gamut enter it.

    Raises:
        SettingsError: the shapes differ.
    """
    colour = import_colour_science()
    pictures = _alike(linear_rgb, reference)
    to_xyz = np.linalg.inv(xyz_to_linear_srgb(np.eye(3)))
    white = colour.XYZ_to_xy(np.ones(3) @ to_xyz)
    shown = [map_to_gamut(one * 2.0**exposure_stops, gamut) @ to_xyz for one in pictures]
    difference = colour.delta_E(
        *(colour.XYZ_to_Lab(xyz, white) for xyz in shown), method="CIE 2000"
    )
    return ColourDifference(float(np.mean(difference)), float(np.percentile(difference, 95.0)))


def centroid_error(
    estimate: npt.ArrayLike,
    reference: npt.ArrayLike,
    bin_centres: npt.ArrayLike,
    seen_from: npt.ArrayLike,
) -> FloatArray:
    """Angle between where a band's light is and where it should be [arc-seconds], (bands,).

    Args:
        estimate: (rows, columns, bands) irradiance.
        reference: same shape and unit.
        bin_centres: (rows, columns, 3) where the bins are [m].
        seen_from: (3,) where the light comes from, such as the last face of a prism [m].

    Returns:
        Angles between the directions to both centroids; NaN for a band without light.

    Raises:
        SettingsError: the shapes differ.
    """
    origin = np.asarray(seen_from, dtype=np.float64)
    found, expected = (
        _centroids(one, np.asarray(bin_centres)) - origin for one in _alike(estimate, reference)
    )
    angle: FloatArray = ARCSECONDS * angle_between(found, expected)
    return angle


def energy_residual(books: EnergyBooks) -> float:
    """Share of the emitted flux that the energy books do not account for, 0 or more."""
    return abs(books.residual)


def _centroids(irradiance: FloatArray, bin_centres: FloatArray) -> FloatArray:
    """(bands, 3) mean positions of the light; NaN without light."""
    flux = irradiance.sum(axis=(0, 1))
    moment = np.einsum("ijb,ijx->bx", irradiance, bin_centres)
    dark = np.full_like(moment, np.nan)
    centroids: FloatArray = np.divide(moment, flux[:, None], out=dark, where=flux[:, None] > 0.0)
    return centroids


def _alike(estimate: npt.ArrayLike, reference: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Both as float64, once their shapes agree."""
    one = np.asarray(estimate, dtype=np.float64)
    other = np.asarray(reference, dtype=np.float64)
    if one.shape != other.shape:
        raise SettingsError("estimate", f"shape {one.shape}", f"the reference's, {other.shape}")
    return one, other
