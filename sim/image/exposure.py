"""How bright a picture is developed: stops, and the automatic choice of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenes.emitters import Environment, Glowing
from spectra.observer import observer
from spectra.srgb import xyz_to_linear_srgb
from spectra.units import LUMINOUS_EFFICACY_LM_W

if TYPE_CHECKING:
    from scenes import Scene

__all__ = ["WHITE_QUANTILE", "automatic_stops", "lamp_level", "scene_stops"]

# This share of the lit pixels is developed without burning out in any channel.
WHITE_QUANTILE = 0.99


def scene_stops(scene: Scene) -> float | None:
    """The exposure that a scene asks for [stops], by number or as its camera is set; else None."""
    if scene.film.exposure_stops is not None:
        return float(scene.film.exposure_stops)
    white = scene.camera.white_luminance if scene.camera is not None else None
    return None if white is None else math.log2(LUMINOUS_EFFICACY_LM_W / white)


def lamp_level(scene: Scene) -> float:
    """Largest linear sRGB channel of the dimmest lamp that can be looked at; inf if none can.

    An environment is no lamp in this sense: it is what a picture of it shows.
    """
    seen = [
        one
        for one in scene.emitters
        if isinstance(one, Glowing) and one.visible and not isinstance(one, Environment)
    ]
    levels = [math.inf]
    edges_nm = scene.film.edges_nm
    for lamp in seen:
        spectrum = lamp.emission()
        density = spectrum.band_flux(edges_nm) / spectrum.total / np.diff(edges_nm)
        xyz = observer(scene.film.observer).xyz(lamp.full_radiance * density, edges_nm)
        levels.append(float(xyz_to_linear_srgb(xyz / LUMINOUS_EFFICACY_LM_W).max()))
    return min(level for level in levels if level > 0.0)


def automatic_stops(linear_rgb: NDArray[np.float64], lamp_level: float = math.inf) -> float:
    """Choose an exposure that shows nearly everything and burns out only the brightest spots.

    A pixel's level is its largest linear sRGB channel, not its luminance: a saturated blue is at
    its display limit when its luminance is 0.07, and exposing it for a luminance of 1 would wash
    every spectrum out to white. The exposure brings the `WHITE_QUANTILE` quantile of the levels
    of all lit pixels (level > 0) to 1. Pixels that show a lamp do not count, unless they are
    most of the picture: beside a lamp everything else is dark.

    Args:
        linear_rgb: Linear sRGB, shape (height, width, 3), any unit.
        lamp_level: From half of this level on a pixel shows a lamp, as far as one can tell.

    Returns:
        Stops e, such that ``linear_rgb * 2**e`` is the picture with white at 1; 0 for a picture
        that is black all over.
    """
    level = linear_rgb.max(axis=-1)
    lit = level[np.isfinite(level) & (level > 0.0)]
    if lit.size == 0:
        return 0.0
    lamps_apart = lit[lit < 0.5 * lamp_level]
    if 2 * lamps_apart.size >= lit.size:
        lit = lamps_apart
    return -math.log2(float(np.quantile(lit, WHITE_QUANTILE)))
