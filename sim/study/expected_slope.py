"""How fast the error of bins can fall: what theory says of a lamp's light.

A bin is an indicator: a path counts in it or does not. Of n scrambled low-discrepancy points in d
dimensions, those in elementary cells that the indicator's boundary cuts are the ones that err,
about n^(1 - 1/d) of them by 1/n each, so the error is of the order

    n^(-1/2 - 1/(2d)):   d = 2: -0.75   d = 3: -0.667   d = 4: -0.625   d = 5: -0.6

Axes that no boundary depends on do not count (He and Wang's irregular dimension). It is where
slopes end, for bins that hold many points: where the boundary hardly depends on an axis, as on the
place within a small lamp, errors fall as without it until cells are as small as what it moves.

A lamp's paths are drawn from two numbers of direction and two of place, of which a point, or a
beam without divergence, has but one pair, and from one of wavelength, where the spectrum is
continuous and a glass disperses it.

References:
    He & Wang (2015), "On the convergence rate of randomized quasi-Monte Carlo for discontinuous
    functions", SIAM J. Numer. Anal. 53, 2488: the rate for indicators, and axes parallel to their
    boundary.
    He & Owen (2016), "Extensible grids: uniform sampling on a space filling curve", J. R. Stat.
    Soc. B 78, 917: mean square error O(n^(-1 - 1/d)) for piecewise smooth functions.
"""

from __future__ import annotations

import scenes
from scenes.emitters import AnyEmitter

__all__ = ["expected_slope", "sampled_dimensions"]

PAIR = 2
"""Numbers that stand for a direction, or for a place on a lamp."""


def expected_slope(dimensions: int) -> float:
    """Exponent of the error of bins over the number of points, -1/2 - 1/(2d).

    Args:
        dimensions: d, 1 or more.
    """
    return -0.5 - 0.5 / dimensions


def sampled_dimensions(scene: scenes.Scene, emitter: str) -> int:
    """Of how many numbers it depends where, and in which band, a lamp's light lands.

    Args:
        scene: with the film's range of wavelengths.
        emitter: name of the lamp.
    """
    lamp = next(one for one in scene.emitters if one.name == emitter)
    return _of_lines(lamp) + _of_wavelength(scene, lamp)


def _of_lines(lamp: AnyEmitter) -> int:
    """Dimensions of the lines along which a lamp's light leaves."""
    if isinstance(lamp, scenes.Point | scenes.Spot):
        return PAIR
    if isinstance(lamp, scenes.Beam) and lamp.divergence_deg == 0.0:
        return PAIR
    return PAIR + PAIR


def _of_wavelength(scene: scenes.Scene, lamp: AnyEmitter) -> int:
    """1 where paths depend on a continuous wavelength, else 0.

    The number that chooses among lines does so in steps, and without dispersion only the band
    depends on it: both are boundaries parallel to every other axis.
    """
    spectrum = lamp.emission().restricted(*(float(edge) for edge in scene.film.edges_nm[[0, -1]]))
    disperses = any(
        item.material.resolved().is_dispersive
        for item in scene.objects
        if isinstance(item.material, scenes.Dielectric)
    )
    return int(disperses and bool((spectrum.density > 0.0).any()))
