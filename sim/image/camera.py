"""The camera on the device: where each pixel looks."""

import functools
from typing import Any

import numpy as np
import warp as wp

import scenes
from sim.precision import precision_types
from sim.scene_data import CompiledScene

__all__ = ["compile_camera", "make_camera_functions", "make_camera_struct"]


@functools.cache
def make_camera_struct(precision: str) -> Any:
    """Struct Camera: pinhole position, and the image plane at unit distance."""
    types = precision_types(precision)
    vec3 = types.vec3

    @wp.struct
    class Camera:
        position: vec3
        corner: vec3  # from the pinhole to the image's upper left corner
        step_right: vec3  # one pixel
        step_down: vec3
        width: int
        height: int

    return Camera


@functools.cache
def make_camera_functions(precision: str) -> Any:
    """Device function `look(camera, x, y)`: unit direction through pixel coordinates (x, y)."""
    types = precision_types(precision)
    real, camera_type = types.real, make_camera_struct(precision)

    @wp.func
    def look(camera: camera_type, x: real, y: real):
        return wp.normalize(camera.corner + camera.step_right * x + camera.step_down * y)

    return look


def compile_camera(compiled: CompiledScene, camera: scenes.Camera, film: scenes.Film) -> Any:
    """The device-side Camera struct: square pixels, `fov_deg` from top to bottom."""
    position = np.asarray(camera.position, dtype=np.float64)
    forward = np.asarray(camera.look_at, dtype=np.float64) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, np.asarray(camera.up, dtype=np.float64))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    pixel = 2.0 * np.tan(0.5 * np.radians(camera.fov_deg)) / film.height
    struct = make_camera_struct(compiled.precision)()
    struct.position = compiled.to_local(position)
    struct.corner = forward + pixel * (0.5 * film.height * up - 0.5 * film.width * right)
    struct.step_right = pixel * right
    struct.step_down = -pixel * up
    struct.width = film.width
    struct.height = film.height
    return struct
