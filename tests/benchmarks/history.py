"""What a benchmark has found, and the file in which a reader compares it with what was."""

import csv
import datetime
import platform
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.version import VERSION

HISTORY = Path(__file__).resolve().parent / "history.csv"
COLUMNS = (
    "date", "version", "machine", "measure", "scene", "value", "low", "high", "asked", "note"
)


@dataclass(frozen=True)
class Measure:
    """One number.

    Attributes:
        name: what it is, always in the same words.
        scene: on which scene.
        value: a ratio, an exponent, or whatever `name` says.
        low, high: the least and the greatest of the repetitions, or an interval of 95 %.
        asked: what it should be, such as ">= 0.7"; empty where nothing is asked.
        note: whatever else is needed to compare it, such as how many photons.
    """

    name: str
    scene: str
    value: float
    low: float
    high: float
    asked: str = ""
    note: str = ""

    def __str__(self) -> str:
        asked = f"  asked {self.asked}" if self.asked else ""
        note = f"  {self.note}" if self.note else ""
        return (
            f"{self.name + ', ' + self.scene:<56} {self.value:>8.3g} "
            f"[{self.low:.3g}, {self.high:.3g}]{asked}{note}"
        )


def median_measure(
    name: str, scene: str, values: Sequence[float], asked: str = "", note: str = ""
) -> Measure:
    """The median of repetitions, between the least and the greatest of them."""
    return Measure(
        name, scene, statistics.median(values), min(values), max(values), asked, note
    )


def record(measures: Iterable[Measure], path: Path = HISTORY) -> None:
    """Add a row a measure to the history."""
    today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
    is_new = not path.exists()
    with path.open("a", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        if is_new:
            writer.writerow(COLUMNS)
        for one in measures:
            numbers = (f"{number:.4g}" for number in (one.value, one.low, one.high))
            writer.writerow(
                [today, VERSION, platform.machine(), one.name, one.scene, *numbers, one.asked,
                 one.note]
            )
