"""The refractive index of a medium, plotted over the visible range."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from spectra.srgb import wavelength_to_srgb
from spectra.units import FRAUNHOFER_C_NM, FRAUNHOFER_D_NM, FRAUNHOFER_F_NM, VISIBLE_RANGE_NM

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from spectra import Medium

__all__ = ["plot_glass"]

_SAMPLES = 400
_LINES_NM = {"F": FRAUNHOFER_F_NM, "d": FRAUNHOFER_D_NM, "C": FRAUNHOFER_C_NM}


def plot_glass(medium: Medium) -> Figure:
    """Plot index against wavelength, in the colours of the spectrum.

    Args:
        medium: What to plot; its curve covers the part of the visible range where it is valid,
            or its whole range if no part is visible.

    Returns:
        The figure.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    lowest_nm, highest_nm = _plotted_range_nm(medium.wavelength_range_nm)
    wavelength_nm = np.linspace(lowest_nm, highest_nm, _SAMPLES)
    index = medium.eta(wavelength_nm)
    figure = Figure(figsize=(7.0, 4.5), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    points = np.stack([wavelength_nm, index], axis=-1)
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    colours = wavelength_to_srgb(wavelength_nm[:-1])
    axes.add_collection(LineCollection(list(pieces), colors=colours, linewidths=3.0))
    axes.autoscale_view()
    for line, line_nm in _LINES_NM.items():
        if lowest_nm <= line_nm <= highest_nm:
            axes.axvline(line_nm, color="0.8", linewidth=0.8, zorder=0)
            axes.annotate(
                f"$n_{line}$ = {medium.eta(line_nm):.5f}",
                (line_nm, medium.eta(line_nm)), xytext=(5.0, 9.0), textcoords="offset points",
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
            )  # fmt: skip
    axes.set_xlim(lowest_nm, highest_nm)
    axes.set_title(medium.name)
    axes.set_xlabel("wavelength [nm]")
    axes.set_ylabel(f"refractive index, relative to {medium.relative_to}")
    return figure


def _plotted_range_nm(valid_nm: tuple[float, float]) -> tuple[float, float]:
    lowest_nm = max(valid_nm[0], VISIBLE_RANGE_NM[0])
    highest_nm = min(valid_nm[1], VISIBLE_RANGE_NM[1])
    return (lowest_nm, highest_nm) if lowest_nm < highest_nm else valid_nm
