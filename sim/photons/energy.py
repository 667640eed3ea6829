"""The energy books of a run: where every emitted watt went.

How exact they are does not depend on how many photons there are, since only short sums are rounded
at every step. With u = 2⁻⁵³, and relative to the flux of a column's terms without their signs: a
photon's own columns are off by u for each surface that it meets, 256 unless `max_interactions` says
otherwise, and by as much for the flux that each split shares out; a thread's by 256 u more for its
photons; a range's by 64 u for its threads. Ranges and passes are added up exactly and rounded once.
So columns hold to 10⁻¹³ at worst, in 10⁹ photons as in one. In single precision the first of these
have u = 2⁻²⁴. Those of a band take in a range's photons one by one, 16,384 in four colours: 10⁻¹¹
at worst.

References:
    Higham (2002), *Accuracy and Stability of Numerical Algorithms*, §4.2: the bounds;
    Shewchuk (1997), Discrete Comput. Geom. 18, 305: exact sums, as `math.fsum` has them.
"""

import math
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
        columns = () if band_rows is None else _sums(band_rows)
        by_band = np.reshape(columns, (-1, rows.shape[1])).tolist()
        return cls(*_sums(rows), by_band=tuple(map(tuple, by_band)))

    @classmethod
    def mean(cls, books: "list[EnergyBooks]") -> "EnergyBooks":
        """Mean over passes, each of which emits the lamps' whole flux."""
        count = len(books)
        totals = [total / count for total in _sums(np.array([book.totals for book in books]))]
        by_band = [[value / count for value in _sums(np.array(rows))] for rows in
                   zip(*(book.by_band for book in books), strict=True)]  # fmt: skip
        return cls(*totals, by_band=tuple(map(tuple, by_band)))


def _sums(rows: npt.NDArray[np.float64]) -> list[float]:
    """Of each column of (n, columns) rows, the sum, rounded once."""
    return [math.fsum(column) for column in rows.T.tolist()]
