"""One step of light: find the next surface, and say what it does to the ray.

Photons, camera paths and single rays all advance by `interact`, so that a test of Snell's law on
a single ray exercises the code that makes the pictures. `geometry` says where, `optics` says
what; they meet only here.

A solid knows the medium inside it and the one outside. Two facts keep rays from slipping: a ray
that leaves a surface excludes that surface (no epsilon), and the same boundary point is reported
to both branches of a split.

Formulas: Snell and Fresnel as cited in `sim.optics.dielectric`.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.features import Features
from sim.geometry.flat import intersect_plane, plane_coordinates
from sim.geometry.lens import intersect_lens, lens_normal
from sim.geometry.mesh import facet_normal, intersect_mesh, mesh_normal
from sim.geometry.polyhedron import intersect_polyhedron
from sim.geometry.sphere import intersect_sphere
from sim.optics.dielectric import (
    fresnel_reflectance,
    reflect,
    refract,
    renormalize,
    schlick_reflectance,
    sin2_theta_t,
)
from sim.optics.dispersion import air_index, cauchy_index, sellmeier_index, tabulated_index
from sim.scene_structs import (
    CAUCHY,
    DIELECTRIC,
    LAMBERTIAN,
    SELLMEIER,
    SHAPE_MESH,
    TABULATED,
    make_scene_structs,
)

__all__ = ["EVENT_ABSORB", "EVENT_BOUNDARY", "EVENT_DEPOSIT", "EVENT_ESCAPE", "make_transport"]

EVENT_ESCAPE = wp.constant(0)
"""The ray meets nothing more."""
EVENT_BOUNDARY = wp.constant(1)
"""A boundary between two media: the ray splits."""
EVENT_DEPOSIT = wp.constant(2)
"""A diffuse surface: the photon is stored, the camera path gathers."""
EVENT_ABSORB = wp.constant(3)
"""An absorber: the light ends here."""


@functools.cache
def make_media_function(precision: str, features: Features):
    """Device function `media_indices(scene, wavelength_nm)`: the index of every medium.

    A path keeps its wavelength, so its indices are evaluated once, with only the formulas that
    the scene's media use.
    """
    structs = make_scene_structs(precision)
    real, scene_type = structs.real, structs.Scene
    indices_type = wp.types.vector(length=features.media_count, dtype=real)
    media_count = features.media_count

    @wp.func
    def media_indices(scene: scene_type, wavelength_nm: real):
        wavelength_um = wavelength_nm * real(1e-3)
        indices = indices_type()
        for medium in range(media_count):
            row = scene.media[medium]
            n = real(1.0)
            if wp.static(features.sellmeier):
                if row.formula == SELLMEIER:
                    n = sellmeier_index(scene.coefficients, medium, wavelength_um)
            if wp.static(features.cauchy):
                if row.formula == CAUCHY:
                    n = cauchy_index(scene.coefficients, medium, wavelength_um)
            if wp.static(features.tabulated):
                if row.formula == TABULATED:
                    n = tabulated_index(
                        scene.knots_nm, scene.cubics, row.knot_first, row.knot_count,
                        wavelength_nm,
                    )
            if wp.static(features.air_conversion):
                if row.air_power > 0:
                    n *= air_index(wavelength_um)
                elif row.air_power < 0:
                    n /= air_index(wavelength_um)
            indices[medium] = n
        return indices

    return media_indices


@functools.cache
def make_intersect(precision: str, features: Features):
    """Device function `intersect(scene, ray) -> Hit`, with only the shapes the scene has."""
    structs = make_scene_structs(precision)
    real = structs.real
    scene_type, ray_type, hit_type = structs.Scene, structs.Ray, structs.Hit

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
                t = intersect_sphere(local, ray.direction, sphere.radius, ray.prim == sphere.prim)
                if t >= real(0.0) and t < hit.t:
                    hit.t = t
                    hit.prim = sphere.prim
                    hit.face = 0
                    hit.normal = renormalize(
                        (local + ray.direction * t) * (real(1.0) / sphere.radius)
                    )
                i += 1
        if wp.static(features.flats):
            i = int(0)
            while i < scene.flat_count:
                flat = scene.flats[i]
                if ray.prim != flat.prim:
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
                leaving_face = -1
                if ray.prim == body.prim:
                    leaving_face = ray.face
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
                leaving_face = -1
                if ray.prim == lens.prim:
                    leaving_face = ray.face
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
                leaving_face = -1
                if ray.prim == mesh.prim:
                    leaving_face = ray.face
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


@functools.cache
def make_transport(precision: str, features: Features) -> SimpleNamespace:
    """Structs and device functions of one light step.

    Returns:
        A namespace with the structs of `make_scene_structs` and the device functions
        `intersect(scene, ray) -> Hit`,
        `media_indices(scene, wavelength_nm)`, `scatter(scene, ray, hit, indices) -> Interaction`,
        `interact(scene, ray, indices)`, which is both in one, and `split(interaction)`.
    """
    structs = make_scene_structs(precision)
    real, vec3 = structs.real, structs.vec3
    scene_type, ray_type = structs.Scene, structs.Ray
    interaction_type, hit_type = structs.Interaction, structs.Hit
    intersect = make_intersect(precision, features)
    indices_type = wp.types.vector(length=features.media_count, dtype=real)
    media_indices = make_media_function(precision, features)

    @wp.func
    def cross_boundary(direction: vec3, normal: vec3, eta: real):
        """Total or not, reflectance, and the two directions at a boundary of relative index η."""
        cos_theta_i = wp.min(-wp.dot(direction, normal), real(1.0))
        reflected = reflect(direction, normal, cos_theta_i)
        if wp.static(not features.reflected_branches):
            return 0, real(0.0), reflected, direction
        if eta == real(1.0):
            return 0, real(0.0), reflected, direction  # exactly, at any angle
        sin2_t = sin2_theta_t(cos_theta_i, eta)
        if sin2_t >= real(1.0):
            return 1, real(1.0), reflected, reflected
        cos_theta_t = wp.sqrt(real(1.0) - sin2_t)
        reflectance = real(0.0)
        if wp.static(features.method.fresnel == "exact"):
            r_s, r_p = fresnel_reflectance(cos_theta_i, cos_theta_t, eta)
            reflectance = real(0.5) * (r_s + r_p)
        if wp.static(features.method.fresnel == "schlick"):
            reflectance = schlick_reflectance(cos_theta_i, cos_theta_t, eta)
        refracted = refract(direction, normal, cos_theta_i, cos_theta_t, eta)
        return 0, reflectance, reflected, refracted

    @wp.func
    def scatter(scene: scene_type, ray: ray_type, hit: hit_type, indices: indices_type):
        # Structs are filled field by field: a struct assigned whole inside a branch is copied
        # at every merge of the compiled code, which made this step four times slower.
        met = interaction_type()
        met.event = EVENT_ESCAPE
        met.t = hit.t
        met.prim = hit.prim
        met.face = hit.face
        if hit.prim >= 0:
            body = scene.bodies[hit.prim]
            normal = hit.normal
            if wp.dot(ray.direction, normal) > real(0.0):
                normal = -normal
                met.side = 1
            met.point = ray.origin + ray.direction * hit.t
            met.normal = normal
            met.event = EVENT_ABSORB
            if body.material == LAMBERTIAN:
                met.event = EVENT_DEPOSIT
            if wp.static(features.boundaries):
                if body.material == DIELECTRIC:
                    met.event = EVENT_BOUNDARY
                    met.dispersive = body.dispersive
                    eta = indices[body.medium_outside] / indices[body.medium_inside]
                    if met.side == 1:
                        eta = indices[body.medium_inside] / indices[body.medium_outside]
                    total, reflectance, reflected, refracted = cross_boundary(
                        ray.direction, normal, eta
                    )
                    if wp.static(features.meshes):
                        if body.shape == SHAPE_MESH:
                            # Near grazing a smooth normal can send light through the facet that
                            # should reflect it, or back that should pass: then the facet's rules.
                            facet = facet_normal(scene.meshes, hit.face)
                            if met.side == 1:
                                facet = -facet
                            if wp.dot(reflected, facet) <= real(0.0) or (
                                total == 0 and wp.dot(refracted, facet) >= real(0.0)
                            ):
                                met.normal = facet
                                total, reflectance, reflected, refracted = cross_boundary(
                                    ray.direction, facet, eta
                                )
                    met.eta = eta
                    met.total = total
                    met.reflectance = reflectance
                    met.reflected = reflected
                    met.refracted = refracted
        return met

    @wp.func
    def interact(scene: scene_type, ray: ray_type, indices: indices_type):
        return scatter(scene, ray, intersect(scene, ray), indices)

    @wp.func
    def split(met: interaction_type):
        """Directions of the stronger and the weaker branch; 1 if the stronger one refracts."""
        if met.reflectance > real(0.5):
            return met.reflected, met.refracted, 0
        return met.refracted, met.reflected, 1

    return SimpleNamespace(
        **vars(structs),
        intersect=intersect,
        media_indices=media_indices,
        scatter=scatter,
        interact=interact,
        split=split,
    )
