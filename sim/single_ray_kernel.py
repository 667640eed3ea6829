"""The kernel that follows single rays, and the names of what can happen to them."""

import functools
from typing import Any

import warp as wp

from sim.features import Features
from sim.polarised_light import make_light
from sim.transport import (
    EVENT_ABSORB,
    EVENT_BOUNDARY,
    EVENT_DEPOSIT,
    EVENT_PASS,
    make_transport,
)

__all__ = ["EVENT_NAMES", "REFLECT", "REFRACT", "make_trace_single"]

_ESCAPE = 0
REFRACT = 1
REFLECT = 2
_TOTAL = 3
_DEPOSIT = 4
_ABSORB = 5
_MIRROR = 6
_PASS = 7
_POLARISE = 8
EVENT_NAMES = (
    "escape", "refract", "reflect", "total internal reflection", "deposit", "absorb", "mirror",
    "pass", "polarise",
)  # fmt: skip


@functools.cache
def make_trace_single(precision: str, features: Features) -> Any:
    """Kernel that follows one ray a thread and records its vertices.

    All rays start with the same light, (q, u, v) with angles counted from each one's own `ups`; it
    is followed by Stokes vectors, which the features must say.
    """
    transport = make_transport(precision, features)
    real, vec3, interact = transport.real, transport.vec3, transport.interact
    media_indices = transport.media_indices
    scene_type, free_ray = transport.Scene, transport.free_ray
    assert features.light_of("photons") == "stokes"
    carried = make_light(precision, "stokes", polarisers=features.polarisers)
    start, turn, judge, send = carried.start, carried.turn, carried.judge, carried.send

    @wp.kernel(module="unique", enable_backward=False)
    def trace_single(
        scene: scene_type,
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        wavelengths_nm: wp.array(dtype=real),
        reflects: wp.array(dtype=int),
        start_light: vec3,
        ups: wp.array(dtype=vec3),
        out_points: wp.array2d(dtype=vec3),
        out_directions: wp.array2d(dtype=vec3),
        out_events: wp.array2d(dtype=int),
        out_prims: wp.array2d(dtype=int),
        out_reflectances: wp.array2d(dtype=real),
        out_absorbed: wp.array2d(dtype=real),
        out_light: wp.array2d(dtype=vec3),
        out_frames: wp.array2d(dtype=vec3),
        out_normals: wp.array2d(dtype=vec3),
        out_counts: wp.array(dtype=int),
    ):
        i = wp.tid()
        ray = free_ray(origins[i], wp.normalize(directions[i]))
        indices = media_indices(scene, wavelengths_nm[i])
        light, frame = start(start_light, ups[i], ray.direction)
        count = int(0)
        boundaries = int(0)
        for step in range(out_events.shape[1]):
            met = interact(scene, ray, indices)
            out_light[i, step] = light
            out_frames[i, step] = frame
            if met.event == EVENT_BOUNDARY:
                light, frame = turn(scene, met, ray.direction, light, frame)
                reflectance, absorbed = judge(met, light)
                met.reflectance = reflectance
                met.absorbed = absorbed
            out_directions[i, step] = ray.direction
            out_points[i, step] = met.point
            out_prims[i, step] = met.prim
            out_normals[i, step] = met.normal
            out_absorbed[i, step] = met.absorbed
            count += 1
            ray.origin = met.point
            ray.prim = met.prim
            ray.face = met.face
            ray.prim2 = met.prim2
            ray.face2 = met.face2
            if met.event == EVENT_PASS:
                out_events[i, step] = _PASS
            elif met.event != EVENT_BOUNDARY:
                out_events[i, step] = _ESCAPE
                if met.event == EVENT_DEPOSIT:
                    out_events[i, step] = _DEPOSIT
                elif met.event == EVENT_ABSORB:
                    out_events[i, step] = _ABSORB
                break
            else:
                out_reflectances[i, step] = met.reflectance
                refracts = int(1)
                out_events[i, step] = REFRACT
                if met.filters == 1:
                    out_events[i, step] = _POLARISE
                elif met.total == 1:
                    out_events[i, step] = _TOTAL
                    if met.opaque == 1:
                        out_events[i, step] = _MIRROR
                    refracts = 0
                elif boundaries < reflects.shape[0]:
                    if reflects[boundaries] == 1:
                        out_events[i, step] = REFLECT
                        refracts = 0
                if met.filters == 0:
                    boundaries += 1
                ray.direction = met.refracted
                if refracts == 0:
                    ray.direction = met.reflected
                light = send(met, light, refracts)
        out_counts[i] = count

    return trace_single
