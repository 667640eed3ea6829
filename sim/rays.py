"""Rays as they set out: from nowhere, or from the surface that they have just met."""

import functools
from types import SimpleNamespace

import warp as wp

from sim.scene_structs import make_scene_structs

__all__ = ["make_ray_functions"]


@functools.cache
def make_ray_functions(precision: str) -> SimpleNamespace:
    """Device functions that make a Ray.

    Returns:
        A namespace with `free_ray(origin, direction)`, of a ray that has left no surface, and
        `leaving_ray(met, direction)`, of one that leaves what `met` is about. A ray that goes on
        inside a loop is changed field by field instead: see `scatter` in `sim.transport`.
    """
    structs = make_scene_structs(precision)
    vec3, ray_type, met_type = structs.vec3, structs.Ray, structs.Interaction

    @wp.func
    def free_ray(origin: vec3, direction: vec3):
        ray = ray_type()
        ray.origin = origin
        ray.direction = direction
        ray.prim = -1
        ray.face = -1
        ray.prim2 = -1
        return ray

    @wp.func
    def leaving_ray(met: met_type, direction: vec3):
        ray = ray_type()
        ray.origin = met.point
        ray.direction = direction
        ray.prim = met.prim
        ray.face = met.face
        ray.prim2 = met.prim2
        ray.face2 = met.face2
        return ray

    return SimpleNamespace(free_ray=free_ray, leaving_ray=leaving_ray)
