"""What Sobol points, aiming and branch weights are worth, and how fast bins converge.

A short study of each scene: irradiance behind glass in exact bins, joint in place and wavelength,
and the photons' part of the picture's noise.
"""

import dataclasses

from history import Measure

import scenes
from sim.study.expected_slope import expected_slope
from sim.study.findings import effects, saving, slopes
from sim.study.outcome import PLAIN_LADDER, Outcome
from sim.study.plan import QUICK
from sim.study.setup import ResultKind
from sim.study.statistics import Interval
from sim.study.study import run_study

PLAN = dataclasses.replace(
    QUICK, rows=6, points_s=70.0, mesh_s=15.0, bins_s=15.0, picture_s=5.0,
    axes=("photons", "sampler", "branching", "aiming", PLAIN_LADDER),
)
ALONE = {"random": "Sobol points", "unaimed": "aiming", "roulette": "branch weights"}
"""What a value of an axis goes without."""


def study(name: str) -> list[Measure]:
    """The measures of one gallery scene."""
    outcome = run_study(scenes.load(name), PLAN, seed=0, threads=2, tell=lambda _: None)
    found: list[Measure] = []
    if "bins" in outcome.references:
        found += [
            Measure(
                f"bins: error² × time without {ALONE[one.row.value]}", name, *one.ratio, "> 1"
            )
            for one in effects(outcome, "bins")
            if one.row.value in ALONE
        ]
        found += [*_together(outcome, "bins", name), *_slope(outcome, "bins", "error", name)]
    found += _together(outcome, "picture", name)
    return [*found, *_slope(outcome, "picture", "photon noise", name)]


def _together(outcome: Outcome, result: ResultKind, name: str) -> list[Measure]:
    """Photons that random, unaimed roulette takes for the error of the longest ladder's end."""
    factors = saving(outcome, result)
    if not factors:
        return []
    photons, factor = factors[-1]
    note = f"at {photons} photons a pass"
    return [Measure(f"{result}: photons without all three", name, *factor, ">= 50", note)]


def _slope(outcome: Outcome, result: ResultKind, law: str, name: str) -> list[Measure]:
    """Exponent of the error over the photons of a pass."""
    found = slopes(outcome, result)
    if law not in found:
        return []
    slope: Interval = found[law].slope
    theory = f"theory {expected_slope(outcome.dimensions[result]):.2f}"
    asked = "<= -0.65" if result == "bins" else "<= -0.6"
    return [Measure(f"{result}: {law} as photons to the power", name, *slope, asked, theory)]
