"""A metal in one figure: its complex index, what it reflects, and in what colour."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.analytic_conductor import conductor_reflectance
from sim.charts.curves import (
    draw_angles,
    draw_curve,
    plotted_range_nm,
    representative_nm,
    sampled_nm,
    style_axes,
)
from sim.charts.swatches import draw_swatches
from spectra.arrays import FloatArray
from spectra.colorimetry import tristimulus
from spectra.illuminants import cie_illuminant
from spectra.srgb import xyz_to_linear_srgb

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from spectra import Conductor

__all__ = ["normal_reflectance", "plot_metal", "reflected_colour"]


def normal_reflectance(metal: Conductor, wavelength_nm: FloatArray) -> FloatArray:
    """Reflectance at normal incidence from vacuum, same shape as the wavelengths [nm]."""
    return conductor_reflectance(1.0, 1.0, metal.eta(wavelength_nm), metal.k(wavelength_nm))[0]


def reflected_colour(metal: Conductor) -> FloatArray:
    """Linear sRGB of daylight (D65) that the metal reflects at normal incidence; D65 is white."""
    daylight = cie_illuminant("D65").restricted(*metal.wavelength_range_nm)
    reflected = tristimulus(daylight, share=lambda nm: normal_reflectance(metal, nm))
    return xyz_to_linear_srgb(reflected / tristimulus(daylight)[1])


def plot_metal(metal: Conductor) -> Figure:
    """Plot what is known of a metal, over the visible part of its range.

    Returns:
        The figure: complex index, reflectance by wavelength and by angle, and its colour.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 8.4), dpi=150, layout="constrained")
    figure.suptitle(metal.name)
    grid = figure.add_gridspec(2, 2)
    range_nm = plotted_range_nm(metal.wavelength_range_nm)
    _draw_index(figure.add_subplot(grid[0, 0]), metal, range_nm)
    axes = figure.add_subplot(grid[0, 1])
    wavelength_nm = sampled_nm(range_nm)
    draw_curve(axes, wavelength_nm, normal_reflectance(metal, wavelength_nm))
    style_axes(axes, range_nm, "reflectance at normal incidence")
    axes.set_ylim(0.0, 1.0)
    at_nm = representative_nm(range_nm)
    axes = figure.add_subplot(grid[1, 0])
    eta, k = metal.eta(at_nm), metal.k(at_nm)
    draw_angles(axes, lambda cosine: conductor_reflectance(cosine, 1.0, eta, k), at_nm)
    axes = figure.add_subplot(grid[1, 1])
    draw_swatches(axes, {"daylight (D65) that it reflects": reflected_colour(metal)})
    axes.set_title("by gamut mapping", fontsize="medium")
    return figure


def _draw_index(axes: Axes, metal: Conductor, range_nm: tuple[float, float]) -> None:
    wavelength_nm = sampled_nm(range_nm)
    for name, values, width_pt in (
        ("n", metal.eta(wavelength_nm), 3.0), ("k", metal.k(wavelength_nm), 1.5)
    ):  # fmt: skip
        draw_curve(axes, wavelength_nm, values, width_pt=width_pt)
        axes.annotate(f"${name}$", (wavelength_nm[-1], values[-1]), xytext=(3.0, 0.0),
                      textcoords="offset points", va="center", annotation_clip=False)  # fmt: skip
    style_axes(axes, range_nm, "complex index $n + ik$")
    axes.set_ylim(bottom=0.0)
