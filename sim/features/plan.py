"""What a scene requires of the kernels: every feature on or off, and what that can cost.

Whatever is not known to be useless stays in. What cannot change a bit of the result is left out.
What can change it, within a bound, is left out while the bounds of all that is left out add up
to no more than the tolerance, the least first; any further omission is refused.
"""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import scenes
from sim.features.flags import Features
from sim.features.polarised import require_polarisation
from sim.features.registry import Feature, Subject, Verdict, registered
from sim.scene_media import collect_media
from sim.settings import ResolvedSettings
from spectra import Medium

__all__ = ["Decision", "FeaturePlan", "find_features", "judge_features", "plan_features"]


@dataclass(frozen=True)
class Decision:
    """A feature, on or off, and why.

    Attributes:
        feature: which one.
        on: whether kernels handle it.
        reason: why.
        bound: on the error that its omission causes, or would cause; see `Verdict.bound`.
        chosen: it is off at the user's word.
    """

    feature: Feature
    on: bool
    reason: str
    bound: float
    chosen: bool = False

    @property
    def is_approximate(self) -> bool:
        """Left out, on this module's own judgement, although it may change something."""
        return not self.on and not self.chosen and self.bound > 0.0


@dataclass(frozen=True)
class FeaturePlan:
    """What kernels are compiled for, feature by feature.

    Attributes:
        decisions: one a registered feature, in the order of their registration.
        tolerance: that the bounds of what is left out may add up to.
        media_count: how many media there are.
    """

    decisions: tuple[Decision, ...]
    tolerance: float
    media_count: int

    @property
    def bound(self) -> float:
        """The sum of the bounds of what is left out, except at the user's word."""
        return math.fsum(one.bound for one in self.decisions if one.is_approximate)

    @property
    def features(self) -> Features:
        """The flags of what is on."""
        flags: dict[str, Any] = {
            one.feature.flag: one.on for one in self.decisions if one.feature.flag
        }
        return Features(**flags, media_count=self.media_count)

    def complete(self, reason: str) -> "FeaturePlan":
        """The same with everything on, for this reason, but what the user has chosen."""
        decisions = tuple(
            one if one.on or one.chosen else dataclasses.replace(one, on=True, reason=reason)
            for one in self.decisions
        )
        return dataclasses.replace(self, decisions=decisions)

    def report(self) -> dict[str, Any]:
        """What pictures carry of it, ready for JSON."""
        off = {one.feature.name: one.bound for one in self.decisions if not one.on}
        return {
            "on": [one.feature.name for one in self.decisions if one.on],
            "off": off,
            "asked_for": [one.feature.name for one in self.decisions if one.chosen],
            "bound": self.bound,
            "tolerance": self.tolerance,
        }


def plan_features(scene: scenes.Scene, settings: ResolvedSettings) -> FeaturePlan:
    """What `scene` requires when it is rendered with `settings`."""
    made_of = collect_media(scene)
    return judge_features(
        Subject(
            scene, made_of.media, made_of.air_powers, settings.direct_light, settings.precision,
            settings.bounces, settings.polarisation,
        ),
        tolerance=settings.omission_tolerance,
        everything=settings.features == "all",
    )


def judge_features(
    subject: Subject, *, tolerance: float = 0.0, everything: bool = False
) -> FeaturePlan:
    """Decide on every registered feature.

    Args:
        subject: what they are judged by.
        tolerance: that the bounds of what is left out may add up to; 0 leaves out only what
            cannot change anything.
        everything: leave nothing out, except at the user's word.

    Raises:
        SettingsError: polarised light cannot be followed as the setting says.
    """
    require_polarisation(subject)
    verdicts = {feature.name: feature.judge(subject) for feature in registered()}
    allowed = _allowed(verdicts, tolerance)
    decisions = []
    for feature in registered():
        verdict = verdicts[feature.name]
        if verdict is None:
            decisions.append(Decision(feature, True, "not known to be useless", math.inf))
            continue
        on = not verdict.chosen and feature.name not in allowed
        reason = verdict.reason
        if on and tolerance > 0.0 and 0.0 < verdict.bound < 1.0:
            reason += "; leaving it out is refused: the bounds would pass the tolerance"
        decisions.append(Decision(feature, on, reason, verdict.bound, verdict.chosen))
    plan = FeaturePlan(tuple(decisions), tolerance, len(subject.media))
    return plan.complete('asked for by features = "all"') if everything else plan


def _allowed(verdicts: dict[str, Verdict | None], tolerance: float) -> set[str]:
    """Names of what may be left out: the least bounds first, while their sum is tolerated."""
    judged = [
        (verdict.bound, name)
        for name, verdict in verdicts.items()
        if verdict is not None and not verdict.chosen and 0.0 <= verdict.bound < 1.0
    ]
    allowed, bounds = set(), []
    for bound, name in sorted(judged):
        bounds.append(bound)
        if math.fsum(bounds) > tolerance:
            break
        allowed.add(name)
    return allowed


def find_features(
    scene: scenes.Scene,
    media: Sequence[Medium],
    air_powers: Sequence[int],
    *,
    polarisation: str = "auto",
) -> Features:
    """The flags of all that could change anything, with any settings but this one.

    Args:
        scene: the scene.
        media: its resolved media, the ambient one first.
        air_powers: of each medium, the power of the index of air that it is multiplied by.
        polarisation: the setting of this name.

    Raises:
        SettingsError: polarised light cannot be followed as the setting says.
    """
    subject = Subject(scene, tuple(media), tuple(air_powers), polarisation=polarisation)
    return judge_features(subject).features
