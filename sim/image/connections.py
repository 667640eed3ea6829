"""Connections from a receiver to a lamp: which way light would come, and how much. Device side.

A beam's density is Φ/(A Ω) per area of its profile and solid angle; it is drawn over whichever of
the two is the narrower as seen from the receiver.

References:
    Pharr, Jakob & Humphreys (2023), *Physically Based Rendering*, §12.3 to §12.5: points, spots
    and area lights; §6.2.4: a sphere, sampled in the cone it subtends.
"""

import functools

import warp as wp

from sim.features import Features
from sim.photons.cells import make_cell_functions
from sim.photons.densities import make_density_functions
from sim.photons.lamp_structs import BEAM, RECTANGLE_LAMP, SPHERE_LAMP, make_lamp_structs
from sim.sampling.directions import (
    cone_solid_angle,
    sample_cone,
    sample_cosine_hemisphere,
    sample_disk,
    to_world,
)

__all__ = ["make_connection", "make_distant_connection"]

PI = wp.constant(3.141592653589793)


@functools.cache
def make_beam_connection(precision: str, *, masks: bool) -> object:
    """Device function `connect_beam(lamps, emitter, point, u0, u1)`, see `make_connection`."""
    structs = make_lamp_structs(precision)
    real, vec3, emitter_type = structs.real, structs.vec3, structs.Emitter
    cells, lamps_type = make_cell_functions(precision), structs.Lamps
    through_mask, mask_density = cells.through_mask, cells.mask_density

    @wp.func
    def profile_area(emitter: emitter_type):
        if emitter.round == 1:
            return real(PI) * emitter.half_u * emitter.half_v
        return real(4.0) * emitter.half_u * emitter.half_v

    @wp.func
    def profile_point(lamps: lamps_type, emitter: emitter_type, u0: real, u1: real):
        s = u0
        t = u1
        if wp.static(masks):
            if emitter.first_mask >= 0:
                s, t = through_mask(lamps.cdf, lamps.guide, emitter, u0, u1)
        x = s + s - real(1.0)
        y = t + t - real(1.0)
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
    def mask_factor(lamps: lamps_type, emitter: emitter_type, offset: vec3):
        """Of the flux per area at a point of the profile, relative to the mean over it."""
        half = real(0.5)
        s = half + half * wp.dot(offset, emitter.frame[0]) / emitter.half_u
        t = half + half * wp.dot(offset, emitter.frame[1]) / emitter.half_v
        return mask_density(lamps.cdf, emitter, s, t)

    @wp.func
    def reaches(emitter: emitter_type, offset: vec3, ahead: real):
        """False where no ray of the beam can be, which is nearly everywhere."""
        margin = ahead * emitter.widening
        x = wp.abs(wp.dot(offset, emitter.frame[0]))
        y = wp.abs(wp.dot(offset, emitter.frame[1]))
        return x <= emitter.half_u + margin and y <= emitter.half_v + margin

    @wp.func
    def connect_beam(
        lamps: lamps_type, emitter: emitter_type, point: vec3, u0: real, u1: real
    ):
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
                    if wp.static(masks):
                        if emitter.first_mask >= 0:
                            density *= mask_factor(lamps, emitter, offset - way * distance)
            else:
                # The profile is: does its point shine this way?
                line = point - profile_point(lamps, emitter, u0, u1)
                distance = wp.length(line)
                way = line / distance
                chord = way - axis
                if wp.dot(chord, chord) <= real(4.0) * emitter.sin2_half:
                    density = emitter.flux / (solid_angle * distance * distance)
        return way, distance, density

    return connect_beam


@functools.cache
def make_connection(precision: str, features: Features) -> object:
    """Device function `connect(lamps, emitter, point, u0, u1)`.

    Returns:
        The function, which returns the direction from the lamp to the point, the distance [m],
        and the irradiance [W m⁻²] that a surface facing the lamp has there: an estimate whose
        mean over (u0, u1), cosines at the receiver included, is exact.
    """
    structs = make_lamp_structs(precision)
    real, vec3, emitter_type = structs.real, structs.vec3, structs.Emitter
    own_density = make_density_functions(precision, distant=False).own_density
    connect_beam = make_beam_connection(precision, masks=features.masks)
    through_mask, lamps_type = make_cell_functions(precision).through_mask, structs.Lamps

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
    def connect(lamps: lamps_type, emitter: emitter_type, point: vec3, u0: real, u1: real):
        if wp.static(features.beams):
            if emitter.kind == BEAM:
                return connect_beam(lamps, emitter, point, u0, u1)
        if wp.static(features.sphere_lamps):
            if emitter.kind == SPHERE_LAMP:
                return connect_sphere(emitter, point, u0, u1)
        origin = emitter.centre
        if wp.static(features.rectangle_lamps):
            if emitter.kind == RECTANGLE_LAMP:
                s = u0
                t = u1
                if wp.static(features.masks):
                    if emitter.first_mask >= 0:
                        s, t = through_mask(lamps.cdf, lamps.guide, emitter, u0, u1)
                origin += emitter.frame[0] * ((s + s - real(1.0)) * emitter.half_u)
                origin += emitter.frame[1] * ((t + t - real(1.0)) * emitter.half_v)
        line = point - origin
        distance = wp.length(line)
        way = line / distance
        return way, distance, emitter.flux * own_density(emitter, way) / (distance * distance)

    return connect


@functools.cache
def make_distant_connection(precision: str) -> object:
    """Device function `connect_distant(emitter, normal, u0, u1)`.

    It returns the direction in which light comes from afar, and the irradiance that it gives a
    surface of this normal: an estimate whose mean over (u0, u1) is exact.
    """
    structs = make_lamp_structs(precision)
    real, vec3, emitter_type = structs.real, structs.vec3, structs.Emitter

    @wp.func
    def connect_distant(emitter: emitter_type, normal: vec3, u0: real, u1: real):
        if emitter.sin2_half >= real(1.0):
            # From all around: as densely as the cosine has it, E = π L.
            x, y, z = sample_cosine_hemisphere(u0, u1)
            return -to_world(x, y, z, normal), real(PI) * emitter.radiance
        x, y, z = sample_cone(u0, u1, emitter.sin2_half)
        way = to_world(x, y, z, emitter.frame[2])
        full = emitter.radiance * cone_solid_angle(emitter.sin2_half)
        return way, -wp.dot(way, normal) * full

    return connect_distant
