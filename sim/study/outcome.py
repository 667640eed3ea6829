"""What came out of a study: a row a point and result, and the laws fitted to them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from sim.study.plan import CENTRE, Plan
from sim.study.references import Reference
from sim.study.setup import ResultKind
from sim.study.statistics import (
    Errors,
    Interval,
    PowerLaw,
    fit_power_law,
    mean_interval,
    pareto_set,
)

__all__ = ["Effect", "Outcome", "Row", "effects", "ladder_rows", "saving", "slopes"]

FloatArray = npt.NDArray[np.float64]

REFERENCE_SHARE = 0.1
"""A reference should err at most this part of the smallest error that is shown."""

LADDER = "photons"
PLAIN_LADDER = "all three"
NOWHERE = Interval(float("nan"), float("nan"), float("nan"))


@dataclass(frozen=True, eq=False)
class Row:
    """One point's result, over its replicates.

    Attributes:
        axis, value: of the point.
        result: which.
        photons, passes: of a run.
        errors: relative L2 errors, of irradiance or of luminance.
        cpu_s: CPU-seconds of a run.
        cpu_of_replicate: (R,) of each.
        parts_s: mean CPU-seconds of tracing, binning, mapping, gathering.
        ciede_mean, ciede_p95: CIEDE2000 of the picture.
        centroid_arcsec: root mean square over the bands of where their light is, of bins.
        energy_residual: the largest share of the flux unaccounted for.
    """

    axis: str
    value: str
    result: ResultKind
    photons: int
    passes: int
    errors: Errors
    cpu_s: Interval
    cpu_of_replicate: FloatArray
    parts_s: tuple[float, ...]
    ciede_mean: Interval = NOWHERE
    ciede_p95: Interval = NOWHERE
    centroid_arcsec: Interval = NOWHERE
    energy_residual: float = float("nan")

    @property
    def replicates(self) -> int:
        """How many there were."""
        return len(self.cpu_of_replicate)

    @property
    def name(self) -> str:
        """Axis and value in one."""
        return self.axis if self.axis == self.value else f"{self.axis}: {self.value}"


@dataclass(frozen=True, eq=False)
class Outcome:
    """A finished study.

    Attributes:
        scene: its name.
        title: of the scene.
        plan: what was to be spent.
        cpu_s: CPU-seconds of the whole study.
        scale: the centre's photons as a multiple of the scene's default.
        default_photons, default_passes: those of the scene.
        coverage: share of the picture's rows that were exposed.
        bins_text: what is binned, in a sentence.
        rows: of all points.
        references: by result; one is missing if the result could not be measured.
        photon_noise: (photons, noise) of pictures whose camera looks the same every time.
    """

    scene: str
    title: str
    plan: Plan
    cpu_s: float
    scale: float
    default_photons: int
    default_passes: int
    coverage: float
    bins_text: str
    rows: tuple[Row, ...]
    references: dict[ResultKind, Reference]
    photon_noise: list[tuple[int, float]] = field(default_factory=list)

    def of(self, result: ResultKind) -> list[Row]:
        """The rows of a result, the centre's first."""
        return [row for row in self.rows if row.result == result]

    def centre(self, result: ResultKind) -> Row:
        """The centre's row."""
        return next(row for row in self.of(result) if row.axis == CENTRE)

    def pareto(self, result: ResultKind) -> list[Row]:
        """The rows that nothing beats in both time and error, in the order of their time."""
        rows = self.of(result)
        best = pareto_set(
            [row.cpu_s.value for row in rows], [row.errors.error.value for row in rows]
        )
        return [rows[i] for i in best]

    def reference_is_good(self, result: ResultKind) -> bool:
        """Whether the reference errs at most a tenth of the smallest error shown."""
        smallest = min(row.errors.error.value for row in self.of(result))
        return self.references[result].error <= REFERENCE_SHARE * smallest


