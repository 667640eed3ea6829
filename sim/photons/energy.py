"""The energy books of a run: where every emitted watt went.

How exact they are does not depend on how many photons there are, since only short sums are rounded
at every step. With u = 2⁻⁵³, and relative to the flux of a column's terms without their signs: a
photon's own columns are off by u for each surface that it meets, 256 unless `max_interactions` says
otherwise, and by as much for the flux that each split shares out; a thread's by 256 u more for its
photons; a range's by 64 u for its threads. Ranges and passes are added up exactly and rounded once.
So columns hold to 10⁻¹³ at worst, in 10⁹ photons as in one. In single precision the first of these
have u = 2⁻²⁴.

References:
    Higham (2002), *Accuracy and Stability of Numerical Algorithms*, §4.2: the bounds;
    Shewchuk (1997), Discrete Comput. Geom. 18, 305: exact sums, as `math.fsum` has them.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["BOOK_COLUMNS", "EnergyBooks"]

BOOK_COLUMNS = ("emitted", "deposited", "absorbed", "escaped", "culled")
"""Columns of the kernels' books, in their order."""


@dataclass(frozen=True)
class EnergyBooks:
    """Radiant flux [W] inside the film's wavelengths, per pass.

    Attributes:
        emitted: flux of the photons that left the lamps.
        deposited: flux that met diffuse surfaces, before any of it is reflected on.
        absorbed: flux that ended in absorbers.
        escaped: flux that left the scene, or that an endless plane kept from coming near it.
        culled: flux dropped on purpose: paths longer than the limit, and the balance of Russian
            roulette, which is zero in expectation and may be negative.
    """

    emitted: float
    deposited: float
    absorbed: float
    escaped: float
    culled: float

    @property
    def residual(self) -> float:
        """What is unaccounted for, relative to the emitted flux."""
        spent = self.deposited + self.absorbed + self.escaped + self.culled
        return (self.emitted - spent) / self.emitted if self.emitted else 0.0

    @classmethod
    def from_rows(cls, rows: npt.NDArray[np.float64]) -> "EnergyBooks":
        """Sum (ranges, 5) rows of the kernels' books."""
        return cls(*(math.fsum(column) for column in rows.T.tolist()))

    @classmethod
    def mean(cls, books: "list[EnergyBooks]") -> "EnergyBooks":
        """Mean over passes, each of which emits the lamps' whole flux."""
        return cls(
            *(math.fsum(getattr(book, name) for book in books) / len(books)
              for name in BOOK_COLUMNS)
        )
