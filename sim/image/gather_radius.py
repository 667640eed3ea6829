"""How wide the disc is that photons are gathered over.

The first pass's radius follows the pixels. It shrinks from pass to pass, so that bias and noise
vanish together.

Reference:
    Knaus & Zwicker (2011), "Progressive photon mapping: a probabilistic approach", ACM Trans.
    Graph. 30(3), eq. (15).
"""

import numpy as np

import scenes
from sim.errors import SettingsError
from sim.image.survey import Survey
from sim.scene_data import CompiledScene
from sim.settings import ResolvedSettings

__all__ = ["choose_radius", "gather_radius", "radius_shrinkage"]

FOOTPRINTS_A_RADIUS = 2.0
"""The first pass gathers over a disc this many pixel widths in radius."""


def choose_radius(compiled: CompiledScene, survey: Survey, plan: ResolvedSettings) -> float:
    """The first pass's gather radius: as it is asked for, or as the survey says [m].

    Raises:
        SettingsError: the scene's coordinates cannot resolve it, or the scene is smaller.
    """
    size = 2.0 * compiled.bounding_radius
    least = size * float(np.finfo(plan.precision).eps)
    endless = any(isinstance(one.shape, scenes.Plane) for one in compiled.scene.objects)
    most = np.inf if endless else size
    if plan.radius is None:
        radius = gather_radius(survey, unseen=_radius_unseen(compiled))
        return float(np.clip(radius, least, most))
    if not least <= plan.radius <= most:
        allowed = f"at least {least:.2g} m, which {plan.precision} resolves here"
        if not endless:
            allowed += f", at most {most:.3g} m, the scene's size"
        raise SettingsError("radius", plan.radius, allowed)
    return plan.radius


def gather_radius(survey: Survey, *, unseen: float | None = None) -> float:
    """The first pass's gather radius, from the median pixel's footprint [m].

    Args:
        survey: what the camera sees.
        unseen: the radius if it sees no diffuse surface, in a picture that can do without.

    Raises:
        SettingsError: no pixel sees a diffuse surface to measure it on, or all see what the
            camera stands on.
    """
    widths = survey.widths[survey.widths > 0.0]
    if len(widths) == 0:
        if unseen is not None:
            return unseen
        reason = "the camera stands on all that it sees"
        if len(survey.widths) == 0:
            reason = "the camera sees no diffuse surface"
        raise SettingsError("radius", None, f"a radius in metres, since {reason}")
    return FOOTPRINTS_A_RADIUS * float(np.median(widths))


def _radius_unseen(compiled: CompiledScene) -> float | None:
    """A radius for a picture of lamps alone, on which nothing depends as far as one can tell."""
    return 0.01 * compiled.bounding_radius if compiled.features.visible_lamps else None


def radius_shrinkage(pass_index: int, alpha: float) -> float:
    """Radius of a pass relative to the first one's (Knaus & Zwicker 2011, eq. 15)."""
    i = np.arange(1.0, pass_index + 1.0)
    return float(np.sqrt(np.prod((i + alpha) / (i + 1.0))))
