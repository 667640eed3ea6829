"""The camera on the device: where each pixel looks.

A ray through a point of a thin lens meets the ray through the lens' middle where that one meets
the plane in focus, which is flat and perpendicular to the line of sight (Pharr, Jakob & Humphreys
2023, *Physically Based Rendering*, §5.2.3).
"""

import functools
from types import SimpleNamespace
from typing import Any

import numpy as np
import warp as wp

import scenes
from scenes.pixel_filter import PixelFilter
from sim.features import Features
from sim.precision import precision_types
from sim.sampling.directions import sample_disk
from sim.scene_data import CompiledScene

__all__ = ["compile_camera", "make_camera_functions", "make_camera_struct"]

BOX = wp.constant(0)
TENT = wp.constant(1)
GAUSSIAN = wp.constant(2)

LENS_POINTS = 4
"""Points of the lens that a pixel looks through in a pass; a divisor of its shadow rays."""

TWO_PI = wp.constant(6.283185307179586)


@functools.cache
def make_camera_struct(precision: str) -> Any:
    """Struct Camera: position, the image plane at unit distance, and the lens' two radii."""
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3

    @wp.struct
    class Camera:
        position: vec3
        corner: vec3  # from the position to the image's upper left corner
        step_right: vec3  # one pixel
        step_down: vec3
        lens_right: vec3  # to the aperture's edge
        lens_up: vec3
        sharp_distance: real
        lens_points: int
        filter: int  # BOX, TENT or GAUSSIAN
        filter_reach: real  # pixels
        filter_sigma: real
        filter_mass: real  # of the Gaussian, within its reach
        width: int
        height: int

    return Camera


@functools.cache
def make_camera_functions(precision: str, features: Features) -> SimpleNamespace:
    """Device functions of a camera, for pixel coordinates (x, y) and lens coordinates (u0, u1).

    Returns:
        A namespace with `place_in_pixel(camera, u0, u1)`, coordinates (x, y) about the corner of
        a pixel, as densely as the filter weighs them; `look(camera, x, y)`, the unit direction
        through the lens' middle; and `look_through(camera, x, y, u0, u1)`, origin and unit
        direction of the ray through a point of the lens.
    """
    types = precision_types(precision)
    real, camera_type = types.real, make_camera_struct(precision)

    @wp.func
    def tent(u: real, reach: real):
        """The offset below which a tent has the share u: the inverse of its distribution."""
        if u < real(0.5):
            return reach * (wp.sqrt(u + u) - real(1.0))
        return reach * (real(1.0) - wp.sqrt(real(2.0) - u - u))

    @wp.func
    def place_in_pixel(camera: camera_type, u0: real, u1: real):
        half = real(0.5)
        if wp.static(features.pixel_filter):
            if camera.filter == TENT:
                return half + tent(u0, camera.filter_reach), half + tent(u1, camera.filter_reach)
            if camera.filter == GAUSSIAN:
                # Box & Muller (1958), Ann. Math. Stat. 29, 610, within the reach.
                rho = camera.filter_sigma * wp.sqrt(
                    -real(2.0) * wp.log(real(1.0) - u0 * camera.filter_mass)
                )
                phi = real(TWO_PI) * u1
                return half + rho * wp.cos(phi), half + rho * wp.sin(phi)
        return u0, u1

    @wp.func
    def look(camera: camera_type, x: real, y: real):
        return wp.normalize(camera.corner + camera.step_right * x + camera.step_down * y)

    @wp.func
    def look_through(camera: camera_type, x: real, y: real, u0: real, u1: real):
        if wp.static(not features.thin_lens):
            return camera.position, look(camera, x, y)
        across, along = sample_disk(u0, u1)
        on_lens = camera.lens_right * across + camera.lens_up * along
        ahead = camera.corner + camera.step_right * x + camera.step_down * y
        return (
            camera.position + on_lens, wp.normalize(ahead * camera.sharp_distance - on_lens)
        )

    return SimpleNamespace(
        look=look, look_through=look_through, place_in_pixel=place_in_pixel
    )


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
    struct.lens_right = camera.lens_radius * right
    struct.lens_up = camera.lens_radius * up
    struct.sharp_distance = camera.sharp_distance
    struct.lens_points = LENS_POINTS if camera.lens_radius > 0.0 else 1
    _fill_filter(struct, film.filter)
    struct.width = film.width
    struct.height = film.height
    return struct


def _fill_filter(struct: Any, pixel_filter: PixelFilter) -> None:
    """Fill the fields of the pixel filter; those of a box are all zero."""
    if isinstance(pixel_filter, scenes.TentFilter):
        struct.filter = int(TENT)
        struct.filter_reach = pixel_filter.reach
    elif isinstance(pixel_filter, scenes.GaussianFilter):
        struct.filter = int(GAUSSIAN)
        struct.filter_sigma = pixel_filter.sigma
        struct.filter_mass = -np.expm1(-0.5 * (pixel_filter.reach / pixel_filter.sigma) ** 2)
