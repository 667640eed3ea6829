"""When a rendering is good enough, or has had its time."""

from __future__ import annotations

from typing import Protocol

from sim.image.accuracy import Accuracy
from sim.settings import ResolvedSettings
from sim.stopwatch import Stopwatch

__all__ = ["StopRule"]

LEAST_ROUNDS = 2
"""Fewer replicates than these tell nothing of the error."""


class ExposedFilm(Protocol):
    """What is known of a film in the making."""

    @property
    def rounds(self) -> int:
        """Complete samples."""

    def accuracy(self) -> Accuracy:
        """How sure it is."""


class StopRule:
    """Decides after each round of passes whether it was the last.

    A target is reached when `Accuracy.relative_error` is at most as large. A time budget is spent
    when another round, taking as long as the longest so far, would exceed it. Rounds are never
    cut short, and there are at least two, since a single one does not know its error.

    Attributes:
        outcome: Why the run ended, in words.
        longest_round: What the longest round has taken [s].
    """

    def __init__(self, plan: ResolvedSettings, watch: Stopwatch) -> None:
        self._plan = plan
        self._watch = watch
        self._round_began = watch.seconds
        self.longest_round = 0.0
        self.outcome = "all passes"

    def go_on(self, longest_round: float) -> None:
        """Begin a round after others, of an earlier run, the longest of which took so long [s]."""
        self.longest_round = longest_round
        self._round_began = self._watch.seconds

    def ends_after(self, film: ExposedFilm) -> bool:
        """True if the round that `film` just completed is to be the last."""
        now = self._watch.seconds
        self.longest_round = max(self.longest_round, now - self._round_began)
        self._round_began = now
        if film.rounds < LEAST_ROUNDS:
            return False
        error = film.accuracy().relative_error
        self._watch.error = error
        target, budget = self._plan.target_error, self._plan.time_budget
        if target is not None and error <= target:
            self.outcome = "target error"
            return True
        if budget is not None and now + self.longest_round > budget:
            self.outcome = "time budget"
            return True
        return False
