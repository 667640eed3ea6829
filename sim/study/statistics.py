"""Errors with their intervals: noise and bias apart, power laws, and what is worth its time.

From R independent replicates x₁ … x_R of a result and its reference r, with dᵢ = (xᵢ − r)/‖r‖ and
Gᵢⱼ = dᵢ · dⱼ,

    error² = mean Gᵢᵢ        bias² = mean of Gᵢⱼ, i ≠ j        noise² = error² − bias²

are unbiased (U-statistics; Hoeffding 1948): the mean of dᵢ · dⱼ over independent replicates is the
square of their common mean. A reference that is noisy itself, with a known variance, adds it to
error² and bias², and it is taken out.

References:
    Hoeffding (1948), Ann. Math. Statist. 19, 293: U-statistics.
    Student (1908), Biometrika 6, 1: intervals of means.
    Tukey (1958), Ann. Math. Statist. 29, 614: the jackknife.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

__all__ = [
    "LEVEL",
    "Errors",
    "Interval",
    "PowerLaw",
    "certain_errors",
    "fit_power_law",
    "gram_matrix",
    "mean_interval",
    "pareto_set",
    "separate_errors",
]

FloatArray = npt.NDArray[np.float64]

LEVEL = 0.95
"""Probability of every interval."""


class Interval(NamedTuple):
    """A value, and an interval that holds the true one with probability `LEVEL`."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Errors:
    """Relative L2 errors of one replicate, as expected of any.

    Attributes:
        error: noise and bias together, root mean square.
        noise: about the mean of all replicates there could be.
        bias: of that mean; 0 where the replicates show none.
        of_replicate: (R,) each one's error.
    """

    error: Interval
    noise: Interval
    bias: Interval
    of_replicate: FloatArray


def gram_matrix(replicates: Sequence[FloatArray], reference: FloatArray) -> FloatArray:
    """(R, R) products Gᵢⱼ of the replicates' deviations, relative to the reference's square."""
    deviations = np.stack([(one - reference).ravel() for one in replicates])
    gram: FloatArray = deviations @ deviations.T / float(np.sum(np.square(reference)))
    return gram


def separate_errors(gram: FloatArray, *, reference_variance: float = 0.0) -> Errors:
    """Error, noise and bias with their intervals, from R ≥ 2 replicates, or from a certain one.

    Args:
        gram: (R, R), see `gram_matrix`. A single replicate is one that chance has no part in.
        reference_variance: relative mean square of the reference's own noise.
    """
    diagonal = np.diag(gram) - reference_variance
    of_replicate = np.sqrt(np.maximum(np.diag(gram), 0.0))
    if len(gram) < 2:
        return certain_errors(math.sqrt(max(float(diagonal[0]), 0.0)))

    def error2(rows: FloatArray) -> float:
        return float(np.mean(np.diag(rows))) - reference_variance

    def bias2(rows: FloatArray) -> float:
        n = len(rows)
        return float(rows.sum() - np.trace(rows)) / (n * (n - 1)) - reference_variance

    def noise2(rows: FloatArray) -> float:
        return error2(rows) - bias2(rows)

    if len(gram) == 2:  # A single replicate, as the jackknife leaves it, has no noise to show.
        noise = _root(Interval(noise2(gram), 0.0, math.inf))
        bias = _root(Interval(bias2(gram), 0.0, math.inf))
        return Errors(_root(mean_interval(diagonal)), noise, bias, of_replicate)
    return Errors(
        _root(mean_interval(diagonal)),
        _root(_jackknife(gram, noise2)),
        _root(_jackknife(gram, bias2)),
        of_replicate,
    )


def certain_errors(error: float) -> Errors:
    """Of a result that chance has no part in: all of its error is bias."""
    only = Interval(error, error, error)
    return Errors(only, Interval(0.0, 0.0, 0.0), only, np.array([error]))


