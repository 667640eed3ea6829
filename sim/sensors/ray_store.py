"""The rays that have crossed a sensor, as many as there is room for.

More may cross than that. Each crossing draws a lot in [0, 1), and those with a lot below p stay,
with their flux divided by p; p is halved whenever they are too many. The lots know nothing of the
rays, so that what is kept stands for all without bias.

Reference:
    Flajolet (1990), "On adaptive sampling", Computing 43, 391: thinning by a threshold that is
    halved when the sample outgrows its room, and its freedom from bias.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

from sim.named_arrays import NamedArrays, part_of, prefixed
from sim.sensors.replicates import Replicates

__all__ = ["RayStore"]

_RAY_COLUMNS: dict[str, tuple[int, ...]] = {
    "sensor": (), "position": (3,), "direction": (3,), "wavelength_nm": (), "flux": (),
    "history": (), "emitter": (), "lot": (), "pass_index": (),
}  # fmt: skip
"""Of the rays that are kept, what there is of each, beside their number."""


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
        found = {name: self._column(name) for name in self._passes[0]}
        found["flux"] = found["flux"] / (self.kept * self.flux.count)
        return found

    def state(self) -> NamedArrays:
        """What it takes to go on, by name."""
        names = self._passes[0] if self._passes else {}
        return {
            **prefixed("flux", self.flux.state()),
            "kept": np.array(self.kept),
            "crossings": np.array(self.crossings, dtype=np.int64),
            **prefixed("rays", {name: self._column(name) for name in names}),
        }

    def restore(self, count: int, state: NamedArrays) -> None:
        """Be as another store was after `count` passes.

        Raises:
            ValueError: it is not one that passes of these rays can have made.
        """
        self.flux.restore(count, part_of(state, "flux"))
        rays = part_of(state, "rays")
        counters = [state.get("kept"), state.get("crossings")]
        if any(one is None or one.shape != () for one in counters):
            raise ValueError("a sensor's counters are not there")
        lots = rays.get("lot", np.zeros(0))
        if rays and (set(rays) != set(_RAY_COLUMNS) or any(
            one.shape != (len(lots), *_RAY_COLUMNS[name]) for name, one in rays.items()
        )):
            raise ValueError("a sensor's rays have another shape")
        self.kept, self.crossings = float(state["kept"]), int(state["crossings"])
        if not (0.0 < self.kept <= 1.0 and len(lots) <= min(self.room, self.crossings)):
            raise ValueError("a sensor's rays are not as many as it has kept")
        self._passes = [{name: one.copy() for name, one in rays.items()}] if rays else []

    def _column(self, name: str) -> npt.NDArray[Any]:
        return np.concatenate([one[name] for one in self._passes])

    def _thinned(self, rays: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
        stay = rays["lot"] < self.kept
        return rays if stay.all() else {name: column[stay] for name, column in rays.items()}
