"""A scene's sensors on the device."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from sim.device_arrays import struct_array
from sim.precision import precision_types
from sim.scene_data import CompiledScene, bounding_radius
from sim.sensors.frames import sensor_frame, sensor_half
from sim.sensors.sensor_structs import SENSOR_BINS, SENSOR_RAYS, make_sensor_structs

__all__ = ["SensorBank", "compile_sensors"]

FloatArray = npt.NDArray[np.float64]

FLUSH = 1e-9
"""Heights above a sensor that count as on it, relative to the scene's size: a nanometre of a
metre, unless the arithmetic is coarser."""

_ULPS = 64.0


@dataclass(frozen=True)
class SensorBank:
    """All sensors of a scene.

    Attributes:
        data: the device-side Sensors struct.
        sensors: what they were compiled from, in the same order.
        bins: where the bins of each sensor are among those of all.
        edges_nm: (2,) where the first band begins and the last one ends [nm].
    """

    data: Any
    sensors: tuple[scenes.IrradianceSensor | scenes.RaySensor, ...]
    bins: tuple[slice, ...]
    edges_nm: FloatArray

    @property
    def bin_count(self) -> int:
        """Bins of all sensors."""
        return max((one.stop for one in self.bins), default=0)


def compile_sensors(compiled: CompiledScene) -> SensorBank | None:
    """The scene's sensors; None if it has none, or its kernels do not know any."""
    scene = compiled.scene
    if not (scene.sensors and compiled.features.sensors):
        return None
    structs = make_sensor_structs(compiled.precision)
    edges_nm = np.asarray(scene.film.edges_nm, dtype=np.float64)[[0, -1]]
    rows, bins, first = [], [], 0
    for sensor in scene.sensors:
        count = 0
        if isinstance(sensor, scenes.IrradianceSensor):
            count = sensor.bins_of(scene.film)
        rows.append(_sensor_row(compiled, sensor, first))
        bins.append(slice(first, first + count))
        first += count
    data = structs.Sensors()
    data.sensors = struct_array(structs.Sensor, rows, compiled.device)
    data.count = len(rows)
    data.first_edge_nm = float(edges_nm[0])
    data.range_nm = float(edges_nm[1] - edges_nm[0])
    return SensorBank(data, scene.sensors, tuple(bins), edges_nm)


def _sensor_row(
    compiled: CompiledScene, sensor: scenes.IrradianceSensor | scenes.RaySensor, first_bin: int
) -> tuple[Any, ...]:
    """The fields of a Sensor, in their order."""
    shape, half = sensor.shape, sensor_half(sensor)
    centre = compiled.to_local(shape.position)
    reach = bounding_radius(compiled.scene, compiled.origin)
    reach += float(np.linalg.norm(centre)) + float(np.hypot(*half))
    eps = float(np.finfo(precision_types(compiled.precision).dtype).eps)
    radius2 = shape.radius**2 if isinstance(shape, scenes.Disk) else np.inf
    place = (centre, sensor_frame(sensor), *half, radius2, max(FLUSH, _ULPS * eps) * reach)
    both = int(sensor.sides == "both")
    if isinstance(sensor, scenes.IrradianceSensor):
        counts = (*sensor.pixels, sensor.bands_of(compiled.scene.film), first_bin)
        return (int(SENSOR_BINS), both, *place, *counts)
    return (int(SENSOR_RAYS), both, *place, 1, 1, 1, first_bin)
