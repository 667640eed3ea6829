"""The files of a scene's sensors, and a line about each."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenes import Scene
    from sim.sensors.readings import Readings

__all__ = ["check_sensor_files", "sensor_paths", "write_readings"]


def sensor_paths(scene: Scene, output: Path) -> dict[str, Path]:
    """Where each sensor's files go, without their ending: beside the picture, with their names.

    Args:
        scene: the scene.
        output: the picture's file, whether there is a picture or not.
    """
    stems: dict[str, Path] = {}
    taken: set[str] = set()
    for sensor in scene.sensors:
        plain = re.sub(r"[^\w-]+", "-", sensor.name).strip("-") or "sensor"
        stem, number = plain, 2
        while stem.casefold() in taken:
            stem, number = f"{plain}-{number}", number + 1
        taken.add(stem.casefold())
        stems[sensor.name] = output.with_name(f"{output.stem}.{stem}")
    return stems


def check_sensor_files(scene: Scene, output: Path) -> None:
    """Find out before long work whether `write_readings` can write.

    Raises:
        OutputError: it cannot.
    """
    from sim.atomic_file import check_writable

    for sensor in scene.sensors:
        for ending in _endings(sensor.type):
            check_writable(_file(sensor_paths(scene, output)[sensor.name], ending))


def write_readings(scene: Scene, readings: Readings, output: Path) -> None:
    """Write every reading beside `output`, and print a line about each.

    Raises:
        OutputError: a file cannot be written.
    """
    from sim.sensors.irradiance import IrradianceReading

    stems = sensor_paths(scene, output)
    for name, reading in readings.items():
        files = [_file(stems[name], ending) for ending in _endings(reading.sensor.type)]
        if isinstance(reading, IrradianceReading):
            reading.save_exr(files[0])
        reading.save_npz(files[-1])
        print(f"{' and '.join(map(str, files))}: {reading.summary}")


def _endings(kind: str) -> tuple[str, ...]:
    return (".exr", ".npz") if kind == "irradiance" else (".npz",)


def _file(stem: Path, ending: str) -> Path:
    """A dot in the stem is no ending of its own."""
    return stem.with_name(stem.name + ending)
