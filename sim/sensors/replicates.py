"""Running mean and scatter of independent replicates.

Reference:
    Welford (1962), Technometrics 4, 419: running mean and sum of squared deviations.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim.named_arrays import NamedArrays

__all__ = ["Replicates"]

FloatArray = npt.NDArray[np.float64]


@dataclass
class Replicates:
    """Running mean and squared deviations of arrays of one shape.

    Attributes:
        mean: of the replicates so far.
        squares: sum of their squared deviations.
        count: how many there were.
    """

    mean: FloatArray
    squares: FloatArray
    count: int = 0

    @classmethod
    def of_shape(cls, shape: tuple[int, ...]) -> "Replicates":
        """No replicate yet."""
        return cls(np.zeros(shape), np.zeros(shape))

    def add(self, values: FloatArray) -> None:
        """Take in one more (Welford 1962)."""
        self.count += 1
        off = values - self.mean
        self.mean += off / self.count
        self.squares += off * (values - self.mean)

    def state(self) -> NamedArrays:
        """What it takes to go on, by name."""
        return {"mean": self.mean, "squares": self.squares}

    def restore(self, count: int, state: NamedArrays) -> None:
        """Be as others were after `count`.

        Raises:
            ValueError: they are of another shape.
        """
        for name, mine in self.state().items():
            other = state.get(name)
            if other is None or other.shape != mine.shape or other.dtype != np.float64:
                raise ValueError(f"a sensor's {name} has another shape")
        self.mean, self.squares = state["mean"].copy(), state["squares"].copy()
        self.count = count

    @property
    def standard_error(self) -> FloatArray:
        """One standard deviation of the mean; NaN from a single replicate."""
        if self.count < 2:
            return np.full(self.mean.shape, np.nan)
        error: FloatArray = np.sqrt(self.squares / (self.count * (self.count - 1.0)))
        return error
