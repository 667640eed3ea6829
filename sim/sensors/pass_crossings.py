"""What one pass's photons have left on the sensors, on the host."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.precision import precision_types
from sim.sensors.sensor_bank import SensorBank

__all__ = ["PassCrossings", "allocate_crossings", "collect_crossings"]

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int32]


@dataclass(frozen=True)
class PassCrossings:
    """One pass's crossings.

    Attributes:
        flux: (bins,) of all sensors with bins, in their order [W].
        rays: of all sensors that keep rays, one row a crossing, in the order of emission: sensor
            (n,), its row; position (n, 3) in world coordinates [m]; direction (n, 3), unit;
            wavelength_nm (n,); flux (n,) [W]; history, emitter and lot (n,).
    """

    flux: FloatArray
    rays: dict[str, npt.NDArray[Any]]


def allocate_crossings(crossings: Any, bank: SensorBank, precision: str, slots: int) -> None:
    """Give a Crossings struct room for `slots` of both kinds, as far as there are such sensors."""
    types, device = precision_types(precision), bank.data.sensors.device
    if bank.bin_count > 0:
        crossings.bin = wp.empty(slots, dtype=int, device=device)
        crossings.bin_flux = wp.empty(slots, dtype=wp.float64, device=device)
    if any(one.stop == one.start for one in bank.bins):
        crossings.sensor = wp.empty(slots, dtype=int, device=device)
        crossings.position = wp.empty(slots, dtype=types.vec3, device=device)
        crossings.direction = wp.empty(slots, dtype=types.vec3, device=device)
        crossings.wavelength_nm = wp.empty(slots, dtype=types.real, device=device)
        crossings.flux = wp.empty(slots, dtype=wp.float64, device=device)
        crossings.history = wp.empty(slots, dtype=int, device=device)
        crossings.emitter = wp.empty(slots, dtype=int, device=device)
        crossings.lot = wp.empty(slots, dtype=wp.float64, device=device)


def collect_crossings(
    crossings: Any, bank: SensorBank, bin_slots: IntArray, ray_slots: IntArray, origin: FloatArray
) -> PassCrossings:
    """Add up the bins and gather the rays.

    Args:
        crossings: the device-side Crossings struct.
        bank: the sensors.
        bin_slots: those that hold crossings of bins.
        ray_slots: those that hold rays.
        origin: (3,) of the local frame, in the world [m].
    """
    flux = np.zeros(bank.counted)
    if len(bin_slots):
        bins, fluxes = crossings.bin.numpy()[bin_slots], crossings.bin_flux.numpy()[bin_slots]
        flux = np.bincount(bins, fluxes, bank.counted).astype(np.float64, copy=False)
    rays: dict[str, npt.NDArray[Any]] = {}
    if len(ray_slots):
        names = (
            "sensor", "position", "direction", "wavelength_nm", "flux", "history", "emitter", "lot"
        )
        rays = {name: getattr(crossings, name).numpy()[ray_slots] for name in names}
        rays["position"] = rays["position"] + origin
    return PassCrossings(bank.spread(flux), rays)
