"""Nephroid: photons through glass, from a scene to a spectral picture.

The names below are loaded when they are first used, so that ``import sim`` stays light.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.errors import (
        CapacityError,
        CheckpointError,
        DeviceError,
        FileFormatError,
        NephroidError,
        OutputError,
        SettingsError,
        UnfinishedError,
    )
    from sim.image.exr_reading import SpectralImage, read_exr
    from sim.image.picture import Picture
    from sim.measure import Measurement, measure
    from sim.progress import Progress
    from sim.ray_path import RayPath
    from sim.render import render
    from sim.resumption.checkpoint import Checkpoint
    from sim.sensors.irradiance import IrradianceReading
    from sim.sensors.rays import RaysReading
    from sim.settings import RenderSettings
    from sim.single_ray import trace_ray

__all__ = [
    "CapacityError",
    "Checkpoint",
    "CheckpointError",
    "DeviceError",
    "FileFormatError",
    "IrradianceReading",
    "Measurement",
    "NephroidError",
    "OutputError",
    "Picture",
    "Progress",
    "RayPath",
    "RaysReading",
    "RenderSettings",
    "SettingsError",
    "SpectralImage",
    "UnfinishedError",
    "measure",
    "read_exr",
    "render",
    "trace_ray",
]

_HOME = {
    "CapacityError": "sim.errors",
    "Checkpoint": "sim.resumption.checkpoint",
    "CheckpointError": "sim.errors",
    "DeviceError": "sim.errors",
    "FileFormatError": "sim.errors",
    "IrradianceReading": "sim.sensors.irradiance",
    "Measurement": "sim.measure",
    "NephroidError": "sim.errors",
    "OutputError": "sim.errors",
    "Picture": "sim.image.picture",
    "Progress": "sim.progress",
    "RayPath": "sim.ray_path",
    "RaysReading": "sim.sensors.rays",
    "RenderSettings": "sim.settings",
    "SettingsError": "sim.errors",
    "SpectralImage": "sim.image.exr_reading",
    "UnfinishedError": "sim.errors",
    "measure": "sim.measure",
    "read_exr": "sim.image.exr_reading",
    "render": "sim.render",
    "trace_ray": "sim.single_ray",
}


def __getattr__(name: str) -> Any:
    """Load a public name on its first use (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Package(ModuleType):
    """Keeps a module from hiding the public function of the same name.

    Importing ``sim.render`` makes Python bind that module as the package's attribute ``render``;
    the attribute is promised to be the function.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
