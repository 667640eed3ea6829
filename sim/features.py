"""What a scene requires: the set of features that its kernels are compiled with.

Kernels are compiled for exactly this set. A feature that cannot change the result of a scene is
left out of its code; whatever is not known to be useless stays in.
"""

from dataclasses import dataclass

import scenes
from sim.method import DEFAULT_METHOD, Method
from spectra import Cauchy, Medium, Sellmeier, Tabulated

__all__ = ["Features", "find_features"]


@dataclass(frozen=True)
class Features:
    """Flags that shape the compiled code; hashable, since kernels are cached by them.

    Attributes:
        spheres, flats, polyhedra, lenses: which shapes a ray can meet.
        sellmeier, cauchy, tabulated: which dispersion formulas the media use.
        air_conversion: some index is converted between "relative to air" and "to vacuum".
        media_count: how many media there are, the ambient one among them.
        method: how light is followed.
    """

    spheres: bool
    flats: bool
    polyhedra: bool
    lenses: bool
    sellmeier: bool
    cauchy: bool
    tabulated: bool
    air_conversion: bool
    media_count: int
    method: Method = DEFAULT_METHOD


def find_features(
    scene: scenes.Scene,
    media: list[Medium],
    air_powers: list[int],
    *,
    method: Method = DEFAULT_METHOD,
) -> Features:
    """Derive the feature set of `scene` with its resolved `media` and their air conversions."""
    shapes = [item.shape for item in scene.objects]
    formulas = [medium.dispersion for medium in media]

    def any_shape(*kinds: type) -> bool:
        return any(isinstance(shape, kinds) for shape in shapes)

    def any_formula(kind: type) -> bool:
        return any(isinstance(formula, kind) for formula in formulas)

    return Features(
        spheres=any_shape(scenes.Sphere),
        flats=any_shape(scenes.Rectangle, scenes.Disk, scenes.Plane),
        polyhedra=any_shape(scenes.Box, scenes.Prism, scenes.Polyhedron),
        lenses=any_shape(scenes.Lens),
        sellmeier=any_formula(Sellmeier),
        cauchy=any_formula(Cauchy),
        tabulated=any_formula(Tabulated),
        air_conversion=any(air_powers),
        media_count=len(media),
        method=method,
    )
