"""What a study's rows say: how fast errors fall, and what each choice is worth."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim.study.outcome import PLAIN_LADDER, Outcome, Row, ladder_rows
from sim.study.setup import ResultKind
from sim.study.statistics import Interval, PowerLaw, fit_power_law, mean_interval

__all__ = ["Effect", "bias_shows_from", "effects", "saving", "slopes"]

FloatArray = npt.NDArray[np.float64]


def slopes(outcome: Outcome, result: ResultKind) -> dict[str, PowerLaw]:
    """Power laws of a result along the photons of a pass, fitted over all replicates.

    "error" and "time" are those of each replicate's error against photons and against CPU-seconds,
    "noise" is that of the points' noise against photons, "photon noise" that of each replicate's
    deviation with the camera held still.
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
        still = [one for one in outcome.photon_noise if not one.plain]
        laws["photon noise"] = fit_power_law(
            np.concatenate([np.full(len(one.squares), one.photons) for one in still]),
            np.sqrt(np.concatenate([one.squares for one in still])),
        )
    return {name: law for name, law in laws.items() if law is not None}


def bias_shows_from(outcome: Outcome) -> float | None:
    """Photons in a pass at which a picture's bias is as large as its photons' noise.

    None where no bias shows, or where there is no law of that noise.
    """
    law = slopes(outcome, "picture").get("photon noise")
    bias = outcome.centre("picture").errors.bias
    if law is None or bias.low <= 0.0 or law.slope.value >= 0.0:
        return None
    return math.exp(law.log_x_mean + (math.log(bias.value) - law.log_y_mean) / law.slope.value)


@dataclass(frozen=True, eq=False)
class Effect:
    """What a value costs or saves.

    Attributes:
        row: of the value.
        ratio: error² × CPU-seconds relative to the centre's: how many times the photons it takes
            for the same error, at equal time; the error as `Row.judged` has it.
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
            row.judged.value / centre.judged.value,
        )
        for row in outcome.of(result)
        if row is not centre
    ]


def _ratio(row: Row, centre: Row) -> Interval:
    """Ratio of the mean error² times the mean time, its interval on the logarithm."""
    value = (row.judged.value**2 * row.cpu_s.value) / (
        centre.judged.value**2 * centre.cpu_s.value
    )
    relative = [
        (interval.high - interval.low) / (2.0 * interval.value) * weight
        for one in (row, centre)
        for interval, weight in ((one.judged, 2.0), (one.cpu_s, 1.0))
        if interval.value > 0.0 and np.isfinite(interval.high)
    ]
    factor = math.exp(math.hypot(*relative))
    return Interval(value, value / factor, value * factor)


def saving(outcome: Outcome, result: ResultKind) -> list[tuple[int, Interval]]:
    """How many times the photons the plain method needs for the same error.

    The plain method's photons are independent, so its error² is c/N exactly, with the same c for
    all N: c comes from all of its replicates. A run of the ladder with error e at N photons then
    has the factor c/(e² N). Of pictures, only the photons' noise is compared.

    Returns:
        Photons of a pass of the ladder, and the factor.
    """
    if result == "bins":
        plain = [(row, row.errors.of_replicate**2) for row in outcome.of(result)
                 if row.axis == PLAIN_LADDER]
        ladder = [(row, row.errors.of_replicate**2) for row in ladder_rows(outcome.of(result))]
        return _factors(
            [(row.photons, squares * (row.photons * row.passes)) for row, squares in plain],
            [(row.photons, squares * (row.photons * row.passes)) for row, squares in ladder],
        )
    noise = outcome.photon_noise
    return _factors(
        [(one.photons, one.squares * (one.photons * one.passes)) for one in noise if one.plain],
        [(one.photons, one.squares * (one.photons * one.passes)) for one in noise if not one.plain],
    )


def _factors(
    plain: list[tuple[int, FloatArray]], ladder: list[tuple[int, FloatArray]]
) -> list[tuple[int, Interval]]:
    """Ratios of the plain method's error² N to those of the ladder's points."""
    if not plain:
        return []
    c = mean_interval(np.concatenate([products for _, products in plain]))
    factors = []
    for photons, products in ladder:
        need = mean_interval(products)
        value = c.value / need.value
        both = [(one.high - one.low) / (2.0 * one.value) for one in (c, need)]
        factor = math.exp(math.hypot(*both))
        factors.append((photons, Interval(value, value / factor, value * factor)))
    return factors
