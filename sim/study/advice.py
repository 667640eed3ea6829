"""What to do about it: sentences that follow from the numbers."""

from __future__ import annotations

from sim.study.expected_slope import expected_slope
from sim.study.findings import Effect, bias_shows_from, effects, saving, slopes
from sim.study.outcome import AMOUNTS, Outcome
from sim.study.setup import ResultKind
from sim.study.statistics import Interval

__all__ = ["advise"]

_NAMES: dict[ResultKind, str] = {"bins": "irradiance on the receiver", "picture": "picture"}
_SAVES = 0.95
"""A value saves time if it takes less than this part of the centre's."""


def advise(outcome: Outcome, result: ResultKind) -> list[str]:
    """Sentences for a result, the most useful first."""
    found = effects(outcome, result)
    return [
        *_first_turn(outcome, result),
        *_verdicts(found),
        *_without_saving(found),
        *_biased(found, outcome.centre(result).errors.bias),
        *_limits(outcome, result),
    ]


def _first_turn(outcome: Outcome, result: ResultKind) -> list[str]:
    """Photons or passes?"""
    by_name = {(one.row.axis, one.row.value): one for one in effects(outcome, result)}
    photons, passes = by_name.get(("photons", "×4")), by_name.get(("passes", "×2"))
    if photons is None or passes is None:
        return []
    gains = {"photons in a pass": photons, "passes": passes}
    said = [
        f"{'4' if name[1] == 'h' else '2'} times the {name} take {one.time:.3g} times the time and "
        f"leave {one.error:.3g} of the error"
        for name, one in gains.items()
    ]
    first = min(gains, key=lambda name: gains[name].ratio.value)
    return [
        f"For the {_NAMES[result]}, turn up {first} first: " + "; ".join(said) + "."
    ]


def _verdicts(found: list[Effect]) -> list[str]:
    """What is clearly worth it, and what clearly is not."""
    choices = [one for one in found if one.row.axis not in AMOUNTS]
    better = [one for one in choices if one.ratio.high < 1.0]
    worse = [one for one in choices if one.ratio.low > 1.0]
    alike = [one for one in choices if one.ratio.low <= 1.0 <= one.ratio.high]
    said = []
    if better:
        said.append(
            "Worth trying, since less time gives the same error: "
            + ", ".join(f"{one.row.name} ({one.ratio.value:.2g} of it)" for one in _by(better))
            + "."
        )
    if worse:
        said.append(
            "Dearer than the centre, in photons for the same error at equal time: "
            + ", ".join(
                f"{one.row.name} ({one.ratio.value:.2g}×)" for one in reversed(_by(worse))
            ) + "."
        )
    if alike:
        said.append(
            "No difference shows for: " + ", ".join(one.row.name for one in _by(alike)) + "."
        )
    return said


def _without_saving(found: list[Effect]) -> list[str]:
    """What costs accuracy and saves no time."""
    bad = [
        one for one in found
        if one.row.axis not in AMOUNTS and one.time > _SAVES and one.ratio.low > 1.0
    ]
    names = ", ".join(one.row.name for one in _by(bad))
    return [f"Cost accuracy without saving time: {names}."] if bad else []


def _biased(found: list[Effect], own: Interval) -> list[str]:
    """What is further off than the centre, however long it runs."""
    biased = [one for one in found if one.row.errors.bias.low > own.high]
    names = ", ".join(f"{one.row.name} ({one.row.errors.bias.value:.2g})" for one in biased)
    said = [f"More biased than the centre, which no time takes away: {names}."] if biased else []
    if own.low > 0.0:
        said.append(
            f"The centre itself is off by a bias of {own.value:.2g} [{own.low:.2g}, "
            f"{own.high:.2g}]: where that is most of the error, a smaller radius is worth more "
            "than photons."
        )
    return said


def _limits(outcome: Outcome, result: ResultKind) -> list[str]:
    """How error falls, and what the three savings are worth."""
    said = []
    laws = slopes(outcome, result)
    if "error" in laws:
        slope = laws["error"].slope
        said.append(
            f"Error falls as photons to the power {slope.value:.2f} "
            f"[{slope.low:.2f}, {slope.high:.2f}]" + _theory(outcome, result) + "."
        )
    if "photon noise" in laws:
        slope = laws["photon noise"].slope
        said.append(
            f"With the camera held still, noise falls to the power {slope.value:.2f} "
            f"[{slope.low:.2f}, {slope.high:.2f}]" + _theory(outcome, result)
            + ": what is left is the photons'. The rest is the camera's own sampling of pixels, "
            "which passes lower and photons do not."
        )
        crossing = bias_shows_from(outcome)
        if crossing is not None:
            said.append(
                f"From about {crossing:,.0f} photons a pass on, the kernel's bias is more than the "
                "photons' noise."
            )
    factors = saving(outcome, result)
    if factors:
        (few, at_few), (many, at_many) = factors[0], factors[-1]
        of_what = "error" if result == "bins" else "noise of the photons"
        said.append(
            "Random numbers, unaimed photons and roulette together need "
            f"{at_many.value:.3g} [{at_many.low:.3g}, {at_many.high:.3g}] times the photons of "
            f"Sobol points, aiming and branch weights for the same {of_what} at {many:,} photons a "
            f"pass, and {at_few.value:.3g} [{at_few.low:.3g}, {at_few.high:.3g}] times at {few:,}."
        )
    return said


def _theory(outcome: Outcome, result: ResultKind) -> str:
    """What theory expects of the slope, in brackets."""
    dimensions = outcome.dimensions.get(result)
    if dimensions is None:
        return ""
    return f" (theory: {expected_slope(dimensions):.2f}, by {dimensions} dimensions)"


def _by(found: list[Effect]) -> list[Effect]:
    return sorted(found, key=lambda one: one.ratio.value)
