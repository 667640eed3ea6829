"""What a run will take at its peak, told before it takes it.

Counted from what is allocated, array by array; how many photons a pass stores is learned from a
few that are traced. Peak memory of renderings lies within 30 % of it (tests/extremes).
"""

from dataclasses import dataclass, replace

import numpy as np

import scenes
from sim.errors import CapacityError
from sim.memory.available import available_memory, resident_memory
from sim.memory.sizes import film_memory, size_text
from sim.photons.lamps import Lamps
from sim.photons.photon_maps import INDIRECT_KEPT
from sim.photons.tracing import trace_photons
from sim.precision import precision_types
from sim.scene_data import CompiledScene
from sim.sensors.sensor_bank import compile_sensors
from sim.settings import ResolvedSettings

__all__ = ["MemoryEstimate", "estimate_memory", "require_memory"]

PROBE = 4000
"""Photons that tell how many a pass stores: their number is known to a few per cent."""

MANY_STORED = 50.0
"""Deposits of one photon, and rays that sensors keep of it; if there is room for twice as many,
none are traced to count them."""

_GRID_BYTES = 20
"""Of a hash grid, for each photon: its cell, its number, and the like of both for sorting."""

_BIN_BYTES = 6 * 8
"""Of each bin of a sensor: mean, squares, a pass's flux, and what they are read out into."""

_RAY_BYTES = 2 * 84
"""Of each ray that a sensor keeps: its columns, and once more when they are put together."""


@dataclass(frozen=True)
class MemoryEstimate:
    """Bytes that a run takes at its peak.

    Attributes:
        program: what the process takes before, with its kernels.
        film: the picture, with its sums.
        photons: of one pass that is gathered from and of the next that is traced.
        sensors: what they keep.
        stored: photons that a pass stores.
    """

    program: int
    film: int
    photons: int
    sensors: int
    stored: int

    @property
    def total(self) -> int:
        """All of it."""
        return self.program + self.film + self.photons + self.sensors

    def __str__(self) -> str:
        stored = f"{self.stored / 1e6:.3g} million"
        parts = [
            f"program {size_text(self.program)}",
            f"film {size_text(self.film)}",
            f"photons {size_text(self.photons)} for {stored} that a pass stores",
        ]
        if self.sensors:
            parts.append(f"sensors {size_text(self.sensors)}")
        return f"{size_text(self.total)} ({', '.join(parts)})"


def require_memory(
    compiled: CompiledScene, lamps: Lamps, settings: ResolvedSettings, *, pictured: bool
) -> None:
    """Make sure that a run has the memory that it will need, on the CPU.

    Args:
        compiled: the scene.
        lamps: with the photons of a pass.
        settings: of the run.
        pictured: whether there is a film.

    Raises:
        CapacityError: it has not; says what it needs, what there is, and what to lower.
    """
    available = available_memory()
    if available is None or compiled.device != "cpu":
        return
    many = MANY_STORED * settings.photons
    keeps_rays = any(isinstance(one, scenes.RaySensor) for one in compiled.scene.sensors)
    most = _counted(compiled, settings, many, 0.0, many if keeps_rays else 0.0, pictured)
    if 2 * (most.total - most.program) < available:
        return
    estimate = estimate_memory(compiled, lamps, settings, pictured=pictured)
    room = available + estimate.program
    if estimate.total > room:
        raise CapacityError(
            f"this run needs about {estimate}, and {size_text(room)} are there;"
            f" {_advice(estimate, settings, room)}"
        )


def _advice(estimate: MemoryEstimate, settings: ResolvedSettings, room: int) -> str:
    """Which setting to lower, and how far."""
    rest = estimate.total - estimate.photons
    fitting = int(settings.photons * 0.9 * (room - rest) / max(1, estimate.photons))
    if fitting >= 1:
        digits = max(0, len(str(fitting)) - 2)
        fitting = fitting // 10**digits * 10**digits
        more = round(settings.passes * settings.photons / max(1, fitting))
        return f"lower photons to {fitting} (and raise passes to {more}, for as many in all)"
    if estimate.film > estimate.sensors:
        return "lower film.width, film.height or film.bands"
    return "lower max_rays, pixels or bands of the sensors"


def estimate_memory(
    compiled: CompiledScene, lamps: Lamps, settings: ResolvedSettings, *, pictured: bool
) -> MemoryEstimate:
    """Trace a few photons, and count what a run takes at its peak.

    Args:
        compiled: the scene.
        lamps: with the photons of a pass.
        settings: of the run.
        pictured: whether there is a film.
    """
    part = min(1.0, PROBE / settings.photons)
    streams = tuple(
        replace(one, photons=max(1, round(part * one.photons))) for one in lamps.streams
    )
    batch = trace_photons(
        compiled,
        replace(lamps, streams=streams),
        seed=settings.seed,
        pass_index=0,
        max_interactions=settings.max_interactions,
        threads=settings.threads,
        store_direct=pictured and settings.direct_light == "photons",
        sensors=compile_sensors(compiled),
        bounces=settings.bounces,
    )
    scale = sum(one.photons for one in lamps.streams) / sum(one.photons for one in streams)
    bounced = scale * len(batch.parted(every=1, first=0)[1])
    crossings = 0.0
    if batch.crossings is not None:
        crossings = scale * len(batch.crossings.rays.get("flux", ()))
    return _counted(compiled, settings, scale * len(batch), bounced, crossings, pictured)


def _counted(
    compiled: CompiledScene, settings: ResolvedSettings, stored: float, bounced: float,
    crossings: float, pictured: bool,
) -> MemoryEstimate:
    """The sum, from how many photons a pass stores, and how many rays cross sensors in it."""
    sums, at_end = film_memory(compiled.scene)
    real = np.dtype(precision_types(compiled.precision).dtype).itemsize
    # sim.photons.photon_batch: position; direction, wavelength, flux, and three integers; slots.
    batch = 3 * real + 12 + 4 + 8 + 3 * 4 + 8
    # sim.photons.photon_map: position, weight, and three integers; there are two while sorting.
    row = 4 * real + 3 * 4
    mapped = stored - bounced + bounced / INDIRECT_KEPT
    being_made = batch * stored + (2 * row + _GRID_BYTES) * mapped
    gathered = (row + _GRID_BYTES) * mapped
    if not pictured:
        sums, at_end, being_made, gathered = 0, 0, batch * stored, 0.0
    photons = being_made + (gathered if settings.passes > 1 else 0.0)
    return MemoryEstimate(
        program=resident_memory(),
        film=sums + max(0, at_end - int(being_made)),
        photons=int(photons),
        sensors=int(_sensor_bytes(compiled.scene, crossings * settings.passes, crossings)),
        stored=int(stored),
    )


def _sensor_bytes(scene: scenes.Scene, rays: float, rays_a_pass: float) -> float:
    """What sensors keep of all passes, and of one."""
    kept, total = 0, rays_a_pass * _RAY_BYTES
    for sensor in scene.sensors:
        if isinstance(sensor, scenes.IrradianceSensor):
            total += _BIN_BYTES * sensor.bins_of(scene.film)
        else:
            kept += sensor.max_rays
    return total + _RAY_BYTES * min(rays, kept)
