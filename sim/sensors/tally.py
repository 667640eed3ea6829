"""What the passes of a run add up to on a sensor, with their scatter.

Passes are independent replicates: the mean over them is the estimate, and their scatter its
standard error. Of rays, more may cross than there is room for. Each crossing draws a lot in
[0, 1), and those with a lot below p stay, with their flux divided by p; p is halved whenever they
are too many. The lots know nothing of the rays, so that what is kept stands for all without bias.

References:
    Welford (1962), Technometrics 4, 419: running mean and sum of squared deviations.
    Flajolet (1990), "On adaptive sampling", Computing 43, 391: thinning by a threshold that is
    halved when the sample outgrows its room, and its freedom from bias.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from sim.image.accuracy import Accuracy
from sim.sensors.pass_crossings import PassCrossings
from sim.sensors.sensor_bank import SensorBank

__all__ = ["RayStore", "Replicates", "SensorTally"]

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

    @property
    def standard_error(self) -> FloatArray:
        """One standard deviation of the mean; NaN from a single replicate."""
        if self.count < 2:
            return np.full(self.mean.shape, np.nan)
        error: FloatArray = np.sqrt(self.squares / (self.count * (self.count - 1.0)))
        return error


class RayStore:
    """The rays of one sensor, thinned to what there is room for.

    Attributes:
        kept: probability with which each ray was kept, a power of 1/2.
        crossings: how many rays have crossed.
        flux: flux that crossed [W], before any thinning; a replicate a pass.
    """

    def __init__(self, room: int) -> None:
        self.room = room
        self.kept = 1.0
        self.crossings = 0
        self.flux = Replicates.of_shape(())
        self._passes: list[dict[str, npt.NDArray[Any]]] = []

    def add(self, rays: dict[str, npt.NDArray[Any]]) -> None:
        """Take in the rays of one pass; none if it is empty."""
        fluxes = rays.get("flux", np.zeros(0))
        number = np.full(len(fluxes), self.flux.count, dtype=np.int32)
        self.flux.add(np.asarray(fluxes.sum()))
        self.crossings += len(fluxes)
        if rays:
            self._passes.append(self._thinned({**rays, "pass_index": number}))
        while sum(len(one["lot"]) for one in self._passes) > self.room:
            self.kept *= 0.5
            self._passes = [self._thinned(one) for one in self._passes]

    def rays(self) -> dict[str, npt.NDArray[Any]]:
        """All rays kept so far, by column; empty if there is none.

        Their flux is a part of the mean over the passes: it adds up to what crosses.
        """
        if not self._passes:
            return {}
        found = {name: np.concatenate([one[name] for one in self._passes])
                 for name in self._passes[0]}
        found["flux"] = found["flux"] / (self.kept * self.flux.count)
        return found

    def _thinned(self, rays: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
        stay = rays["lot"] < self.kept
        return rays if stay.all() else {name: column[stay] for name, column in rays.items()}


class SensorTally:
    """All sensors of a run.

    Attributes:
        bank: the sensors.
        bins: flux in each bin [W], of all sensors that have any.
        totals: flux [W] of each sensor with bins, (sensors,).
        cells: flux [W] of each cell of each sensor with bins, all bands together.
        stores: of each sensor, its rays; None for one with bins.
    """

    def __init__(self, bank: SensorBank) -> None:
        self.bank = bank
        self.bins = Replicates.of_shape((bank.bin_count,))
        self.totals = Replicates.of_shape((len(bank.sensors),))
        self.cells = [
            Replicates.of_shape(sensor.pixels[::-1])
            if isinstance(sensor, scenes.IrradianceSensor) else None
            for sensor in bank.sensors
        ]
        self.stores = [
            RayStore(sensor.max_rays) if isinstance(sensor, scenes.RaySensor) else None
            for sensor in bank.sensors
        ]

    @property
    def rounds(self) -> int:
        """Passes so far: independent replicates of everything."""
        return self.bins.count

    def accuracy(self) -> Accuracy:
        """How sure the flux of each cell is, and the flux through sensors that keep rays.

        Values are relative to the mean over their own sensor; there is no bias.
        """
        parts = [one for one in self.cells if one is not None]
        parts += [one.flux for one in self.stores if one is not None]
        scales = [float(one.mean.mean()) or 1.0 for one in parts]
        pairs = list(zip(parts, scales, strict=True))
        value = np.concatenate([np.ravel(one.mean) / scale for one, scale in pairs])
        noise = np.concatenate([np.ravel(one.standard_error) / scale for one, scale in pairs])
        none = np.zeros_like(value)
        return Accuracy(
            luminance=value, noise=noise, bias=none, bias_noise=none, corrected_noise=noise,
            replicates=self.rounds,
        )

    def add(self, crossings: PassCrossings) -> None:
        """Take in one pass."""
        self.bins.add(crossings.flux)
        totals = np.zeros(len(self.stores))
        for row, (place, cells, store) in enumerate(
            zip(self.bank.bins, self.cells, self.stores, strict=True)
        ):
            if cells is not None:
                flux = crossings.flux[place].reshape(*cells.mean.shape, -1).sum(axis=2)
                cells.add(flux)
                totals[row] = flux.sum()
            if store is not None:
                mine = crossings.rays.get("sensor", np.zeros(0)) == row
                store.add({name: one[mine] for name, one in crossings.rays.items()})
        self.totals.add(totals)
