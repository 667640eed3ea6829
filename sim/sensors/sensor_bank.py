"""A scene's sensors on the device."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from scenes.sensors import MAX_BINS
from sim.device_arrays import struct_array
from sim.photons.lamps import find_shining
from sim.precision import precision_types
from sim.scene_data import CompiledScene, bounding_radius
from sim.sensors.frames import AnySensor, sensor_frame, sensor_half
from sim.sensors.sensor_structs import SENSOR_BINS, SENSOR_RAYS, make_sensor_structs
from spectra import EmissionSpectrum

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
        cells: where a sensor's bins for undispersed light are, a cell and a lamp each, behind the
            bins of all; empty where it has none.
        shares: of each sensor, (lamps, bands): the part of each lamp's flux in each band.
    """

    data: Any
    sensors: tuple[AnySensor, ...]
    bins: tuple[slice, ...]
    edges_nm: FloatArray
    cells: tuple[slice, ...] = ()
    shares: tuple[FloatArray, ...] = ()

    @property
    def bin_count(self) -> int:
        """Bins of all sensors."""
        return max((one.stop for one in self.bins), default=0)

    @property
    def counted(self) -> int:
        """Bins that photons are counted in, those for undispersed light among them."""
        return max((one.stop for one in (*self.bins, *self.cells)), default=0)

    def spread(self, flux: FloatArray) -> FloatArray:
        """(bins,) flux [W], from (counted,) as photons were counted.

        What has met nothing dispersive would be where it is at any wavelength: its lamp's
        spectrum says how much of it is in each band, whatever wavelengths its photons carry.
        """
        spread = flux[: self.bin_count].copy()
        for bins, cells, shares in zip(self.bins, self.cells, self.shares, strict=True):
            if cells.stop > cells.start:
                spread[bins] += (flux[cells].reshape(-1, len(shares)) @ shares).ravel()
        return spread


def compile_sensors(compiled: CompiledScene) -> SensorBank | None:
    """The scene's sensors; None if it has none, or its kernels do not know any."""
    scene = compiled.scene
    if not (scene.sensors and compiled.features.sensors):
        return None
    structs = make_sensor_structs(compiled.precision)
    edges_nm = np.asarray(scene.film.edges_nm, dtype=np.float64)[[0, -1]]
    spectra = [spectrum for _, spectrum, _ in find_shining(compiled, scene.film.edges_nm)]
    bins, first = [], 0
    for sensor in scene.sensors:
        count = 0
        if isinstance(sensor, scenes.IrradianceSensor):
            count = sensor.bins_of(scene.film)
        bins.append(slice(first, first + count))
        first += count
    shares = [_shares(spectra, edges_nm, _bands(sensor, scene.film)) for sensor in scene.sensors]
    cells = _cells(scene, bins, len(spectra))
    rows = [
        _sensor_row(compiled, sensor, place.start, cell.start if cell.stop > cell.start else -1)
        for sensor, place, cell in zip(scene.sensors, bins, cells, strict=True)
    ]
    data = structs.Sensors()
    data.sensors = struct_array(structs.Sensor, rows, compiled.device)
    data.count = len(rows)
    data.lamps = len(spectra)
    data.first_edge_nm = float(edges_nm[0])
    data.range_nm = float(edges_nm[1] - edges_nm[0])
    return SensorBank(data, scene.sensors, tuple(bins), edges_nm, tuple(cells), tuple(shares))


def _cells(scene: scenes.Scene, bins: list[slice], lamps: int) -> list[slice]:
    """Of each sensor, where its bins for undispersed light are, behind all of `bins`."""
    cells, first = [], bins[-1].stop
    for sensor, place in zip(scene.sensors, bins, strict=True):
        bands = _bands(sensor, scene.film)
        count = (place.stop - place.start) // bands * lamps
        if bands == 1 or first + count > 2 * MAX_BINS:
            count = 0  # there is nothing to spread, or no room: by their own wavelengths, then
        cells.append(slice(first, first + count))
        first += count
    return cells


def _bands(sensor: AnySensor, film: scenes.Film) -> int:
    return sensor.bands_of(film) if isinstance(sensor, scenes.IrradianceSensor) else 1


def _shares(spectra: list[EmissionSpectrum], edges_nm: FloatArray, bands: int) -> FloatArray:
    """(lamps, bands) part of each lamp's flux in each of bands of equal width."""
    edges = np.linspace(edges_nm[0], edges_nm[1], bands + 1)
    return np.stack([one.band_flux(edges) / one.total for one in spectra])


def _sensor_row(
    compiled: CompiledScene, sensor: AnySensor, first_bin: int, first_cell: int
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
        counts = (*sensor.pixels, sensor.bands_of(compiled.scene.film), first_bin, first_cell)
        return (int(SENSOR_BINS), both, *place, *counts)
    return (int(SENSOR_RAYS), both, *place, 1, 1, 1, first_bin, first_cell)
