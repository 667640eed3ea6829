"""One replicate of a setup: what it found, and what that took."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim.photons.energy import EnergyBooks
from sim.study.setup import ResultKind

__all__ = ["Costs", "Sample"]

FloatArray = npt.NDArray[np.float64]


@dataclass
class Costs:
    """CPU-seconds of a run, by what they were spent on; `gather` is that of the whole picture."""

    trace: float = 0.0
    bin: float = 0.0
    map: float = 0.0
    gather: float = 0.0

    def of(self, result: ResultKind) -> float:
        """What a result costs by itself."""
        if result == "bins":
            return self.trace + self.bin
        return self.trace + self.map + self.gather

    @contextmanager
    def timing(self, what: str, *, times: float = 1.0) -> Iterator[None]:
        """Add the process's CPU time of the block to one of the costs, multiplied."""
        start = time.process_time()
        yield
        spent = time.process_time() - start
        setattr(self, what, getattr(self, what) + times * spent)


@dataclass(frozen=True, eq=False)
class Sample:
    """One replicate.

    Attributes:
        seed: which.
        irradiance: (rows, columns, bands) of the bins [W m⁻² nm⁻¹], or None.
        xyz: (rows, width, 3) of the picture's rows, or None.
        bias: (rows, width) that the gather itself estimates of their luminance [cd/m²], or None.
        books: where the energy went; None without photons.
        costs: what it took.
        stated_error: relative error that a mesh states of itself; None of photons.
    """

    seed: int
    irradiance: FloatArray | None
    xyz: FloatArray | None
    bias: FloatArray | None
    books: EnergyBooks | None
    costs: Costs
    stated_error: float | None = None
