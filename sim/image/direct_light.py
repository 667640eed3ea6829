"""Direct light: what a receiver gets straight from a lamp, by a shadow ray.

Light that meets nothing between lamp and receiver needs no photon: the lamp's radiance, the
geometry and one ray to see whether the way is free give its irradiance without a kernel's bias,
and for a lamp without extent without noise. Whatever is in the way stops it, glass too: light
that has met glass belongs to the photons, and no light is counted twice.

A beam's density is Φ/(A Ω) per area of its profile and solid angle; it is drawn over whichever of
the two is the narrower as seen from the receiver.

References:
    Jensen (1996), "Global illumination using photon maps", §4.1: direct light by ray tracing.
    Pharr, Jakob & Humphreys (2023), *Physically Based Rendering*, §12.3 to §12.5: points, spots
    and area lights; §6.2.4: a sphere, sampled in the cone it subtends.
"""

import functools

import warp as wp

from sim.features import Features
from sim.image.sight import make_sight_struct
from sim.optics.absorption import absorbed_fraction
from sim.photons.densities import make_density_functions
from sim.photons.lamp_structs import (
    BEAM,
    POINT,
    RECTANGLE_LAMP,
    SPHERE_LAMP,
    SPOT,
    make_lamp_structs,
)
from sim.sampling.counter import hash64
from sim.sampling.directions import cone_solid_angle, sample_cone, sample_disk, to_world
from sim.sampling.kronecker import r2_point
from sim.scene_structs import make_scene_structs
from sim.transport import make_transport

__all__ = ["make_direct_light"]

CLEARANCE = 1.0 - 1e-6
"""A shadow ray ends this part of its way to the lamp, so that what the lamp lies on is no shade."""

PI = wp.constant(3.141592653589793)


@functools.cache
def make_beam_connection(precision: str) -> object:
    """Device function `connect_beam(emitter, point, u0, u1)`, see `make_connection`."""
    structs = make_lamp_structs(precision)
    real, vec3, emitter_type = structs.real, structs.vec3, structs.Emitter

    @wp.func
    def profile_area(emitter: emitter_type):
        if emitter.round == 1:
            return real(PI) * emitter.half_u * emitter.half_v
        return real(4.0) * emitter.half_u * emitter.half_v

    @wp.func
    def profile_point(emitter: emitter_type, u0: real, u1: real):
        x = u0 + u0 - real(1.0)
        y = u1 + u1 - real(1.0)
        if emitter.round == 1:
            x, y = sample_disk(u0, u1)
        return emitter.centre + (
            emitter.frame[0] * (x * emitter.half_u) + emitter.frame[1] * (y * emitter.half_v)
        )

    @wp.func
    def inside_profile(emitter: emitter_type, offset: vec3):
        x = wp.dot(offset, emitter.frame[0]) / emitter.half_u
        y = wp.dot(offset, emitter.frame[1]) / emitter.half_v
        if emitter.round == 1:
            return x * x + y * y <= real(1.0)
        return wp.abs(x) <= real(1.0) and wp.abs(y) <= real(1.0)

    @wp.func
    def reaches(emitter: emitter_type, offset: vec3, ahead: real):
        """False where no ray of the beam can be, which is nearly everywhere."""
        margin = ahead * emitter.widening
        x = wp.abs(wp.dot(offset, emitter.frame[0]))
        y = wp.abs(wp.dot(offset, emitter.frame[1]))
        return x <= emitter.half_u + margin and y <= emitter.half_v + margin

    @wp.func
    def connect_beam(emitter: emitter_type, point: vec3, u0: real, u1: real):
        axis = emitter.frame[2]
        offset = point - emitter.centre
        ahead = wp.dot(offset, axis)
        density = real(0.0)
        way = axis
        distance = ahead
        if ahead > real(0.0) and reaches(emitter, offset, ahead):
            area = profile_area(emitter)
            solid_angle = cone_solid_angle(emitter.sin2_half)
            if area >= solid_angle * ahead * ahead:
                # The cone of directions is the narrower: does its ray come out of the profile?
                x, y, z = sample_cone(u0, u1, emitter.sin2_half)
                way = to_world(x, y, z, axis)
                distance = ahead / wp.dot(way, axis)
                if inside_profile(emitter, offset - way * distance):
                    density = emitter.flux / (area * wp.dot(way, axis))
            else:
                # The profile is: does its point shine this way?
                line = point - profile_point(emitter, u0, u1)
                distance = wp.length(line)
                way = line / distance
                chord = way - axis
                if wp.dot(chord, chord) <= real(4.0) * emitter.sin2_half:
                    density = emitter.flux / (solid_angle * distance * distance)
        return way, distance, density

    return connect_beam


