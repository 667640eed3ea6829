"""The energy books of a run: where every emitted watt went."""

from dataclasses import dataclass
from typing import Any

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
        by_band: the same five for each of the film's bands, by the wavelengths that were traced;
            () where they are not kept.
    """

    emitted: float
    deposited: float
    absorbed: float
    escaped: float
    culled: float
    by_band: tuple[tuple[float, float, float, float, float], ...] = ()

    def __post_init__(self) -> None:
        """Take rows as JSON has them, too."""
        rows: Any = tuple(tuple(row) for row in self.by_band)
        object.__setattr__(self, "by_band", rows)

    @property
    def totals(self) -> tuple[float, ...]:
        """All bands together: emitted, deposited, absorbed, escaped, culled [W]."""
        return tuple(getattr(self, name) for name in BOOK_COLUMNS)

    @property
    def bands(self) -> "tuple[EnergyBooks, ...]":
        """The books of each band, from the shortest wavelength to the longest."""
        return tuple(EnergyBooks(*row) for row in self.by_band)

    @property
    def residual(self) -> float:
        """What is unaccounted for, relative to the emitted flux."""
        spent = self.deposited + self.absorbed + self.escaped + self.culled
        return (self.emitted - spent) / self.emitted if self.emitted else 0.0

    @classmethod
    def from_rows(
        cls, rows: npt.NDArray[np.float64], band_rows: npt.NDArray[np.float64] | None = None
    ) -> "EnergyBooks":
        """Sum the kernels' books over ranges.

        Args:
            rows: (ranges, 5).
            band_rows: (ranges, 5 bands), band by band; None: none are kept.
        """
        by_band = () if band_rows is None else band_rows.sum(axis=0).reshape(-1, rows.shape[1])
        return cls(*(float(total) for total in rows.sum(axis=0)), by_band=_rows(by_band))

    @classmethod
    def mean(cls, books: "list[EnergyBooks]") -> "EnergyBooks":
        """Mean over passes, each of which emits the lamps' whole flux."""
        totals = (float(np.mean([getattr(book, name) for book in books])) for name in BOOK_COLUMNS)
        by_band = np.mean([book.by_band for book in books], axis=0) if books[0].by_band else ()
        return cls(*totals, by_band=_rows(by_band))


def _rows(by_band: Any) -> Any:
    """Numbers of Python's own, which JSON can write."""
    return tuple(tuple(map(float, row)) for row in by_band)
