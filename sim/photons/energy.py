"""The energy books of a run: where every emitted watt went."""

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
        return cls(*(float(total) for total in rows.sum(axis=0)))

    @classmethod
    def mean(cls, books: "list[EnergyBooks]") -> "EnergyBooks":
        """Mean over passes, each of which emits the lamps' whole flux."""
        return cls(
            *(float(np.mean([getattr(book, name) for book in books])) for name in BOOK_COLUMNS)
        )
