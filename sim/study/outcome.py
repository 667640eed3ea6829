"""What came out of a study: a row a point and result."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from sim.study.plan import CENTRE, Plan
from sim.study.references import Reference
from sim.study.setup import ResultKind
from sim.study.statistics import Errors, Interval, pareto_set

__all__ = [
    "AMOUNTS",
    "LADDER",
    "PLAIN_LADDER",
    "REFERENCE_SHARE",
    "Outcome",
    "PhotonNoise",
    "Row",
    "ladder_rows",
]

FloatArray = npt.NDArray[np.float64]

REFERENCE_SHARE = 0.1
"""A reference should err at most this part of the smallest error that is shown."""

LADDER = "photons"
AMOUNTS = (CENTRE, "photons", "passes", "photons × passes")
"""Axes that vary how much is spent, not how."""

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
        tempered: error of the picture as `--target-error` counts it: root mean square over the
            pixels of the luminance's error, each over the pixel's luminance plus the mean.
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
    tempered: Interval = NOWHERE
    ciede_mean: Interval = NOWHERE
    ciede_p95: Interval = NOWHERE
    centroid_arcsec: Interval = NOWHERE
    energy_residual: float = float("nan")

    @property
    def replicates(self) -> int:
        """How many there were."""
        return len(self.cpu_of_replicate)

    @property
    def judged(self) -> Interval:
        """The error by which values are compared: of pictures the tempered one.

        Relative L2 is ruled by the few pixels where a lamp's edge or a focus burns out.
        """
        return self.tempered if np.isfinite(self.tempered.value) else self.errors.error

    @property
    def name(self) -> str:
        """Axis and value in one."""
        return self.axis if self.axis == self.value else f"{self.axis}: {self.value}"


@dataclass(frozen=True, eq=False)
class PhotonNoise:
    """The photons' part of a picture's noise.

    Attributes:
        plain: whether by the method without sampling, aiming and branch weights.
        photons, passes: of a run.
        squares: (R,) relative mean square deviation of each replicate's luminance.
    """

    plain: bool
    photons: int
    passes: int
    squares: FloatArray

    @property
    def noise(self) -> float:
        """Relative L2 noise."""
        return float(np.sqrt(np.mean(self.squares)))


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
        photon_noise: of pictures whose camera looks the same every time.
        dimensions: by result, of how many numbers it depends what a photon lights.
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
    photon_noise: list[PhotonNoise] = field(default_factory=list)
    dimensions: dict[ResultKind, int] = field(default_factory=dict)

    def of(self, result: ResultKind) -> list[Row]:
        """The rows of a result, the centre's first."""
        return [row for row in self.rows if row.result == result]

    def centre(self, result: ResultKind) -> Row:
        """The centre's row."""
        return next(row for row in self.of(result) if row.axis == CENTRE)

    def pareto(self, result: ResultKind, *, amounts_only: bool = False) -> list[Row]:
        """The rows that nothing beats in both time and error, in the order of their time.

        Args:
            result: of which.
            amounts_only: only what differs from the centre in photons and passes alone takes part.
        """
        rows = self.of(result)
        if amounts_only:
            rows = [row for row in rows if row.axis in AMOUNTS]
        best = pareto_set(
            [row.cpu_s.value for row in rows], [row.errors.error.value for row in rows]
        )
        return [rows[i] for i in best]

    def smallest_error(self, result: ResultKind) -> float:
        """The smallest error shown, but for meshes', which know their own.

        An error of 0 is one that the replicates could not tell from none; infinite if all are.
        """
        errors = [row.errors.error.value for row in self.of(result) if row.replicates > 1]
        return min((error for error in errors if error > 0.0), default=math.inf)

    def reference_is_good(self, result: ResultKind) -> bool:
        """Whether the reference errs at most a tenth of the smallest error shown."""
        return self.references[result].error <= REFERENCE_SHARE * self.smallest_error(result)


def ladder_rows(rows: Sequence[Row]) -> list[Row]:
    """The centre and the values of the photons' axis, in their order."""
    found = [row for row in rows if row.axis in (CENTRE, LADDER)]
    return sorted(found, key=lambda row: row.photons)
