"""A light in one figure: its spectrum, its place among the colours, and how a screen shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from sim.charts.curves import draw_curve, style_axes
from sim.charts.swatches import draw_swatches, hex_code, to_full_brightness
from spectra.arrays import FloatArray
from spectra.colorimetry import chromaticity, tristimulus
from spectra.illuminants import blackbody
from spectra.observer import observer
from spectra.srgb import (
    GAMUT_METHODS,
    PRIMARIES_XY,
    encode_srgb,
    map_to_gamut,
    wavelength_to_srgb,
    xyz_to_linear_srgb,
)
from spectra.units import VISIBLE_RANGE_NM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from spectra import EmissionSpectrum

__all__ = ["plot_spectrum"]

_SAMPLES = 1001
_LOCUS_NM = (390.0, 700.0)
"""Beyond these the spectral locus turns back on itself."""
_GLARE = 8.0
"""How many times as bright as just fits a colour is shown, too."""
_PLANCKIAN_K = np.array([1000, 1500, 2000, 2500, 3000, 4000, 5000, 6500, 10_000, 20_000, 1e5])


def plot_spectrum(source: EmissionSpectrum) -> Figure:
    """Plot a light.

    Returns:
        The figure: relative flux by wavelength, chromaticity, the light's colour by each gamut
        mapping, and what these make of the colours of the rainbow.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 8.4), dpi=150, layout="constrained")
    figure.suptitle(source.name)
    grid = figure.add_gridspec(2, 2)
    xyz = tristimulus(source)
    _draw_flux(figure.add_subplot(grid[0, 0]), source)
    _draw_chromaticity(figure.add_subplot(grid[:, 1]), xyz)
    rows = grid[1, 0].subgridspec(2, 1)
    axes = figure.add_subplot(rows[0, 0])
    axes.set_title("gamut mapping, at full brightness and overexposed", fontsize="medium")
    colours = {"invisible": np.zeros(3)}
    if xyz.sum() > 0.0:
        full = to_full_brightness(xyz_to_linear_srgb(xyz))
        colours = {source.name: full, f"{_GLARE:g} times as bright": _GLARE * full}
    draw_swatches(axes, colours)
    _draw_rainbows(figure.add_subplot(rows[1, 0]))
    return figure


def _draw_flux(axes: Axes, source: EmissionSpectrum) -> None:
    """The density as a curve, and lines as sticks, each scaled to its highest."""
    lowest_nm, highest_nm = source.support_nm
    range_nm = min(lowest_nm - 1.0, VISIBLE_RANGE_NM[0]), max(highest_nm + 1.0, VISIBLE_RANGE_NM[1])
    if len(source.wavelength_nm):
        wavelength_nm = np.linspace(source.wavelength_nm[0], source.wavelength_nm[-1], _SAMPLES)
        draw_curve(axes, wavelength_nm, source.density_at(wavelength_nm) / source.density.max())
    if len(source.line_wavelength_nm):
        axes.vlines(
            source.line_wavelength_nm, 0.0, source.line_flux / source.line_flux.max(),
            colors=list(map(hex_code, _codes(source.line_wavelength_nm))), linewidths=2.0,
        )  # fmt: skip
    style_axes(axes, range_nm, "relative flux")
    axes.set_ylim(0.0, 1.05)


def _codes(wavelength_nm: FloatArray) -> npt.NDArray[np.uint8]:
    return np.rint(255.0 * wavelength_to_srgb(wavelength_nm)).astype(np.uint8)


def _draw_chromaticity(axes: Axes, xyz: FloatArray) -> None:
    """The CIE 1931 diagram: spectral locus, blackbodies, the gamut of sRGB, and the light."""
    eye = observer()
    shown = (eye.wavelength_nm >= _LOCUS_NM[0]) & (eye.wavelength_nm <= _LOCUS_NM[1])
    locus = chromaticity(eye.cmf[shown])
    draw_at = np.concatenate([locus, locus[:1]])
    axes.plot(*draw_at.T, color="0.4", linewidth=1.0)
    colours = wavelength_to_srgb(eye.wavelength_nm[shown])
    axes.scatter(locus[:, 0], locus[:, 1], c=colours, s=9.0, zorder=2)
    planckian = np.array([chromaticity(tristimulus(blackbody(float(t)))) for t in _PLANCKIAN_K])
    axes.plot(*planckian.T, color="0.4", linewidth=1.0, linestyle="dashed", label="blackbodies")
    corners = np.array([*PRIMARIES_XY, PRIMARIES_XY[0]])
    axes.plot(*corners.T, color="0.1", linewidth=1.0, label="gamut of sRGB")
    if xyz.sum() > 0.0:
        x, y = chromaticity(xyz)
        axes.plot(x, y, "o", markersize=9.0, markerfacecolor="none", markeredgecolor="black",
                  markeredgewidth=2.0, label=f"x = {x:.4f}, y = {y:.4f}")  # fmt: skip
    axes.set_aspect("equal")
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    axes.set_title("CIE 1931", fontsize="medium")
    axes.legend(loc="upper right")
    axes.grid(alpha=0.25)


def _draw_rainbows(axes: Axes) -> None:
    """Single wavelengths at the luminance of each one's full brightness, by gamut mapping."""
    wavelength_nm = np.linspace(*_LOCUS_NM, _SAMPLES)
    eye = observer()
    xyz = np.stack(
        [np.interp(wavelength_nm, eye.wavelength_nm, column) for column in eye.cmf.T], axis=-1
    )
    linear = xyz_to_linear_srgb(xyz)
    bright = linear / linear.max(axis=-1, keepdims=True)
    strips = [encode_srgb(map_to_gamut(bright, method)) for method in GAMUT_METHODS]
    axes.imshow(
        np.stack(strips), aspect="auto", interpolation="nearest",
        extent=(*_LOCUS_NM, len(GAMUT_METHODS) - 0.5, -0.5),
    )  # fmt: skip
    axes.set_yticks(range(len(GAMUT_METHODS)), GAMUT_METHODS)
    axes.set_xlabel("single wavelengths [nm]")
