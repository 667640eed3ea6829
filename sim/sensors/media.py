"""In which media a sensor lies.

Irradiance is flux per area, the same measure in every medium; but what arrives inside glass has
been through its surface, and what arrives at a sensor flush with it has not.
"""

import numpy as np
import numpy.typing as npt

import scenes
from scenes.shapes.depth import height_above
from sim.sensors.frames import AnySensor, sensor_frame, sensor_half
from spectra import Medium

__all__ = ["media_at"]

FloatArray = npt.NDArray[np.float64]

_BEFORE = 1e-6
"""How far before a sensor's front its medium is looked for, in parts of its size: of one that is
flush with a surface, it is the medium that light arrives through."""

_STEPS = (-0.9, 0.0, 0.9)


def media_at(scene: scenes.Scene, sensor: AnySensor) -> tuple[str, ...]:
    """Names of the media just before a sensor's front, that of its centre first.

    Args:
        scene: the scene.
        sensor: one of its sensors.

    Returns:
        One name, or several if the sensor reaches into several media.
    """
    points = _points(sensor)
    ambient = scene.resolved_ambient()
    names = [ambient.name if isinstance(ambient, Medium) else ambient] * len(points)
    priorities = np.full(len(points), -np.inf)
    for item in scene.objects:
        if not isinstance(item.material, scenes.Dielectric):
            continue
        height = height_above(item.shape, points)
        if height is None:
            continue
        for k in np.flatnonzero((height < 0.0) & (item.material.priority > priorities)):
            priorities[k] = item.material.priority
            names[k] = item.material.resolved().name
    return tuple(dict.fromkeys(names))


def _points(sensor: AnySensor) -> FloatArray:
    """(9, 3) places just before the front, the centre's first."""
    frame, half = sensor_frame(sensor), sensor_half(sensor)
    reach = np.sqrt(0.5) if isinstance(sensor.shape, scenes.Disk) else 1.0
    steps = [(0.0, 0.0), *((a, b) for a in _STEPS for b in _STEPS if (a, b) != (0.0, 0.0))]
    places = reach * np.array(steps) * half
    start = np.asarray(sensor.shape.position) + _BEFORE * float(np.hypot(*half)) * frame[2]
    points: FloatArray = start + places @ frame[:2]
    return points
