"""In which media a sensor lies.

Irradiance is flux per area, the same measure in every medium; but what arrives inside glass has
been through its surface, and what arrives at a sensor flush with it has not.
"""

from typing import Any

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
        for k in np.flatnonzero(_inside(item.shape, points)):
            if item.material.priority <= priorities[k]:
                continue
            priorities[k] = item.material.priority
            names[k] = item.material.resolved().name
    return tuple(dict.fromkeys(names))


def _inside(shape: Any, points: FloatArray) -> npt.NDArray[np.bool_]:
    """Which points lie in a solid, (n,).

    In one of triangles, by how often it winds around a point: the sum of the solid angles of its
    triangles, over 4π (van Oosterom & Strackee 1983, "The solid angle of a plane triangle", IEEE
    Trans. Biomed. Eng. 30(2), eq. 8).
    """
    height = height_above(shape, points)
    if height is not None:
        return height < 0.0
    surface = shape.surface()
    corners = (surface.vertices + np.asarray(shape.position))[surface.triangles]
    found = np.zeros(len(points), dtype=bool)
    for k, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        p, q, r = (np.linalg.norm(one, axis=1) for one in (a, b, c))
        triple = np.sum(a * np.cross(b, c), axis=1)
        rest = p * q * r + np.sum(a * b, axis=1) * r
        rest += np.sum(b * c, axis=1) * p + np.sum(c * a, axis=1) * q
        found[k] = np.sum(np.arctan2(triple, rest)) > np.pi
    return found


def _points(sensor: AnySensor) -> FloatArray:
    """(9, 3) places just before the front, the centre's first."""
    frame, half = sensor_frame(sensor), sensor_half(sensor)
    reach = np.sqrt(0.5) if isinstance(sensor.shape, scenes.Disk) else 1.0
    steps = [(0.0, 0.0), *((a, b) for a in _STEPS for b in _STEPS if (a, b) != (0.0, 0.0))]
    places = reach * np.array(steps) * half
    start = np.asarray(sensor.shape.position) + _BEFORE * float(np.hypot(*half)) * frame[2]
    points: FloatArray = start + places @ frame[:2]
    return points
