"""Lamps that a camera path meets on its way, and sees.

A lamp is light without matter: it adds its radiance to what is behind it, for shadow rays and
photons pass through it as well. What lamps send to receivers is none of a camera path's concern,
so that no light is counted twice: here are the paths from lamp to camera on which there is nothing
but glass and mirrors, there those on which there is a receiver too.

Reference:
    Heckbert (1990), "Adaptive radiosity textures for bidirectional ray tracing", SIGGRAPH, §2:
    paths told apart by what is on them; here L S* E.
"""

import functools

import warp as wp

from sim.features import Features
from sim.image.sight import ALL_BANDS, make_lights_struct, make_sight_struct
from sim.photons.lamp_structs import DISTANT, RECTANGLE_LAMP, SPHERE_LAMP, make_lamp_structs
from sim.scene_structs import make_ray_structs

__all__ = ["make_see_lamps"]

CLEARANCE = 1.0 - 1e-6
"""A lamp that lies on a surface is in front of it, whatever rounding says."""


@functools.cache
def make_lamp_radiance(precision: str, *, distant: bool) -> object:
    """Device function `lamp_radiance(emitter, ray, t)` [W m⁻² sr⁻¹].

    What the lamp adds, over its whole spectrum, to what is seen along the first `t` metres.
    """
    structs = make_lamp_structs(precision)
    real, emitter_type = structs.real, structs.Emitter
    ray_type = make_ray_structs(precision).Ray

    @wp.func
    def meets_sphere(emitter: emitter_type, ray: ray_type, t: real):
        """Whether the ray enters the sphere; from inside there is nothing to be seen of it."""
        offset = ray.origin - emitter.centre
        along = -wp.dot(offset, ray.direction)
        miss = offset + ray.direction * along
        radius2 = emitter.radius * emitter.radius
        half_chord2 = radius2 - wp.dot(miss, miss)
        outside = wp.dot(offset, offset) > radius2
        if along <= real(0.0) or half_chord2 < real(0.0) or not outside:
            return False
        return (along - wp.sqrt(half_chord2)) * real(CLEARANCE) <= t

    @wp.func
    def meets_rectangle(emitter: emitter_type, ray: ray_type, t: real):
        """Whether the ray crosses the rectangle towards its back: the front is what shines."""
        approach = wp.dot(ray.direction, emitter.frame[2])
        if approach >= real(0.0):
            return False
        offset = ray.origin - emitter.centre
        there = -wp.dot(offset, emitter.frame[2]) / approach
        if there <= real(0.0) or there * real(CLEARANCE) > t:
            return False
        local = emitter.frame * (offset + ray.direction * there)
        return wp.abs(local[0]) <= emitter.half_u and wp.abs(local[1]) <= emitter.half_v

    @wp.func
    def meets_distant(emitter: emitter_type, ray: ray_type, t: real):
        """Whether the ray escapes to where the light comes from."""
        chord = ray.direction + emitter.frame[2]
        inside = emitter.sin2_half >= real(1.0)
        inside = inside or wp.dot(chord, chord) <= real(4.0) * emitter.sin2_half
        return inside and t == real(wp.inf)

    @wp.func
    def lamp_radiance(emitter: emitter_type, ray: ray_type, t: real):
        seen = bool(False)
        if emitter.visible == 1:
            if emitter.kind == SPHERE_LAMP:
                seen = meets_sphere(emitter, ray, t)
            if emitter.kind == RECTANGLE_LAMP:
                seen = meets_rectangle(emitter, ray, t)
            if wp.static(distant):
                if emitter.kind == DISTANT:
                    seen = meets_distant(emitter, ray, t)
        if seen:
            return emitter.radiance
        return real(0.0)

    return lamp_radiance


@functools.cache
def make_see_lamps(precision: str, features: Features) -> object:
    """Device function `see_lamps(lights, ray, t, sight, scale, sums)`.

    It adds `scale` times the radiance, times the bands' width, of all lamps that are met along the
    first `t` metres of the ray to the bands of the sight's row of `sums`: to all, or to its own.
    """
    real = make_lamp_structs(precision).real
    lights_type, sight_type = make_lights_struct(precision), make_sight_struct(precision)
    ray_type = make_ray_structs(precision).Ray
    lamp_radiance = make_lamp_radiance(precision, distant=features.distant_lamps)

    @wp.func
    def see_lamps(
        lights: lights_type, ray: ray_type, t: real, sight: sight_type, scale: real,
        sums: wp.array2d(dtype=wp.float64),
    ):
        receivers = lights.receivers
        lamp = int(0)
        while lamp < receivers.lamps:
            radiance = scale * lamp_radiance(lights.lamps.emitters[lamp], ray, t)
            if radiance > real(0.0):
                band = int(sight.band)
                last = int(sight.band)
                if sight.band == ALL_BANDS:
                    band = 0
                    last = receivers.bands - 1
                while band <= last:
                    sums[sight.row, band] += wp.float64(radiance * receivers.share[lamp, band])
                    band += 1
            lamp += 1

    return see_lamps
