"""What a run has come to: all that the passes to come add to, and nothing that they make anew.

The scene's arrays, the lamps and what a pilot has taught follow from scene, settings and seed, and
are the same when they are made again.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.image.film import Film
from sim.named_arrays import NamedArrays, part_of, prefixed
from sim.photons.energy import BOOK_COLUMNS, EnergyBooks
from sim.sensors.tally import SensorTally
from sim.stopping import StopRule
from sim.stopwatch import Stopwatch

__all__ = ["RunState"]


@dataclass
class RunState:
    """A run between two passes.

    Attributes:
        books: of each pass so far.
        rule: when to stop.
        watch: how long it has taken.
        film: what is exposed; None if nothing is.
        tally: of the sensors; None if there are none.
    """

    books: list[EnergyBooks]
    rule: StopRule
    watch: Stopwatch
    film: Film | None = None
    tally: SensorTally | None = None

    @property
    def passes(self) -> int:
        """Passes so far."""
        return len(self.books)

    def ends(self) -> bool:
        """Whether the pass just made was to be the last, by error or by time.

        It is asked after whole rounds of turns.
        """
        if self.film is None:
            assert self.tally is not None  # a run without a film measures
            return self.rule.ends_after(self.tally)
        return self.film.passes % self.film.turns == 0 and self.rule.ends_after(self.film)

    def arrays(self) -> NamedArrays:
        """What it takes to go on, by name."""
        rows = [(one.totals, *one.by_band) for one in self.books]
        # Of each pass the totals, then its bands where they are kept.
        found: NamedArrays = {"books": np.array(rows, dtype=np.float64)}
        if self.film is not None:
            found |= prefixed("film", self.film.state())
        if self.tally is not None:
            found |= prefixed("sensors", self.tally.state())
        return found

    def numbers(self) -> dict[str, float]:
        """The rest, ready for JSON."""
        return {
            "passes": self.passes,
            "seconds": self.watch.seconds,
            "longest_round": self.rule.longest_round,
        }

    def restore(self, numbers: dict[str, Any], arrays: NamedArrays) -> None:
        """Be as another run was after its last pass.

        Raises:
            ValueError: these are not the numbers and arrays of such a run; says why.
        """
        passes = numbers.get("passes")
        seconds, longest = (_time(numbers, name) for name in ("seconds", "longest_round"))
        books = arrays.get("books", np.zeros(0))
        columns = (passes, len(BOOK_COLUMNS))
        if type(passes) is not int or books.ndim != 3 or books.shape[::2] != columns:
            raise ValueError("its energy books are not those of its passes")
        if self.film is not None:
            self.film.restore(passes, part_of(arrays, "film"))
        if self.tally is not None:
            self.tally.restore(passes, part_of(arrays, "sensors"))
        self.books[:] = [
            dataclasses.replace(EnergyBooks(*row[0]), by_band=row[1:]) for row in books.tolist()
        ]
        self.watch.go_on(passes, seconds)
        self.rule.go_on(longest)  # by the watch, whose earlier seconds are no round


def _time(numbers: dict[str, Any], name: str) -> float:
    value = numbers.get(name)
    if not isinstance(value, int | float) or not 0.0 <= value < math.inf:
        raise ValueError(f"{name} is no time")
    return float(value)
