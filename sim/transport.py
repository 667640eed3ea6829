"""One step of light: find the next surface, and say what it does to the ray.

Photons, camera paths and single rays all advance by `interact`, so that a test of Snell's law on
a single ray exercises the code that makes the pictures. `geometry` says where, `optics` says
what; they meet only here.

A solid knows the medium inside it; outside is the ambient one, or where solids may touch or nest,
what `sim.surroundings` finds. Two facts keep rays from slipping: a ray that leaves a surface
excludes that surface (no epsilon), and the same boundary point is reported to both branches of a
split.

Formulas: Snell, Fresnel and Beer–Lambert as cited in `sim.optics`.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.features import Features
from sim.geometry.mesh import facet_normal
from sim.intersection import make_intersect
from sim.optics.absorption import absorbed_fraction
from sim.optics.dielectric import reflect
from sim.optics.dispersion import tabulated_index
from sim.path_media import make_media_functions
from sim.rays import make_ray_functions
from sim.scene_structs import (
    DIELECTRIC,
    LAMBERTIAN,
    METAL,
    MIRROR,
    POLARISER,
    SHAPE_MESH,
    make_scene_structs,
)
from sim.surfaces import make_surfaces
from sim.surroundings import make_surroundings

__all__ = [
    "EVENT_ABSORB",
    "EVENT_BOUNDARY",
    "EVENT_DEPOSIT",
    "EVENT_ESCAPE",
    "EVENT_PASS",
    "make_transport",
]

EVENT_ESCAPE = wp.constant(0)
"""The ray meets nothing more."""
EVENT_BOUNDARY = wp.constant(1)
"""A boundary between two media, where the ray splits, or a mirror or a metal, where it does not."""
EVENT_DEPOSIT = wp.constant(2)
"""A diffuse surface: the photon is stored, the camera path gathers."""
EVENT_ABSORB = wp.constant(3)
"""An absorber: the light ends here."""
EVENT_PASS = wp.constant(4)
"""A face hidden by another solid, the same medium on both sides: the light goes straight on."""


MIN_COSINE = wp.constant(1e-3)
"""A ray that grazes a face is not moved along it any further than one of this cosine."""


@functools.cache
def make_transport(precision: str, features: Features) -> SimpleNamespace:
    """Structs and device functions of one light step.

    Returns:
        A namespace with the structs of `make_scene_structs`, the device functions of
        `make_ray_functions`, and
        `intersect(scene, ray) -> Hit`,
        `media_indices(scene, wavelength_nm)`, `scatter(scene, ray, hit, indices) -> Interaction`,
        `interact(scene, ray, indices)`, which is both in one, `split(interaction)`, and
        `facet_toward(scene, interaction, direction)`, the normal that no smoothing has bent.
    """
    structs = make_scene_structs(precision)
    real, vec3, vec4 = structs.real, structs.vec3, structs.vec4
    scene_type, ray_type = structs.Scene, structs.Ray
    interaction_type, hit_type = structs.Interaction, structs.Hit
    intersect = make_intersect(precision, features)
    media = make_media_functions(precision, features)
    indices_type, absorption_of = media.Indices, media.absorption_of
    wavelength_of = media.wavelength_of
    surroundings_of = make_surroundings(precision, features).surroundings_of
    polarised = features.polarises
    surfaces = make_surfaces(precision, features)
    cross, finish_matrix = surfaces.cross, surfaces.finish

    @wp.func
    def finish_constants(scene: scene_type, finish: int, indices: indices_type, medium: int):
        """A mirror's reflectance and −1, by its table; a metal's n and k, relative to `medium`."""
        row = scene.finishes[finish]
        wavelength_nm = wavelength_of(indices)
        value = tabulated_index(scene.knots_nm, scene.cubics, row.first, row.count, wavelength_nm)
        if row.k_count == 0:
            return value, real(-1.0)
        k = tabulated_index(scene.knots_nm, scene.cubics, row.k_first, row.k_count, wavelength_nm)
        return value / indices[medium], k / indices[medium]

    @wp.func
    def facet_toward(scene: scene_type, met: interaction_type, direction: vec3):
        """The surface's own normal toward the ray, of a mesh with smooth normals the facet's.

        Near grazing a smooth normal can send light through the facet that should reflect it, or
        back from one that it should pass: there the facet's normal rules.
        """
        normal = met.normal
        if scene.bodies[met.prim].shape == SHAPE_MESH:
            normal = facet_normal(scene.meshes, met.face)
            if wp.dot(direction, normal) > real(0.0):
                normal = -normal
        return normal

    @wp.func
    def scatter(scene: scene_type, ray: ray_type, hit: hit_type, indices: indices_type):
        # Structs are filled field by field: a struct assigned whole inside a branch is copied
        # at every merge of the compiled code, which made this step four times slower.
        met = interaction_type()
        met.event = EVENT_ESCAPE
        met.t = hit.t
        met.prim = hit.prim
        met.face = hit.face
        met.prim2 = -1
        if hit.prim >= 0:
            body = scene.bodies[hit.prim]
            normal = hit.normal
            beyond = body.medium_inside
            if wp.dot(ray.direction, normal) > real(0.0):
                normal = -normal
                met.side = 1
                met.medium = body.medium_inside
                beyond = int(0)
            met.point = ray.origin + ray.direction * hit.t
            met.normal = normal
            met.dispersive = body.dispersive
            if wp.static(features.interfaces):
                if body.neighbour_count > 0:
                    found = surroundings_of(scene, hit.prim, met.side, met.point, normal)
                    met.medium = found.near
                    beyond = found.far
                    met.prim2 = found.prim
                    met.face2 = found.face
                    if found.prim >= 0 and body.material == DIELECTRIC:
                        body = scene.bodies[found.prim]
                        if body.material != DIELECTRIC:
                            # What touches the glass is what the light meets.
                            met.prim = found.prim
                            met.face = found.face
                            met.prim2 = hit.prim
                            met.face2 = hit.face
                            met.side = found.side
                            met.normal = found.normal
                            met.dispersive = body.dispersive
            met.part = met.face
            if wp.static(features.meshes):
                if scene.bodies[met.prim].shape == SHAPE_MESH:
                    met.part = scene.meshes.triangles[met.face].patch
            met.event = EVENT_ABSORB
            if body.material == LAMBERTIAN:
                met.event = EVENT_DEPOSIT
            if wp.static(features.boundaries):
                if body.material == DIELECTRIC:
                    met.event = EVENT_BOUNDARY
                    if wp.static(features.interfaces):
                        met.dispersive = (
                            scene.media[met.medium].varies | scene.media[beyond].varies
                        )
                    if met.medium == beyond:
                        met.event = EVENT_PASS
                        met.dispersive = 0
                    eta = indices[met.medium] / indices[beyond]
                    total, matrix, together, reflected, refracted = cross(
                        ray.direction, met.normal, eta
                    )
                    if wp.static(features.meshes):
                        facet = facet_toward(scene, met, ray.direction)
                        passes = total == 1 or wp.dot(refracted, facet) < real(0.0)
                        if not (passes and wp.dot(reflected, facet) > real(0.0)):
                            met.normal = facet
                            total, matrix, together, reflected, refracted = cross(
                                ray.direction, facet, eta
                            )
                    met.eta = eta
                    met.total = total
                    met.reflectance = matrix[0]
                    if wp.static(polarised):
                        met.matrix = matrix
                        met.together = together
                    met.reflected = reflected
                    met.refracted = refracted
            if wp.static(features.interfaces):
                # A third face in the place that the ray has just left has been dealt with there.
                # Behind it, by more than the faces can be apart, no other one is met again.
                if ray.prim >= 0 and hit.prim != ray.prim and body.material == DIELECTRIC:
                    cos_theta = wp.abs(wp.dot(ray.direction, hit.normal))
                    if hit.t * cos_theta <= scene.touch:
                        met.event = EVENT_PASS
                        met.dispersive = 0
                        met.point += ray.direction * (
                            scene.touch / wp.max(cos_theta, real(MIN_COSINE))
                        )
                        met.prim2 = -1
            if wp.static(features.finishes):
                if body.material == MIRROR or body.material == METAL:
                    met.event = EVENT_BOUNDARY
                    cos_theta_i = wp.min(-wp.dot(ray.direction, met.normal), real(1.0))
                    if wp.static(features.meshes):
                        facet = facet_toward(scene, met, ray.direction)
                        glance = reflect(ray.direction, met.normal, cos_theta_i)
                        if wp.dot(glance, facet) <= real(0.0):
                            met.normal = facet
                            cos_theta_i = wp.min(-wp.dot(ray.direction, facet), real(1.0))
                    met.total = 1
                    met.opaque = 1
                    met.eta = real(1.0)
                    met.reflectance = real(1.0)
                    met.reflected = reflect(ray.direction, met.normal, cos_theta_i)
                    met.refracted = met.reflected
                    value, k = finish_constants(scene, body.finish, indices, met.medium)
                    if wp.static(not polarised):
                        met.absorbed = real(1.0) - finish_matrix(cos_theta_i, value, k)[0]
                    if wp.static(polarised):
                        met.matrix = finish_matrix(cos_theta_i, value, k)
            if wp.static(features.polarisers):
                if body.material == POLARISER:
                    met.event = EVENT_BOUNDARY
                    met.filters = 1
                    met.eta = real(1.0)
                    met.reflected = ray.direction
                    met.refracted = ray.direction
                    if wp.static(not polarised):
                        met.absorbed = real(0.5)
                    if wp.static(polarised):
                        met.matrix = vec4(real(0.5), real(-0.5), real(0.0), real(0.0))
        if wp.static(features.absorption):
            met.alpha = absorption_of(indices, met.medium)
            lost = absorbed_fraction(met.alpha, hit.t)
            met.absorbed += lost - lost * met.absorbed
            met.dispersive = met.dispersive | scene.media[met.medium].tints
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
        **vars(make_ray_functions(precision)),
        intersect=intersect,
        media_indices=media.media_indices,
        absorption_of=absorption_of,
        Indices=indices_type,
        facet_toward=facet_toward,
        scatter=scatter,
        interact=interact,
        split=split,
    )
