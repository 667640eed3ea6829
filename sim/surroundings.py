"""Which media meet at a point of a surface, where solids may nest, touch or overlap.

Where several solids claim a point, the one of the highest priority fills it, of equal ones the
first in the scene, so that there is never a doubt, however little they overlap. Nothing is carried
along a path: at each vertex the solids near the surface's own object are asked whether they hold
the point, so that no ray can lose count, wherever it started. Which objects are near another is
known from the start.

Two faces in one place (closer than `Scene.touch`) are one surface. Whichever of them a ray finds
first, it is dealt with once, with the media in front of and behind the pair, and the ray leaves
both. A diffuse or black face in contact with glass hides the glass's own.

Reference:
    Schmidt & Budge (2002), "Simple nested dielectrics in ray traced images", J. Graph. Tools 7(2),
    1: priorities. Their list of the solids that a ray is in is not needed here.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.features import Features
from sim.geometry.height import (
    height_above_flat,
    height_above_lens,
    height_above_polyhedron,
    height_above_sphere,
)
from sim.geometry.mesh_height import height_above_mesh
from sim.scene_structs import (
    DIELECTRIC,
    SHAPE_FLAT,
    SHAPE_LENS,
    SHAPE_MESH,
    SHAPE_POLYHEDRON,
    SHAPE_SPHERE,
    make_scene_structs,
)

__all__ = ["make_surroundings"]

LOWEST = wp.constant(-1)
"""The ambient medium's rank."""


@functools.cache
def make_height_function(precision: str, features: Features) -> object:
    """Device function `height_above(scene, prim, point)`: height [m], face, outward normal."""
    structs = make_scene_structs(precision)
    real, vec3, scene_type = structs.real, structs.vec3, structs.Scene

    @wp.func
    def height_above(scene: scene_type, prim: int, point: vec3):
        body = scene.bodies[prim]
        height = real(wp.inf)
        face = int(0)
        normal = vec3()
        if wp.static(features.spheres):
            if body.shape == SHAPE_SPHERE:
                sphere = scene.spheres[body.row]
                height, normal = height_above_sphere(point - sphere.centre, sphere.radius)
        if wp.static(features.flats):
            if body.shape == SHAPE_FLAT:
                flat = scene.flats[body.row]
                height, normal = height_above_flat(point - flat.centre, flat)
        if wp.static(features.polyhedra):
            if body.shape == SHAPE_POLYHEDRON:
                solid = scene.polyhedra[body.row]
                height, face, normal = height_above_polyhedron(
                    point - solid.centre, scene.planes, solid.first, solid.count
                )
        if wp.static(features.lenses):
            if body.shape == SHAPE_LENS:
                lens = scene.lenses[body.row]
                height, face, normal = height_above_lens(lens, lens.frame * (point - lens.centre))
                normal = wp.transpose(lens.frame) * normal
        if wp.static(features.meshes):
            if body.shape == SHAPE_MESH:
                mesh = scene.meshes.rows[body.row]
                height, face, normal = height_above_mesh(
                    scene.meshes, mesh, point - mesh.centre, scene.touch
                )
        return height, face, normal

    return height_above


@functools.cache
def make_surroundings(precision: str, features: Features) -> SimpleNamespace:
    """Struct Surroundings and device function `surroundings_of(scene, prim, side, point, normal)`.

    Returns:
        A namespace. The struct has the `near` and the `far` medium, on the side that `normal`
        points to and behind it, and of a surface in the same place, if there is one, `prim`
        (else −1), `face` and the unit `normal` toward the near side, on `side` 0 or 1 of it.
    """
    structs = make_scene_structs(precision)
    real, vec3, scene_type = structs.real, structs.vec3, structs.Scene
    height_above = make_height_function(precision, features)

    @wp.struct
    class Surroundings:
        near: int
        far: int
        prim: int
        face: int
        side: int
        normal: vec3

    @wp.func
    def surroundings_of(scene: scene_type, prim: int, side: int, point: vec3, normal: vec3):
        found = Surroundings()
        found.prim = -1
        near_rank = int(LOWEST)
        far_rank = int(LOWEST)
        body = scene.bodies[prim]
        if body.material == DIELECTRIC:
            if side == 1:
                found.near = body.medium_inside
                near_rank = body.rank
            else:
                found.far = body.medium_inside
                far_rank = body.rank
        k = int(0)
        while k < body.neighbour_count:
            other = scene.neighbours[body.neighbour_first + k]
            height, face, up = height_above(scene, other, point)
            if height <= scene.touch:
                ally = scene.bodies[other]
                holds_near = bool(True)
                holds_far = bool(True)
                if height >= -scene.touch:
                    holds_near = wp.dot(up, normal) < real(0.0)
                    holds_far = not holds_near
                    if found.prim < 0 or ally.material != DIELECTRIC:
                        found.prim = other
                        found.face = face
                        found.side = int(0)
                        found.normal = up
                        if holds_near:
                            found.side = int(1)
                            found.normal = -up
                if ally.material == DIELECTRIC:
                    if holds_near and ally.rank > near_rank:
                        found.near = ally.medium_inside
                        near_rank = ally.rank
                    if holds_far and ally.rank > far_rank:
                        found.far = ally.medium_inside
                        far_rank = ally.rank
            k += 1
        return found

    return SimpleNamespace(Surroundings=Surroundings, surroundings_of=surroundings_of)
