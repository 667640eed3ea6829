"""Photons leave their lamps: position, direction, wavelength and flux, device side.

A lamp sends photons by several *targets* at once: as it radiates by nature, into the cone around
each specular object, onto each receiver. Target j gets n_j photons with density p_j; a photon
in direction ω carries the lamp's flux times ``f(ω) / Σ_j n_j p_j(ω)``, where f is the lamp's own
density. Overlapping targets are thereby counted once, wherever a photon came from, and its flux
is bounded by that of unaimed emission.

The two numbers that choose a direction, or the point of a beam's profile, are drawn from the
target's density over their square, where it has one: as densely as the camera looks at a receiver,
or as a pilot has found (`sim.photons.guidance`). It is part of p_j.

References:
    Veach & Guibas (1995), "Optimally combining sampling techniques", SIGGRAPH, §3.3 eq. (12):
    the balance heuristic over several techniques.
    Press et al. (2007), *Numerical Recipes*, §7.3.2: inversion of a distribution function.
"""

import functools

import warp as wp

from sim.features import Features
from sim.photons.cells import make_cell_functions
from sim.photons.densities import make_density_functions
from sim.photons.distant import make_distant_functions
from sim.photons.lamp_structs import (
    AIM_AREA,
    AIM_CONE,
    BEAM,
    DISTANT,
    RECTANGLE_LAMP,
    SPHERE_LAMP,
    SPOT,
    make_lamp_structs,
)
from sim.sampling.directions import (
    sample_cone,
    sample_cosine_hemisphere,
    sample_disk,
    sample_sphere,
    to_world,
)
from sim.sampling.photon_numbers import make_photon_numbers
from sim.scene_structs import make_ray_structs

__all__ = ["make_emission", "make_wavelength_function"]

EVERYTHING = Features()


@functools.cache
def make_wavelength_function(precision: str) -> object:
    """Device function `sample_wavelength(lamps, emitter, u)` [nm], density as the spectrum."""
    structs = make_lamp_structs(precision)
    real, lamps_type, emitter_type = structs.real, structs.Lamps, structs.Emitter
    locate = make_cell_functions(precision).locate

    @wp.func
    def sample_wavelength(lamps: lamps_type, emitter: emitter_type, u: real):
        cell, v = locate(
            lamps.cdf, lamps.guide, emitter.first_cdf, emitter.segment_count, u
        )
        segment = lamps.segments[emitter.first_segment + cell]
        if segment.width_nm == real(0.0):
            return segment.wavelength_nm
        v = wp.clamp(v, real(0.0), real(1.0))
        d0 = segment.density_low
        d1 = segment.density_high
        # Root of d0 x + (d1 − d0) x²/2 = v (d0 + d1)/2 that survives d0 = d1.
        root = wp.sqrt(wp.max(d0 * d0 + v * (d1 - d0) * (d1 + d0), real(0.0)))
        return segment.wavelength_nm + segment.width_nm * v * (d0 + d1) / (d0 + root)

    return sample_wavelength


@functools.cache
def make_direction_function(precision: str, *, distant: bool) -> object:
    """Device function `sample_direction(emitter, target, origin, u0, u1)`, unit."""
    structs = make_lamp_structs(precision)
    real, vec3 = structs.real, structs.vec3
    emitter_type, target_type = structs.Emitter, structs.Target
    densities = make_density_functions(precision, distant=distant)
    cone_of, cone_axis = densities.cone_of, densities.cone_axis

    @wp.func
    def sample_direction(
        emitter: emitter_type, target: target_type, origin: vec3, u0: real, u1: real
    ):
        axis = emitter.frame[2]
        if target.kind == AIM_CONE:
            sin2_half = cone_of(target, origin)
            x, y, z = sample_cone(u0, u1, sin2_half)
            if sin2_half >= real(1.0):
                return vec3(x, y, z)
            return to_world(x, y, z, cone_axis(target, origin, sin2_half))
        if emitter.kind == RECTANGLE_LAMP:
            x, y, z = sample_cosine_hemisphere(u0, u1)
            return to_world(x, y, z, axis)
        if emitter.kind == SPOT or emitter.kind == BEAM:
            x, y, z = sample_cone(u0, u1, emitter.sin2_half)
            return to_world(x, y, z, axis)
        x, y, z = sample_sphere(u0, u1)
        return vec3(x, y, z)

    return sample_direction


