"""Where a ray meets the scene: the nearest of all surfaces, by the shapes that the scene has.

A ray that leaves a surface excludes that surface, and a second one in the same place; no epsilon.
"""

import functools

import warp as wp

from sim.features import Features
from sim.geometry.flat import intersect_plane, plane_coordinates
from sim.geometry.lens import intersect_lens, lens_normal
from sim.geometry.mesh import intersect_mesh, mesh_normal
from sim.geometry.polyhedron import intersect_polyhedron
from sim.geometry.sphere import intersect_sphere
from sim.scene_structs import make_scene_structs

__all__ = ["make_intersect"]


@functools.cache
def make_intersect(precision: str, features: Features):
    """Device function `intersect(scene, ray) -> Hit`, with only the shapes the scene has."""
    structs = make_scene_structs(precision)
    real = structs.real
    scene_type, ray_type, hit_type = structs.Scene, structs.Ray, structs.Hit

    @wp.func
    def leaves(ray: ray_type, prim: int):
        if wp.static(features.interfaces):
            return ray.prim == prim or ray.prim2 == prim
        return ray.prim == prim

    @wp.func
    def face_left(ray: ray_type, prim: int):
        """The face of `prim` that the ray has just left, or −1."""
        face = int(-1)
        if ray.prim == prim:
            face = ray.face
        if wp.static(features.interfaces):
            if ray.prim2 == prim:
                face = ray.face2
        return face

    @wp.func
    def intersect(scene: scene_type, ray: ray_type):
        # `while`, not `for`: see `intersect_polyhedron`.
        hit = hit_type()
        hit.t = real(wp.inf)
        hit.prim = -1
        if wp.static(features.spheres):
            i = int(0)
            while i < scene.sphere_count:
                sphere = scene.spheres[i]
                local = ray.origin - sphere.centre
                t = intersect_sphere(
                    local, ray.direction, sphere.radius, leaves(ray, sphere.prim)
                )
                if t >= real(0.0) and t < hit.t:
                    hit.t = t
                    hit.prim = sphere.prim
                    hit.face = 0
                    # From afar the point is off the sphere by ε of the way, and can be anywhere.
                    outward = local + ray.direction * t
                    if wp.dot(outward, outward) == real(0.0):
                        outward = -ray.direction
                    hit.normal = wp.normalize(outward)
                i += 1
        if wp.static(features.flats):
            i = int(0)
            while i < scene.flat_count:
                flat = scene.flats[i]
                if not leaves(ray, flat.prim):
                    local = ray.origin - flat.centre
                    normal = flat.frame[2]
                    t = intersect_plane(local, ray.direction, normal)
                    if t >= real(0.0) and t < hit.t:
                        u, v = plane_coordinates(local + ray.direction * t, flat.frame)
                        inside = wp.abs(u) <= flat.half_u and wp.abs(v) <= flat.half_v
                        if inside and u * u + v * v <= flat.radius2:
                            hit.t = t
                            hit.prim = flat.prim
                            hit.face = 0
                            hit.normal = normal
                i += 1
        if wp.static(features.polyhedra):
            i = int(0)
            while i < scene.polyhedron_count:
                body = scene.polyhedra[i]
                leaving_face = face_left(ray, body.prim)
                t, face = intersect_polyhedron(
                    ray.origin - body.centre, ray.direction, scene.planes, body.first,
                    body.count, leaving_face,
                )
                if t >= real(0.0) and t < hit.t:
                    hit.t = t
                    hit.prim = body.prim
                    hit.face = face
                    hit.normal = scene.planes[face].normal
                i += 1
        if wp.static(features.lenses):
            i = int(0)
            while i < scene.lens_count:
                lens = scene.lenses[i]
                leaving_face = face_left(ray, lens.prim)
                origin = lens.frame * (ray.origin - lens.centre)
                direction = lens.frame * ray.direction
                t, face = intersect_lens(lens, origin, direction, leaving_face)
                if t >= real(0.0) and t < hit.t:
                    hit.t = t
                    hit.prim = lens.prim
                    hit.face = face
                    normal = lens_normal(lens, face, origin + direction * t)
                    hit.normal = wp.normalize(wp.transpose(lens.frame) * normal)
                i += 1
        if wp.static(features.meshes):
            i = int(0)
            while i < scene.meshes.count:
                mesh = scene.meshes.rows[i]
                leaving_face = face_left(ray, mesh.prim)
                local = ray.origin - mesh.centre
                t, face = intersect_mesh(
                    scene.meshes, mesh, local, ray.direction, leaving_face, hit.t
                )
                if t >= real(0.0) and t < hit.t:
                    hit.t = t
                    hit.prim = mesh.prim
                    hit.face = face
                    hit.normal = mesh_normal(
                        scene.meshes, mesh, face, local + ray.direction * t, ray.direction
                    )
                i += 1
        return hit

    return intersect