def mean_interval(values: npt.ArrayLike) -> Interval:
    """Mean of independent values with its interval by Student's t; infinite from a single one."""
    sample = np.asarray(values, dtype=np.float64)
    mean = float(np.mean(sample))
    if len(sample) < 2:
        return Interval(mean, -math.inf, math.inf)
    error = float(np.std(sample, ddof=1)) / math.sqrt(len(sample))
    return _around(mean, error, len(sample) - 1)


def _jackknife(gram: FloatArray, statistic: Callable[[FloatArray], float]) -> Interval:
    """The statistic of all replicates; its error from leaving out one after the other."""
    n = len(gram)
    rest = [np.delete(np.delete(gram, i, axis=0), i, axis=1) for i in range(n)]
    without = np.array([statistic(one) for one in rest])
    error = math.sqrt((n - 1) / n * float(np.sum((without - without.mean()) ** 2)))
    return _around(statistic(gram), error, n - 1)


def _around(value: float, standard_error: float, degrees_of_freedom: int) -> Interval:
    half = _t_quantile(degrees_of_freedom) * standard_error
    return Interval(value, value - half, value + half)


def _root(square: Interval) -> Interval:
    """Square root of each; a square below zero, which only chance can give, counts as zero."""
    return Interval(*(math.sqrt(max(one, 0.0)) for one in square))


def _t_quantile(degrees_of_freedom: int) -> float:
    from scipy.stats import t

    return float(t.ppf(0.5 + 0.5 * LEVEL, degrees_of_freedom))


@dataclass(frozen=True)
class PowerLaw:
    """y = c xˢ, fitted by least squares of the logarithms (ordinary linear regression).

    Attributes:
        slope: s, with its interval from the fit's residuals.
        log_x_mean: where the line turns as the slope changes.
        log_y_mean: the line's value there.
        residual: standard deviation of log y about the line.
        slope_error: one standard deviation of the slope.
        points: that were fitted.
    """

    slope: Interval
    log_x_mean: float
    log_y_mean: float
    residual: float
    slope_error: float
    points: int

    def at(self, x: float) -> Interval:
        """The line at x, with the interval of the line itself."""
        offset = math.log(x) - self.log_x_mean
        middle = self.log_y_mean + self.slope.value * offset
        variance = self.residual**2 / self.points + (self.slope_error * offset) ** 2
        half = _t_quantile(max(self.points - 2, 1)) * math.sqrt(variance)
        return Interval(*(math.exp(one) for one in (middle, middle - half, middle + half)))


def fit_power_law(x: npt.ArrayLike, y: npt.ArrayLike) -> PowerLaw | None:
    """Fit y = c xˢ; None from fewer than three points, or where all x are equal.

    Args:
        x: (n,) above 0; replicates are points of their own.
        y: (n,); points at 0 or below have no logarithm, and are left out.
    """
    both = np.stack([np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)])
    log_x, log_y = np.log(both[:, (both > 0.0).all(axis=0) & np.isfinite(both).all(axis=0)])
    n = len(log_x)
    if n < 3 or np.ptp(log_x) == 0.0:
        return None
    offset = log_x - log_x.mean()
    spread = float(offset @ offset)
    slope = float(offset @ log_y) / spread
    rest = log_y - log_y.mean() - slope * offset
    residual = math.sqrt(float(rest @ rest) / (n - 2))
    slope_error = residual / math.sqrt(spread)
    return PowerLaw(
        _around(slope, slope_error, n - 2), float(log_x.mean()), float(log_y.mean()),
        residual, slope_error, n,
    )


def pareto_set(costs: npt.ArrayLike, errors: npt.ArrayLike) -> list[int]:
    """Which points nothing else beats in both cost and error, in the order of their cost."""
    cost, error = np.asarray(costs, dtype=np.float64), np.asarray(errors, dtype=np.float64)
    kept: list[int] = []
    best = math.inf
    for i in np.lexsort((error, cost)):
        if error[i] < best:
            kept.append(int(i))
            best = float(error[i])
    return kept