@functools.cache
def make_line_function(precision: str, *, distant: bool, masks: bool) -> object:
    """Device function `sample_line(lamps, emitter, target, u0, u1, u3, u4)`: (origin, direction).

    The first two numbers choose what is aimed at, the last two the point of the lamp. Points of
    a receiver are drawn before the lamp's, so that photons land as evenly as the numbers are.
    """
    structs = make_lamp_structs(precision)
    real, vec3 = structs.real, structs.vec3
    emitter_type, target_type = structs.Emitter, structs.Target
    sample_direction = make_direction_function(precision, distant=distant)
    sample_distant = make_distant_functions(precision).sample_distant
    through_mask, lamps_type = make_cell_functions(precision).through_mask, structs.Lamps

    @wp.func
    def point_of_sphere(emitter: emitter_type, way: vec3, u3: real, u4: real):
        """A point of the lamp with the cosine about `way`: a uniform disk, lifted."""
        x, y = sample_disk(u3, u4)
        depth = wp.sqrt(wp.max(real(1.0) - x * x - y * y, real(0.0)))
        return emitter.centre + to_world(x, y, depth, way) * emitter.radius

    @wp.func
    def line_through(emitter: emitter_type, way: vec3, pivot: real, u3: real, u4: real):
        """A line from the lamp through the point that lies `pivot` along `way` from its centre."""
        sine = emitter.radius / pivot
        sin2 = sine * sine
        sin2_half = sin2 / (real(2.0) * (real(1.0) + wp.sqrt(real(1.0) - sin2)))
        x, y, z = sample_cone(u3, u4, sin2_half)
        direction = to_world(x, y, z, way)
        depth = wp.sqrt(wp.max(sin2 - x * x - y * y, real(0.0)))
        return emitter.centre + (way - direction * (z - depth)) * pivot, direction

    @wp.func
    def sample_line(
        lamps: lamps_type, emitter: emitter_type, target: target_type, u0: real, u1: real,
        u3: real, u4: real,
    ):
        if wp.static(distant):
            if emitter.kind == DISTANT:
                return sample_distant(emitter, target, u0, u1, u3, u4)
        origin = emitter.centre
        if emitter.kind == RECTANGLE_LAMP:
            s = u3
            t = u4
            if wp.static(masks):
                if emitter.first_mask >= 0:
                    s, t = through_mask(lamps.cdf, lamps.guide, emitter, u3, u4)
            origin += emitter.frame[0] * ((s + s - real(1.0)) * emitter.half_u)
            origin += emitter.frame[1] * ((t + t - real(1.0)) * emitter.half_v)
        if target.kind == AIM_AREA:
            point = target.centre + target.frame[0] * ((u0 + u0 - real(1.0)) * target.half_u)
            point += target.frame[1] * ((u1 + u1 - real(1.0)) * target.half_v)
            if emitter.kind == SPHERE_LAMP:
                way = point - emitter.centre
                way *= real(1.0) / wp.length(way)
                origin = point_of_sphere(emitter, way, u3, u4)
            line = point - origin
            return origin, line * (real(1.0) / wp.length(line))
        direction = sample_direction(emitter, target, origin, u0, u1)
        if target.pivot > real(0.0):
            return line_through(emitter, direction, target.pivot, u3, u4)
        if emitter.kind == SPHERE_LAMP:
            origin = point_of_sphere(emitter, direction, u3, u4)
        return origin, direction

    return sample_line


@functools.cache
def make_emission(precision: str, features: Features = EVERYTHING) -> object:
    """Device function `emit(lamps, emitter, target, seed_row, index, key)`.

    Args:
        precision: of rays and fluxes.
        features: which lamps there may be, and what photons are drawn from.

    Returns:
        The function, which returns (Ray, u, flux [W]) of photon `index` of the sequence that
        belongs to one emitter and one of its targets; u in [0, 1) stands for its wavelength.
    """
    structs = make_lamp_structs(precision)
    real, lamps_type = structs.real, structs.Lamps
    ray_type = make_ray_structs(precision).Ray
    distant = features.distant_lamps
    densities = make_density_functions(precision, distant=distant)
    own_density, target_density = densities.own_density, densities.target_density
    sample_direction = make_direction_function(precision, distant=distant)
    sample_line = make_line_function(precision, distant=distant, masks=features.masks)
    cells = make_cell_functions(precision)
    invert_square, cell_density = cells.invert_square, cells.cell_density
    through_mask = cells.through_mask
    photon_numbers = make_photon_numbers(precision, features.method.sampler)

    @wp.func
    def emit(
        lamps: lamps_type,
        emitter_row: int,
        target_row: int,
        seed_row: int,
        index: wp.uint32,
        key: wp.uint64,
    ):
        emitter = lamps.emitters[emitter_row]
        target = lamps.targets[target_row]
        u0, u1, u2, u3, u4 = photon_numbers(lamps.sobol, lamps.seeds, seed_row, index, key)
        if target.first_cdf >= 0:
            u0, u1 = invert_square(lamps.cdf, lamps.guide, target.first_cdf, u0, u1)
        ray = ray_type()
        ray.prim = -1
        ray.face = -1
        ray.prim2 = -1
        if emitter.kind == BEAM:
            # A beam aims itself: its profile gets the best two dimensions.
            if emitter.round == 1:
                x, y = sample_disk(u0, u1)
            else:
                s = u0
                t = u1
                if wp.static(features.masks):
                    if emitter.first_mask >= 0:
                        s, t = through_mask(lamps.cdf, lamps.guide, emitter, u0, u1)
                x = s + s - real(1.0)
                y = t + t - real(1.0)
            ray.origin = emitter.centre + emitter.frame[0] * (x * emitter.half_u)
            ray.origin += emitter.frame[1] * (y * emitter.half_v)
            ray.direction = sample_direction(emitter, target, ray.origin, u3, u4)
            flux_of_beam = emitter.flux / target.photons
            if target.first_cdf >= 0:
                flux_of_beam /= cell_density(lamps.cdf, target.first_cdf, u0, u1)
            return ray, u2, flux_of_beam

        origin, direction = sample_line(lamps, emitter, target, u0, u1, u3, u4)
        flux = real(0.0)
        own = own_density(emitter, direction)
        if emitter.kind == SPHERE_LAMP:
            if wp.dot(origin - emitter.centre, direction) <= real(0.0):
                own = real(0.0)
        if own > real(0.0):
            density = real(0.0)
            first = emitter.first_target
            other = int(first)
            while other < first + emitter.target_count:
                chosen = lamps.targets[other]
                density += chosen.photons * target_density(
                    lamps, emitter, chosen, origin, direction, other == target_row
                )
                other += 1
            flux = emitter.flux * own / density
        ray.origin = origin
        ray.direction = direction
        return ray, u2, flux

    return emit
