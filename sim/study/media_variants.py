"""A scene with its glasses described in another way, to price the description.

References:
    Cauchy, A.-L. (1836), "Mémoire sur la dispersion de la lumière": n = A + B/λ².
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

import scenes
from scenes.absorption import describe_absorption
from scenes.media import DescribedMedium
from spectra import Medium
from spectra.units import NM_PER_UM

__all__ = ["TABLE_STEP_NM", "with_cauchy_media", "with_tabulated_media", "without_absorption"]

TABLE_STEP_NM = 20.0
"""Between the knots of a table: catalogues of glass print about that many."""

_FIT_POINTS = 201

_Describe: TypeAlias = Callable[[Medium, float, float], DescribedMedium]


def with_cauchy_media(scene: scenes.Scene) -> scenes.Scene:
    """The scene with every glass replaced by a Cauchy formula of two terms.

    The terms are fitted over the film's range, by least squares of the index.
    """

    def fit(medium: Medium, low_nm: float, high_nm: float) -> scenes.CauchyMedium:
        wavelength_nm = np.linspace(low_nm, high_nm, _FIT_POINTS)
        terms = np.stack([np.ones(_FIT_POINTS), (NM_PER_UM / wavelength_nm) ** 2], axis=1)
        a = np.linalg.lstsq(terms, medium.eta(wavelength_nm), rcond=None)[0]
        return scenes.CauchyMedium(
            a=tuple(float(one) for one in a), range_nm=(low_nm, high_nm),
            source=f"two terms fitted to {medium.name}", relative_to=medium.relative_to,
        )

    return _rewrite(scene, fit)


def with_tabulated_media(scene: scenes.Scene) -> scenes.Scene:
    """The scene with every glass replaced by a table of its index, about every 20 nm."""

    def tabulate(medium: Medium, low_nm: float, high_nm: float) -> scenes.TableMedium:
        knots = max(2, round((high_nm - low_nm) / TABLE_STEP_NM) + 1)
        wavelength_nm = np.linspace(low_nm, high_nm, knots)
        return scenes.TableMedium(
            wavelength_nm=tuple(float(one) for one in wavelength_nm),
            eta=tuple(float(one) for one in medium.eta(wavelength_nm)),
            source=f"a table of {medium.name}", relative_to=medium.relative_to,
        )

    return _rewrite(scene, tabulate)


def without_absorption(scene: scenes.Scene) -> scenes.Scene:
    """The scene with every object's medium clear; the ambient one stays as it is."""

    def cleared(item: scenes.SceneObject) -> scenes.SceneObject:
        material = item.material
        if not isinstance(material, scenes.Dielectric) or material.resolved().absorption is None:
            return item
        medium = material.medium
        if isinstance(medium, DescribedMedium):
            medium = medium.model_copy(update={"absorption": None})
        clear = material.model_copy(update={"medium": medium, "absorption": None})
        return item.model_copy(update={"material": clear})

    objects = tuple(map(cleared, scene.objects))
    return scene if objects == scene.objects else scene.model_copy(update={"objects": objects})


def _rewrite(scene: scenes.Scene, describe: _Describe) -> scenes.Scene:
    """The scene with each dispersive medium described by `describe(medium, low_nm, high_nm)`."""
    low_nm, high_nm = (float(edge) for edge in scene.film.edges_nm[[0, -1]])

    def redescribed(item: scenes.SceneObject) -> scenes.SceneObject:
        if not isinstance(item.material, scenes.Dielectric):
            return item
        medium = item.material.resolved()
        if not medium.is_dispersive:
            return item
        absorbs = None if medium.absorption is None else describe_absorption(medium.absorption)
        described = {"medium": describe(medium, low_nm, high_nm), "absorption": absorbs}
        material = item.material.model_copy(update=described)
        return item.model_copy(update={"material": material})

    return scene.model_copy(update={"objects": tuple(map(redescribed, scene.objects))})
