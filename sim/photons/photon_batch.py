"""The photons that one pass stored, and where its energy went."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.photons.energy import EnergyBooks
from sim.photons.photon_structs import make_photon_structs
from sim.precision import precision_types
from sim.sensors.pass_crossings import PassCrossings

__all__ = ["PhotonBatch", "allocate_photons"]


@dataclass(frozen=True)
class PhotonBatch:
    """Stored photons of one pass, on the device, and the pass's energy books.

    Attributes:
        data: the device-side Photons struct, with gaps.
        slots: (n,) int32, the slots of `data` that hold photons, in the order of emission.
        books: where the pass's flux went.
        origin: (3,), world position of the local frame's origin [m].
        deposits: (ranges,) how many photons each range of the launch stored, in their order.
        crossings: what its photons have left on the sensors; None if there were none to cross.
        stands_for: how many photons each of them stands for.
    """

    data: Any
    slots: npt.NDArray[np.int32]
    books: EnergyBooks
    origin: npt.NDArray[np.float64]
    deposits: npt.NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    crossings: PassCrossings | None = None
    stands_for: int = 1

    def __len__(self) -> int:
        return len(self.slots)

    def parted(self, *, every: int, first: int) -> tuple["PhotonBatch", "PhotonBatch"]:
        """Those that no diffuse surface has reflected, and some of those that one has.

        Args:
            every: one of how many is kept of the second kind; it stands for the others.
            first: the first that is kept, 0 to `every` − 1.
        """
        bounced = _bounces(self.data.history.numpy()[self.slots]) > 0
        return (
            replace(self, slots=self.slots[~bounced]),
            replace(self, slots=self.slots[bounced][first::every], stands_for=every),
        )

    def to_numpy(self) -> dict[str, npt.NDArray[Any]]:
        """The photons as host arrays, one row a photon.

        Returns:
            position (n, 3) in world coordinates [m], direction (n, 3), wavelength_nm, flux [W],
            object and face (n,), side (0 front or outside, 1 back or inside), refractions,
            reflections and bounces (n,), dispersed (n,) whether a dispersive boundary was met,
            and emitter (n,), its row among the emitters that shine.
        """
        surface = self.data.surface.numpy()[self.slots]
        history = self.data.history.numpy()[self.slots]
        return {
            "position": self.data.position.numpy()[self.slots] + self.origin,
            "direction": self.data.direction.numpy()[self.slots],
            "wavelength_nm": self.data.wavelength_nm.numpy()[self.slots],
            "flux": self.data.flux.numpy()[self.slots],
            "object": surface >> 14,
            "face": (surface >> 1) & 8191,
            "side": surface & 1,
            "refractions": history & 1023,
            "reflections": (history >> 10) & 1023,
            "bounces": _bounces(history),
            "dispersed": (history >> 30) & 1 == 1,
            "emitter": self.data.emitter.numpy()[self.slots],
        }


def _bounces(history: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Bounces off diffuse surfaces, of packed histories: see `sim.photons.photon_structs`."""
    return (history >> 20) & 1023


def allocate_photons(precision: str, device: str, slots: int) -> Any:
    """A Photons struct with room for `slots` photons, not initialised."""
    types = precision_types(precision)
    photons = make_photon_structs(precision).Photons()
    room = max(1, slots)
    photons.position = wp.empty(room, dtype=types.vec3, device=device)
    photons.direction = wp.empty(room, dtype=wp.vec3, device=device)
    photons.wavelength_nm = wp.empty(room, dtype=wp.float32, device=device)
    photons.flux = wp.empty(room, dtype=wp.float64, device=device)
    photons.surface = wp.empty(room, dtype=int, device=device)
    photons.history = wp.empty(room, dtype=int, device=device)
    photons.emitter = wp.empty(room, dtype=int, device=device)
    return photons