def ladder_rows(rows: Sequence[Row]) -> list[Row]:
    """The centre and the values of the photons' axis, in their order."""
    found = [row for row in rows if row.axis in (CENTRE, LADDER)]
    return sorted(found, key=lambda row: row.photons)


def slopes(outcome: Outcome, result: ResultKind) -> dict[str, PowerLaw]:
    """Power laws of a result along the photons of a pass, fitted over all replicates.

    "error" and "time" are those of each replicate's error against photons and against CPU-seconds,
    "noise" is that of the points' noise against photons, "photon noise" the same with the camera
    held still.
    """
    ladder = ladder_rows(outcome.of(result))
    photons = np.concatenate([np.full(row.replicates, row.photons) for row in ladder])
    cpu_s = np.concatenate([row.cpu_of_replicate for row in ladder])
    errors = np.concatenate([row.errors.of_replicate for row in ladder])
    laws = {
        "error": fit_power_law(photons, errors),
        "time": fit_power_law(cpu_s, errors),
        "noise": fit_power_law(
            [row.photons for row in ladder], [row.errors.noise.value for row in ladder]
        ),
    }
    if result == "picture" and outcome.photon_noise:
        laws["photon noise"] = fit_power_law(*zip(*outcome.photon_noise, strict=True))
    return {name: law for name, law in laws.items() if law is not None}


@dataclass(frozen=True, eq=False)
class Effect:
    """What a value costs or saves.

    Attributes:
        row: of the value.
        ratio: error² × CPU-seconds relative to the centre's: how many times the photons it takes
            for the same error, at equal time.
        time: CPU-seconds relative to the centre's.
        error: error relative to the centre's.
    """

    row: Row
    ratio: Interval
    time: float
    error: float


def effects(outcome: Outcome, result: ResultKind) -> list[Effect]:
    """The effect of every value of every axis at equal CPU time.

    Independent passes are what time buys: error² falls as 1/passes, so error² × time is what a
    setup needs for a given error. It holds for noise; a bias stays whatever is spent.
    """
    centre = outcome.centre(result)
    return [
        Effect(
            row,
            _ratio(row, centre),
            row.cpu_s.value / centre.cpu_s.value,
            row.errors.error.value / centre.errors.error.value,
        )
        for row in outcome.of(result)
        if row is not centre
    ]


def _ratio(row: Row, centre: Row) -> Interval:
    """Ratio of the mean error² times the mean time, its interval on the logarithm."""
    value = (row.errors.error.value**2 * row.cpu_s.value) / (
        centre.errors.error.value**2 * centre.cpu_s.value
    )
    relative = [
        (interval.high - interval.low) / (2.0 * interval.value) * weight
        for one in (row, centre)
        for interval, weight in ((one.errors.error, 2.0), (one.cpu_s, 1.0))
        if interval.value > 0.0 and np.isfinite(interval.high)
    ]
    factor = math.exp(math.hypot(*relative))
    return Interval(value, value / factor, value * factor)


def saving(outcome: Outcome) -> list[tuple[Row, Interval]]:
    """How many times the photons the plain method needs for the error of each ladder's point.

    The plain method's photons are independent, so its error² is c/N exactly, with the same c for
    all N: c comes from all of its replicates. A row of the ladder with error e at N photons a pass
    and as many passes then has the factor c/(e² N).
    """
    rows = outcome.of("bins")
    plain = [row for row in rows if row.axis == PLAIN_LADDER]
    if not plain:
        return []
    c = mean_interval(
        np.concatenate([row.errors.of_replicate**2 * (row.photons * row.passes) for row in plain])
    )
    factors = []
    for row in ladder_rows(rows):
        need = mean_interval(row.errors.of_replicate**2 * (row.photons * row.passes))
        value = c.value / need.value
        both = [(one.high - one.low) / (2.0 * one.value) for one in (c, need)]
        factor = math.exp(math.hypot(*both))
        factors.append((row, Interval(value, value / factor, value * factor)))
    return factors
