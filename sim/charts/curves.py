"""Curves against wavelength, in the colours of the spectrum, and against the angle of incidence."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from spectra.arrays import FloatArray
from spectra.srgb import wavelength_to_srgb
from spectra.units import FRAUNHOFER_D_NM, VISIBLE_RANGE_NM

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "draw_angles",
    "draw_curve",
    "plotted_range_nm",
    "representative_nm",
    "sampled_nm",
    "style_axes",
]

_SAMPLES = 401


def plotted_range_nm(valid_nm: tuple[float, float]) -> tuple[float, float]:
    """The visible part of a range [nm], or all of it if no part is visible."""
    lowest_nm = max(valid_nm[0], VISIBLE_RANGE_NM[0])
    highest_nm = min(valid_nm[1], VISIBLE_RANGE_NM[1])
    return (lowest_nm, highest_nm) if lowest_nm < highest_nm else valid_nm


def representative_nm(range_nm: tuple[float, float]) -> float:
    """The wavelength that stands for a range: helium's d line, or the middle [nm]."""
    lowest_nm, highest_nm = range_nm
    is_inside = lowest_nm <= FRAUNHOFER_D_NM <= highest_nm
    return FRAUNHOFER_D_NM if is_inside else 0.5 * (lowest_nm + highest_nm)


def sampled_nm(range_nm: tuple[float, float]) -> FloatArray:
    """Wavelengths [nm] at which a curve over a range is drawn, its ends included."""
    return np.linspace(*range_nm, _SAMPLES)


def draw_curve(
    axes: Axes, wavelength_nm: FloatArray, values: FloatArray, *, width_pt: float = 3.0
) -> None:
    """Draw a curve, each piece in the colour of its wavelength.

    Args:
        axes: Where.
        wavelength_nm: Wavelengths [nm], increasing, shape (n,).
        values: What is drawn, shape (n,).
        width_pt: Width of the line [points].
    """
    from matplotlib.collections import LineCollection

    points = np.stack([wavelength_nm, values], axis=-1)
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    colours = wavelength_to_srgb(wavelength_nm[:-1])
    axes.add_collection(LineCollection(list(pieces), colors=colours, linewidths=width_pt))
    axes.autoscale_view()


def style_axes(axes: Axes, range_nm: tuple[float, float], label: str) -> None:
    """Give axes against wavelength their limits, labels and grid."""
    axes.set_xlim(*range_nm)
    axes.set_xlabel("wavelength [nm]")
    axes.set_ylabel(label)
    axes.grid(alpha=0.25)


def draw_angles(
    axes: Axes, reflectances: Callable[[FloatArray], tuple[FloatArray, FloatArray]], at_nm: float
) -> None:
    """Draw the reflectance of a surface against the angle of incidence: s, p and their mean.

    Args:
        axes: Where.
        reflectances: Rs and Rp for cosines of the angle of incidence, shape (n,) each.
        at_nm: The wavelength, for the title [nm].
    """
    theta_deg = np.linspace(0.0, 90.0, _SAMPLES)
    # Exactly 0 at 90°, which the cosine of π/2 is not.
    of_s, of_p = reflectances(np.sin(np.radians(90.0 - theta_deg)))
    axes.plot(theta_deg, 0.5 * (of_s + of_p), color="0.1", linewidth=2.0, label="unpolarised")
    axes.plot(theta_deg, of_s, color="0.5", linewidth=1.2, linestyle="dashed", label="s")
    axes.plot(theta_deg, of_p, color="0.5", linewidth=1.2, linestyle="dotted", label="p")
    axes.set_xlim(0.0, 90.0)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("angle of incidence [°]")
    axes.set_ylabel("reflectance")
    axes.grid(alpha=0.25)
    axes.set_title(f"at {at_nm:.4g} nm", fontsize="medium")
    axes.legend(loc="center left")