@functools.cache
def make_connection(precision: str, features: Features) -> object:
    """Device function `connect(emitter, point, u0, u1)`.

    Returns:
        The function, which returns the direction from the lamp to the point, the distance [m],
        and the irradiance [W m⁻²] that a surface facing the lamp has there: an estimate whose
        mean over (u0, u1), cosines at the receiver included, is exact.
    """
    structs = make_lamp_structs(precision)
    real, vec3, emitter_type = structs.real, structs.vec3, structs.Emitter
    own_density = make_density_functions(precision).own_density
    connect_beam = make_beam_connection(precision)

    @wp.func
    def connect_sphere(emitter: emitter_type, point: vec3, u0: real, u1: real):
        offset = point - emitter.centre
        distance2 = wp.dot(offset, offset)
        radius2 = emitter.radius * emitter.radius
        way = offset
        distance = real(0.0)
        irradiance = real(0.0)
        if distance2 > radius2:
            two_cos2_half = real(1.0) + wp.sqrt(real(1.0) - radius2 / distance2)
            sin2_half = radius2 / (distance2 * (two_cos2_half + two_cos2_half))
            x, y, z = sample_cone(u0, u1, sin2_half)
            way = to_world(x, y, z, wp.normalize(offset))
            along = wp.dot(offset, way)
            miss = offset - way * along
            distance = along - wp.sqrt(wp.max(radius2 - wp.dot(miss, miss), real(0.0)))
            # A Lambertian sphere has Φ = 4π² R² L, and E = L Ω with Ω = 4π sin²(θ/2).
            irradiance = emitter.flux / (real(2.0) * real(PI) * distance2 * two_cos2_half)
        return way, distance, irradiance

    @wp.func
    def connect(emitter: emitter_type, point: vec3, u0: real, u1: real):
        if wp.static(features.beams):
            if emitter.kind == BEAM:
                return connect_beam(emitter, point, u0, u1)
        if wp.static(features.sphere_lamps):
            if emitter.kind == SPHERE_LAMP:
                return connect_sphere(emitter, point, u0, u1)
        origin = emitter.centre
        if wp.static(features.rectangle_lamps):
            if emitter.kind == RECTANGLE_LAMP:
                origin += emitter.frame[0] * ((u0 + u0 - real(1.0)) * emitter.half_u)
                origin += emitter.frame[1] * ((u1 + u1 - real(1.0)) * emitter.half_v)
        line = point - origin
        distance = wp.length(line)
        way = line / distance
        return way, distance, emitter.flux * own_density(emitter, way) / (distance * distance)

    return connect


@functools.cache
def make_direct_light(precision: str, features: Features) -> object:
    """Device function `direct_irradiance(scene, lamps, row, met, sight)` [W m⁻²].

    The irradiance from emitter `row` on the side of the receiver that `met` shows, the mean over
    the sight's shadow rays.
    """
    structs, lamp_structs = make_scene_structs(precision), make_lamp_structs(precision)
    real, scene_type, interaction_type = structs.real, structs.Scene, structs.Interaction
    ray_type, lamps_type = structs.Ray, lamp_structs.Lamps
    sight_type = make_sight_struct(precision)
    connect = make_connection(precision, features)
    intersect = make_transport(precision, features).intersect

    @wp.func
    def direct_irradiance(
        scene: scene_type, lamps: lamps_type, row: int, met: interaction_type, sight: sight_type,
    ):
        emitter = lamps.emitters[row]
        key = hash64(sight.lamp_key, wp.uint64(row))
        rays = int(sight.shadow_rays)
        if emitter.kind == POINT or emitter.kind == SPOT:
            rays = int(1)
        total = real(0.0)
        k = int(0)
        while k < rays:
            index = wp.uint32(sight.sample * rays + k)
            u0, u1 = r2_point(key, index, total)
            way, distance, irradiance = connect(emitter, met.point, u0, u1)
            irradiance *= -wp.dot(way, met.normal)
            if irradiance > real(0.0):
                ray = ray_type()
                ray.origin = met.point
                ray.direction = -way
                ray.prim = met.prim
                ray.face = met.face
                ray.prim2 = met.prim2
                ray.face2 = met.face2
                hit = intersect(scene, ray)
                if hit.prim < 0 or hit.t >= distance * real(CLEARANCE):
                    if wp.static(features.absorption):
                        irradiance -= irradiance * absorbed_fraction(met.alpha, distance)
                    total += irradiance
            k += 1
        return total / real(rays)

    return direct_irradiance
