"""How wide a pixel is where it lands: the measure of the gather radius."""

import functools
from typing import Any

import numpy as np
import warp as wp

from sim.features import Features
from sim.image.camera import make_camera_functions, make_camera_struct
from sim.scene_data import CompiledScene
from sim.transport import EVENT_BOUNDARY, EVENT_DEPOSIT, make_transport

__all__ = ["pixel_footprint"]

_GRID = 64
_BOUNDARIES = wp.constant(16)


@functools.cache
def make_measure_footprints(precision: str, features: Features) -> Any:
    """Kernel: the width [m] of sampled pixels on the receiver they see, 0 where they see none."""
    transport = make_transport(precision, features)
    real, interact = transport.real, transport.interact
    media_indices = transport.media_indices
    scene_type, ray_type = transport.Scene, transport.Ray
    camera_type, look = make_camera_struct(precision), make_camera_functions(precision)

    @wp.kernel(module="unique", enable_backward=False)
    def measure_footprints(
        scene: scene_type,
        camera: camera_type,
        wavelength_nm: real,
        samples: int,
        out_width: wp.array(dtype=real),
    ):
        i = wp.tid()
        step = real(samples)
        ray = ray_type()
        ray.origin = camera.position
        ray.direction = look(
            camera,
            (real(i % samples) + real(0.5)) / step * real(camera.width),
            (real(i // samples) + real(0.5)) / step * real(camera.height),
        )
        # A pixel at the image's corner is smaller in angle: cos²θ of the axis, and 1/cosθ of
        # the distance, leave the distance along the axis.
        forward = wp.normalize(wp.cross(camera.step_down, camera.step_right))
        pixel = wp.length(camera.step_right)
        ray.prim = -1
        ray.face = -1
        indices = media_indices(scene, wavelength_nm)
        axial = real(0.0)
        out_width[i] = real(0.0)
        for _boundary in range(_BOUNDARIES):
            met = interact(scene, ray, indices)
            axial += wp.abs(wp.dot(ray.direction, forward)) * met.t
            if met.event == EVENT_DEPOSIT:
                cos_theta = -wp.dot(ray.direction, met.normal)
                # The footprint is an ellipse: the radius of the disc of equal area.
                out_width[i] = pixel * axial / wp.sqrt(wp.max(cos_theta, real(0.05)))
            if met.event != EVENT_BOUNDARY:
                break
            ray.origin = met.point
            ray.prim = met.prim
            ray.face = met.face
            ray.direction = met.refracted
            if met.reflectance > real(0.5):
                ray.direction = met.reflected

    return measure_footprints


def pixel_footprint(compiled: CompiledScene, camera: Any, wavelength_nm: float) -> float | None:
    """Median width of a pixel on the receivers that the camera sees [m].

    Returns:
        None if no sampled pixel sees a receiver.
    """
    types = compiled.structs
    widths = wp.zeros(_GRID * _GRID, dtype=types.real, device=compiled.device)
    wp.launch(
        make_measure_footprints(compiled.precision, compiled.features),
        dim=_GRID * _GRID,
        inputs=[compiled.data, camera, wavelength_nm, _GRID],
        outputs=[widths],
        device=compiled.device,
    )
    host = widths.numpy()
    seen = host[np.isfinite(host) & (host > 0.0)]
    return float(np.median(seen)) if len(seen) else None
