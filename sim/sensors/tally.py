"""What the passes of a run add up to on its sensors, with their scatter.

Passes are independent replicates: the mean over them is the estimate, and their scatter its
standard error.
"""

import numpy as np

import scenes
from sim.image.accuracy import Accuracy
from sim.named_arrays import NamedArrays, part_of, prefixed
from sim.sensors.pass_crossings import PassCrossings
from sim.sensors.ray_store import RayStore
from sim.sensors.replicates import Replicates
from sim.sensors.sensor_bank import SensorBank

__all__ = ["SensorTally"]


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

    def state(self) -> NamedArrays:
        """What it takes to go on after this pass, by name."""
        found: NamedArrays = {}
        for name, part in self._parts().items():
            found |= prefixed(name, part.state())
        return found

    def restore(self, passes: int, state: NamedArrays) -> None:
        """Be as another tally, of the same sensors, was after some passes.

        Raises:
            ValueError: it is of other sensors; says so.
        """
        for name, part in self._parts().items():
            part.restore(passes, part_of(state, name))

    def _parts(self) -> dict[str, Replicates | RayStore]:
        """All that passes are added to, by name."""
        parts: dict[str, Replicates | RayStore] = {"bins": self.bins, "totals": self.totals}
        for row, (cells, store) in enumerate(zip(self.cells, self.stores, strict=True)):
            parts |= {} if cells is None else {f"cells{row}": cells}
            parts |= {} if store is None else {f"rays{row}": store}
        return parts
