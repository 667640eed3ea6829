"""The gather's radius: how wide a disc each pixel collects its photons over, pass by pass.

A pixel's disc is as many of its own widths wide, on what it sees, as `radius_pixels` says: what is
far away or aslant is gathered over a wide disc, what a lens shows enlarged over a narrow one. A
radius given in metres is the same everywhere.

From pass to pass it shrinks, r²ᵢ₊₁ = r²ᵢ (i + α)/(i + 1), so that bias and noise vanish together.

Reference:
    Knaus & Zwicker (2011), "Progressive photon mapping: a probabilistic approach", ACM Trans.
    Graph. 30(3), eq. (15).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import scenes
from sim.errors import SettingsError
from sim.image.survey import Survey
from sim.scene_data import CompiledScene
from sim.settings import ResolvedSettings

__all__ = ["GatherRadius", "choose_gather_radius", "radius_shrinkage"]

FloatArray = npt.NDArray[np.float64]

NARROWEST, WIDEST = 0.5, 2.0
"""Limits of a pixel's radius, in the median one's: a disc at a focus, where pixels have no width,
would find no photon, and one on a wall seen aslant would find them all."""


@dataclass(frozen=True, eq=False)
class GatherRadius:
    """Radii of the first pass.

    Attributes:
        median: of the pixels [m].
        scale: (height, width) each pixel's radius in the median one's.
    """

    median: float
    scale: npt.NDArray[np.float32]

    def of_pass(self, pass_index: int, alpha: float) -> float:
        """The median pixel's radius in a pass [m]."""
        return self.median * radius_shrinkage(pass_index, alpha)


def radius_shrinkage(pass_index: int, alpha: float) -> float:
    """Radius of a pass relative to the first one's (Knaus & Zwicker 2011, eq. 15)."""
    i = np.arange(1.0, pass_index + 1.0)
    return float(np.sqrt(np.prod((i + alpha) / (i + 1.0))))


def choose_gather_radius(
    compiled: CompiledScene, survey: Survey, film: scenes.Film, plan: ResolvedSettings
) -> GatherRadius:
    """The radius that was asked for, or each pixel's own.

    Args:
        compiled: the scene.
        survey: what the camera sees.
        film: how many pixels there are.
        plan: with the radius in metres, or in pixels.

    Raises:
        SettingsError: the scene's coordinates cannot resolve the radius that was asked for, or the
            scene is smaller; or there is nothing to measure one on.
    """
    size = 2.0 * compiled.bounding_radius
    least = size * float(np.finfo(plan.precision).eps)
    endless = any(isinstance(one.shape, scenes.Plane) for one in compiled.scene.objects)
    most = np.inf if endless else size
    scale = np.ones((film.height, film.width), dtype=np.float32)
    if plan.radius is not None:
        if not least <= plan.radius <= most:
            allowed = f"at least {least:.2g} m, which {plan.precision} resolves here"
            if not endless:
                allowed += f", at most {most:.3g} m, the scene's size"
            raise SettingsError("radius", plan.radius, allowed)
        return GatherRadius(plan.radius, scale)
    widths = survey.widths[survey.widths > 0.0]
    if len(widths) == 0:
        return GatherRadius(_radius_unseen(compiled, survey), scale)
    median = float(np.median(widths))
    relative = np.clip(survey.width_grid / median, NARROWEST, WIDEST)
    assert plan.radius_pixels is not None  # a resolved plan has one of the two
    radius = float(np.clip(plan.radius_pixels * median, least, most))
    return GatherRadius(radius, _of_pixels(relative, film))


def _radius_unseen(compiled: CompiledScene, survey: Survey) -> float:
    """A radius for a picture of lamps alone, on which nothing depends as far as one can tell [m].

    Raises:
        SettingsError: there are no lamps to see.
    """
    if compiled.features.visible_lamps:
        return 0.01 * compiled.bounding_radius
    reason = "the camera stands on all that it sees"
    if len(survey.widths) == 0:
        reason = "the camera sees no diffuse surface"
    raise SettingsError("radius", None, f"a radius in metres, since {reason}")


def _of_pixels(relative: FloatArray, film: scenes.Film) -> npt.NDArray[np.float32]:
    """(height, width) from the survey's grid, NaN where it saw no diffuse surface.

    The median of neighbours leaves out samples that fell on an edge of glass or on what it
    reflects; between samples, logarithms are interpolated.
    """
    from scipy.ndimage import map_coordinates

    padded = np.pad(relative, 1, constant_values=np.nan)
    rows, columns = relative.shape
    around = np.stack(
        [padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3)]
    )
    seen = np.any(np.isfinite(around), axis=0)
    smooth = np.ones_like(relative)
    smooth[seen] = np.nanmedian(around[:, seen], axis=0)
    y = (np.arange(film.height) + 0.5) * rows / film.height - 0.5
    x = (np.arange(film.width) + 0.5) * columns / film.width - 0.5
    places = np.meshgrid(y, x, indexing="ij")
    between = map_coordinates(np.log(smooth), places, order=1, mode="nearest")
    scale: npt.NDArray[np.float32] = np.exp(between).astype(np.float32)
    return scale
