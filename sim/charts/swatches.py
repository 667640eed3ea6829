"""Colours as patches, the ways of bringing them into a screen's gamut side by side."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from spectra.arrays import FloatArray
from spectra.srgb import GAMUT_METHODS, Gamut, encode_srgb, luminance, map_to_gamut

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "draw_swatches",
    "hex_code",
    "shown_colours",
    "to_full_brightness",
]

_DARK_TEXT_ABOVE = 0.2


def to_full_brightness(linear: npt.ArrayLike) -> FloatArray:
    """A light's linear sRGB, scaled so that its brightest channel is just full.

    What brightness a lamp has is for the exposure to say; its colour shows best like this.
    """
    colour = np.asarray(linear, dtype=np.float64)
    scaled: FloatArray = colour / colour.max()
    return scaled


def shown_colours(linear: npt.ArrayLike) -> dict[Gamut, npt.NDArray[np.uint8]]:
    """What a screen shows of linear sRGB, by gamut mapping: 8-bit codes, shape (3,)."""
    return {method: encode_srgb(map_to_gamut(linear, method)) for method in GAMUT_METHODS}


def hex_code(codes: npt.NDArray[np.uint8]) -> str:
    """An 8-bit colour as style sheets write it, "#ff9d00"."""
    return "#" + "".join(f"{code:02x}" for code in codes.tolist())


def draw_swatches(axes: Axes, colours: Mapping[str, npt.ArrayLike]) -> None:
    """Draw a row of patches for each gamut mapping, a column for each colour.

    Args:
        axes: Where; it is left without ticks.
        colours: Linear sRGB by what stands under the patch.
    """
    from matplotlib.patches import Rectangle

    for column, linear in enumerate(colours.values()):
        for row, (method, codes) in enumerate(shown_colours(linear).items()):
            colour = hex_code(codes)
            axes.add_patch(
                Rectangle((column, row), 1.0, 1.0, facecolor=colour, edgecolor="0.8")
            )
            bright = luminance(map_to_gamut(linear, method)) > _DARK_TEXT_ABOVE
            axes.annotate(
                colour, (column + 0.5, row + 0.5), ha="center", va="center",
                color="black" if bright else "white", fontsize="small",
            )  # fmt: skip
    axes.set_xlim(0.0, len(colours))
    axes.set_ylim(len(GAMUT_METHODS), 0.0)
    axes.set_xticks(np.arange(len(colours)) + 0.5, list(colours))
    rows = np.arange(len(GAMUT_METHODS)) + 0.5
    axes.set_yticks(rows, GAMUT_METHODS)
    axes.tick_params(length=0.0)
    axes.set_frame_on(False)
