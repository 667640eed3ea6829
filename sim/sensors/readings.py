"""From what the passes add up to on each sensor to what is handed out."""

from typing import Any

import numpy as np

import scenes
from sim.sensors.cells import cell_areas, cell_edges
from sim.sensors.frames import sensor_half
from sim.sensors.irradiance import IrradianceReading
from sim.sensors.media import media_at
from sim.sensors.origin import Origin
from sim.sensors.rays import RaysReading
from sim.sensors.tally import SensorTally

__all__ = ["Readings", "read_sensors"]

Readings = dict[str, IrradianceReading | RaysReading]
"""Readings by the names of their sensors, in the order of the scene's file."""

_COLUMNS = {
    "position": (3, np.float64), "direction": (3, np.float64), "wavelength_nm": (0, np.float64),
    "flux": (0, np.float64), "pass_index": (0, np.int32), "history": (0, np.int32),
    "emitter": (0, np.int32),
}  # fmt: skip


def read_sensors(tally: SensorTally, origin: Origin) -> Readings:
    """What each sensor of a run has measured."""
    return {
        sensor.name: _irradiance(tally, row, sensor, origin)
        if isinstance(sensor, scenes.IrradianceSensor)
        else _rays(tally, row, sensor, origin)
        for row, sensor in enumerate(tally.bank.sensors)
    }


def _irradiance(
    tally: SensorTally, row: int, sensor: scenes.IrradianceSensor, origin: Origin
) -> IrradianceReading:
    half, place, cells = sensor_half(sensor), tally.bank.bins[row], tally.cells[row]
    assert cells is not None
    radius = sensor.shape.radius if isinstance(sensor.shape, scenes.Disk) else None
    areas = cell_areas(half, sensor.pixels, radius=radius)
    per_area = np.divide(1.0, areas, out=np.zeros_like(areas), where=areas > 0.0)
    first_nm, last_nm = tally.bank.edges_nm.tolist()
    edges_nm = np.linspace(first_nm, last_nm, sensor.bands_of(origin.scene.film) + 1)
    shape = (*areas.shape, len(edges_nm) - 1)
    per_bin = per_area[..., None] / np.diff(edges_nm)
    x, y = cell_edges(half, sensor.pixels)
    return IrradianceReading(
        sensor=sensor,
        spectral_irradiance=tally.bins.mean[place].reshape(shape) * per_bin,
        standard_error=tally.bins.standard_error[place].reshape(shape) * per_bin,
        irradiance=cells.mean * per_area,
        irradiance_error=cells.standard_error * per_area,
        flux=float(tally.totals.mean[row]),
        flux_error=float(tally.totals.standard_error[row]),
        edges_nm=edges_nm,
        x=x,
        y=y,
        areas=areas,
        media=media_at(origin.scene, sensor),
        passes=tally.bins.count,
        origin=origin,
    )


def _rays(
    tally: SensorTally, row: int, sensor: scenes.RaySensor, origin: Origin
) -> RaysReading:
    store = tally.stores[row]
    assert store is not None
    rays: dict[str, Any] = store.rays() or {
        name: np.zeros((0, width) if width else 0, dtype=kind)
        for name, (width, kind) in _COLUMNS.items()
    }
    history = rays["history"]
    return RaysReading(
        sensor=sensor,
        position=rays["position"],
        direction=rays["direction"].astype(np.float64),
        wavelength_nm=rays["wavelength_nm"].astype(np.float64),
        flux=rays["flux"],
        pass_index=rays["pass_index"],
        refractions=history & 1023,
        reflections=(history >> 10) & 1023,
        bounces=(history >> 20) & 1023,
        dispersed=(history >> 30) & 1 == 1,
        emitter=rays["emitter"],
        crossings=store.crossings,
        kept=store.kept,
        total_flux=float(store.flux.mean),
        total_flux_error=float(store.flux.standard_error),
        media=media_at(origin.scene, sensor),
        passes=store.flux.count,
        origin=origin,
    )
