"""Where a sensor is and how it lies."""

import numpy as np
import numpy.typing as npt

import scenes
from scenes.frames import frame_about

__all__ = ["AnySensor", "sensor_frame", "sensor_half"]

FloatArray = npt.NDArray[np.float64]

AnySensor = scenes.IrradianceSensor | scenes.RaySensor
"""Any sensor."""


def sensor_frame(sensor: AnySensor) -> FloatArray:
    """(3, 3), rows u (along the width), v (along the height) and the normal.

    Who looks at the front sees u point right and v up.
    """
    if isinstance(sensor.shape, scenes.Rectangle):
        return np.stack(sensor.shape.frame())
    frame = frame_about(sensor.shape.normal)
    assert frame is not None  # only a chosen "up" can be parallel to the normal
    return np.stack(frame)


def sensor_half(sensor: AnySensor) -> FloatArray:
    """(2,) half the width and half the height [m], of a disk those of the square around it."""
    if isinstance(sensor.shape, scenes.Rectangle):
        return 0.5 * np.asarray(sensor.shape.size)
    return np.full(2, sensor.shape.radius)
