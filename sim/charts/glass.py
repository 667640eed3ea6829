"""A medium in one figure: its index, what it reflects, and what a thickness of it lets through."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sim.analytic import brewster_angle, fresnel_reflectance
from sim.charts.curves import (
    draw_angles,
    draw_curve,
    plotted_range_nm,
    representative_nm,
    sampled_nm,
    style_axes,
)
from sim.charts.swatches import draw_swatches
from spectra.absorption import Absorption
from spectra.arrays import FloatArray
from spectra.colorimetry import tristimulus
from spectra.illuminants import cie_illuminant
from spectra.srgb import xyz_to_linear_srgb
from spectra.units import FRAUNHOFER_LINES_NM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from spectra import Medium

__all__ = ["colour_through", "plot_glass"]

_MULTIPLES, _WIDTHS_PT = (1.0, 10.0, 100.0), (3.5, 2.0, 1.0)
"""What is shown: these multiples of the thickness asked for, by lines of these widths."""

_MM_PER_M = 1000.0


def colour_through(absorption: Absorption, thickness_m: float) -> FloatArray:
    """Linear sRGB of daylight (D65) through a thickness, white without it; reflections left out.

    Light at wavelengths where the absorption is not known is left out of both.
    """
    daylight = cie_illuminant("D65").restricted(*absorption.wavelength_range_nm)
    through = tristimulus(daylight, share=lambda nm: absorption.transmittance(nm, thickness_m))
    return xyz_to_linear_srgb(through / tristimulus(daylight)[1])


def plot_glass(
    medium: Medium, absorption: Absorption | None = None, *, thickness_m: float = 0.01
) -> Figure:
    """Plot what is known of a medium.

    Args:
        medium: What to plot; its curves cover the part of the visible range where it is valid, or
            its whole range if no part is visible.
        absorption: Its absorption; None: it has none, or it is not known.
        thickness_m: What its internal transmittance is plotted of [m].

    Returns:
        The figure: index, reflectance by angle, and with an absorption the internal transmittance
        and the colours of thicknesses.
    """
    from matplotlib.figure import Figure

    rows = 1 if absorption is None else 2
    figure = Figure(figsize=(11.0, 4.2 * rows), dpi=150, layout="constrained")
    figure.suptitle(medium.name)
    grid = figure.add_gridspec(rows, 2)
    _draw_index(figure.add_subplot(grid[0, 0]), medium)
    _draw_reflectance(figure.add_subplot(grid[0, 1]), medium)
    if absorption is not None:
        _draw_transmittance(figure.add_subplot(grid[1, 0]), absorption, thickness_m)
        _draw_colours(figure.add_subplot(grid[1, 1]), absorption, thickness_m)
    return figure


def _draw_index(axes: Axes, medium: Medium) -> None:
    range_nm = plotted_range_nm(medium.wavelength_range_nm)
    wavelength_nm = sampled_nm(range_nm)
    draw_curve(axes, wavelength_nm, medium.eta(wavelength_nm))
    for line, line_nm in FRAUNHOFER_LINES_NM.items():
        if range_nm[0] <= line_nm <= range_nm[1]:
            axes.axvline(line_nm, color="0.8", linewidth=0.8, zorder=0)
            axes.annotate(
                f"$n_{line}$ = {medium.eta(line_nm):.5f}",
                (line_nm, medium.eta(line_nm)), xytext=(5.0, 9.0), textcoords="offset points",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
            )  # fmt: skip
    style_axes(axes, range_nm, f"refractive index, relative to {medium.relative_to}")


def _draw_reflectance(axes: Axes, medium: Medium) -> None:
    at_nm = representative_nm(plotted_range_nm(medium.wavelength_range_nm))
    eta = medium.eta(at_nm)
    draw_angles(axes, lambda cosine: fresnel_reflectance(cosine, 1.0, eta), at_nm)
    brewster_deg = math.degrees(brewster_angle(1.0, eta))
    axes.axvline(brewster_deg, color="0.8", linewidth=0.8, zorder=0)
    axes.annotate(f"Brewster {brewster_deg:.2f}°", (brewster_deg, 0.5), rotation=90.0, ha="right")


def _draw_transmittance(axes: Axes, absorption: Absorption, thickness_m: float) -> None:
    range_nm = plotted_range_nm(absorption.wavelength_range_nm)
    wavelength_nm = sampled_nm(range_nm)
    for multiple, width_pt in zip(_MULTIPLES, _WIDTHS_PT, strict=True):
        through = absorption.transmittance(wavelength_nm, multiple * thickness_m)
        draw_curve(axes, wavelength_nm, through, width_pt=width_pt)
        axes.plot([], [], color="0.5", linewidth=width_pt, label=_label(multiple * thickness_m))
    axes.legend(loc="lower right")
    style_axes(axes, range_nm, "internal transmittance")
    axes.set_ylim(0.0, 1.02)


def _draw_colours(axes: Axes, absorption: Absorption, thickness_m: float) -> None:
    thicknesses = [multiple * thickness_m for multiple in _MULTIPLES]
    draw_swatches(axes, {_label(one): colour_through(absorption, one) for one in thicknesses})
    axes.set_title("daylight (D65) through it, by gamut mapping", fontsize="medium")


def _label(thickness_m: float) -> str:
    if thickness_m < 1.0:
        return f"{thickness_m * _MM_PER_M:.4g} mm"
    return f"{thickness_m:.4g} m"
