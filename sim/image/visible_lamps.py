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
from sim.optics.absorption import absorbed_fraction
from sim.photons.cells import make_cell_functions
from sim.photons.emitted_light import make_seen_light
from sim.photons.lamp_structs import DISTANT, RECTANGLE_LAMP, SPHERE_LAMP, make_lamp_structs
from sim.polarised_light import make_light
from sim.scene_structs import make_ray_structs, make_scene_structs

__all__ = ["make_see_lamps"]

UNSEEN = wp.constant(-1.0)
"""In place of a distance."""

CLEARANCE = 1.0 - 1e-6
"""A lamp that lies on a surface is in front of it, whatever rounding says."""


@functools.cache
def make_distance_to_lamp(precision: str, *, distant: bool) -> object:
    """Device function `distance_to_lamp(emitter, ray, t)` [m]; negative where it is not seen.

    How far away the part of the lamp is that is seen along the first `t` metres.
    """
    structs = make_lamp_structs(precision)
    real, emitter_type = structs.real, structs.Emitter
    ray_type = make_ray_structs(precision).Ray

    @wp.func
    def distance_to_sphere(emitter: emitter_type, ray: ray_type):
        """Where the ray enters the sphere; from inside there is nothing to be seen of it."""
        offset = ray.origin - emitter.centre
        along = -wp.dot(offset, ray.direction)
        miss = offset + ray.direction * along
        radius2 = emitter.radius * emitter.radius
        half_chord2 = radius2 - wp.dot(miss, miss)
        outside = wp.dot(offset, offset) > radius2
        if along <= real(0.0) or half_chord2 < real(0.0) or not outside:
            return real(UNSEEN)
        return along - wp.sqrt(half_chord2)

    @wp.func
    def distance_to_rectangle(emitter: emitter_type, ray: ray_type):
        """Where the ray crosses the rectangle towards its back: the front is what shines."""
        approach = wp.dot(ray.direction, emitter.frame[2])
        if approach >= real(0.0):
            return real(UNSEEN)
        offset = ray.origin - emitter.centre
        there = -wp.dot(offset, emitter.frame[2]) / approach
        local = emitter.frame * (offset + ray.direction * there)
        if wp.abs(local[0]) > emitter.half_u or wp.abs(local[1]) > emitter.half_v:
            return real(UNSEEN)
        return there

    @wp.func
    def distance_to_sky(emitter: emitter_type, ray: ray_type):
        """Infinite where the ray goes to where the light comes from."""
        chord = ray.direction + emitter.frame[2]
        all_around = emitter.sin2_half >= real(1.0)
        if all_around or wp.dot(chord, chord) <= real(4.0) * emitter.sin2_half:
            return real(wp.inf)
        return real(UNSEEN)

    @wp.func
    def distance_to_lamp(emitter: emitter_type, ray: ray_type, t: real):
        distance = real(UNSEEN)
        if emitter.visible == 1:
            if emitter.kind == SPHERE_LAMP:
                distance = distance_to_sphere(emitter, ray)
            if emitter.kind == RECTANGLE_LAMP:
                distance = distance_to_rectangle(emitter, ray)
            if wp.static(distant):
                if emitter.kind == DISTANT:
                    distance = distance_to_sky(emitter, ray)
        if distance * real(CLEARANCE) > t:
            return real(UNSEEN)
        return distance

    return distance_to_lamp


@functools.cache
def make_see_lamps(precision: str, features: Features) -> object:
    """Device function `see_lamps(lights, ray, met, sight, scale, eye, frame, sums)`.

    It adds `scale` times the radiance, times the bands' width, of all lamps on the ray's way to
    what it has `met` to the bands of the sight's row of `sums`: to all, or to its own. `eye` and
    `frame` are what the path carries, see `sim.polarised_light`.
    """
    structs = make_scene_structs(precision)
    real, ray_type, interaction_type = structs.real, structs.Ray, structs.Interaction
    lights_type, sight_type = make_lights_struct(precision), make_sight_struct(precision)
    lamp_structs = make_lamp_structs(precision)
    lamps_type, emitter_type = lamp_structs.Lamps, lamp_structs.Emitter
    mask_density = make_cell_functions(precision).mask_density
    distance_to_lamp = make_distance_to_lamp(precision, distant=features.distant_lamps)
    mode = features.light_of("camera")
    carried = make_light(precision, mode, polarisers=features.polarisers, towards_eye=True)
    light_type, frame_type = carried.Light, carried.Frame
    seen_light = make_seen_light(precision, features)

    @wp.func
    def mask_factor(lamps: lamps_type, emitter: emitter_type, ray: ray_type, distance: real):
        """Radiance of the rectangle's point at this distance, relative to the mean over it."""
        local = emitter.frame * (ray.origin + ray.direction * distance - emitter.centre)
        half = real(0.5)
        s = half + half * local[0] / emitter.half_u
        t = half + half * local[1] / emitter.half_v
        return mask_density(lamps.cdf, emitter, s, t)

    @wp.func
    def see_lamps(
        lights: lights_type, ray: ray_type, met: interaction_type, sight: sight_type, scale: real,
        eye: light_type, frame: frame_type, sums: wp.array2d(dtype=wp.float64),
    ):
        receivers = lights.receivers
        lamp = int(0)
        while lamp < receivers.lamps:
            emitter = lights.lamps.emitters[lamp]
            distance = distance_to_lamp(emitter, ray, met.t)
            if distance >= real(0.0):
                radiance = scale * emitter.radiance
                if wp.static(features.masks):
                    if emitter.first_mask >= 0:
                        radiance *= mask_factor(lights.lamps, emitter, ray, distance)
                if wp.static(mode == "stokes"):
                    radiance *= seen_light(lights.lamps, lamp, ray.direction, eye, frame)
                if wp.static(features.absorption):
                    radiance -= radiance * absorbed_fraction(met.alpha, distance)
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
