"""With what density lamps and targets draw directions, device side.

A density is per solid angle. For a spherical lamp it is relative to dω cosθ dA/(πR²), since a
Lambertian sphere seen from any direction is a uniform disk; for any other lamp to dω dA/A. That
of a distant lamp is per area across the line, see `sim.photons.distant`.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.photons.cells import make_cell_functions
from sim.photons.distant import make_distant_functions
from sim.photons.lamp_structs import (
    AIM_AREA,
    AIM_CONE,
    DISTANT,
    RECTANGLE_LAMP,
    SPHERE_LAMP,
    SPOT,
    make_lamp_structs,
)
from sim.sampling.directions import cone_solid_angle, cone_square, from_world

__all__ = ["make_density_functions"]

INV_PI = wp.constant(0.3183098861837907)
INV_4PI = wp.constant(0.07957747154594767)


@functools.cache
def make_density_functions(precision: str, *, distant: bool = True) -> SimpleNamespace:
    """Device functions of solid-angle densities [1/sr], and of the cone around a target.

    Args:
        precision: of the numbers.
        distant: whether there may be distant lamps.
    """
    structs = make_lamp_structs(precision)
    real, vec3, lamps_type = structs.real, structs.vec3, structs.Lamps
    cell_density = make_cell_functions(precision).cell_density
    emitter_type, target_type = structs.Emitter, structs.Target
    from_afar = make_distant_functions(precision)
    distant_density, square_of_line = from_afar.distant_density, from_afar.square_of_line

    @wp.func
    def own_density(emitter: emitter_type, direction: vec3):
        """Density of the lamp's own radiation over directions."""
        axis = emitter.frame[2]
        if wp.static(distant):
            if emitter.kind == DISTANT:
                return real(INV_PI) / (emitter.radius * emitter.radius)
        if emitter.kind == RECTANGLE_LAMP:
            return wp.max(wp.dot(direction, axis), real(0.0)) * real(INV_PI)
        if emitter.kind == SPOT:
            chord = direction - axis
            # |d − a|² = 4 sin²(θ/2): exact where the cone is narrow.
            if wp.dot(chord, chord) <= real(4.0) * emitter.sin2_half:
                return real(1.0) / cone_solid_angle(emitter.sin2_half)
            return real(0.0)
        return real(INV_4PI)

    @wp.func
    def cone_of(target: target_type, origin: vec3):
        """sin² of half the angle of the cone around a target's sphere; 1 from inside it."""
        offset = target.centre - origin
        distance2 = wp.dot(offset, offset)
        sin2 = target.radius * target.radius / distance2
        if sin2 >= real(1.0):
            return real(1.0)
        return sin2 / (real(2.0) * (real(1.0) + wp.sqrt(real(1.0) - sin2)))

    @wp.func
    def cone_axis(target: target_type, origin: vec3, sin2_half: real):
        """The axis of that cone; any for the whole sphere."""
        if sin2_half >= real(1.0):
            return vec3(real(0.0), real(0.0), real(1.0))
        return wp.normalize(target.centre - origin)

    @wp.func
    def way_of(emitter: emitter_type, target: target_type, origin: vec3, direction: vec3):
        """What a line of a spherical lamp has for a direction of the target's cone, and a factor.

        Without a pivot it is the line's own. Else it is the direction from the lamp's centre in
        which the line crosses the pivot's sphere, of radius L. That point is drawn with density
        p dω/dA = p/L², the line's direction evenly in the cone under which it sees the lamp, of
        solid angle Ω. Per dω dA cosα/(πR²), α between both directions, that makes
        p πR²/(L² Ω cosα) = p (1 + √(1 − R²/L²))/(2 cosα).
        """
        if target.pivot == real(0.0):
            return direction, real(1.0)
        offset = origin - emitter.centre
        b = wp.dot(offset, direction)
        c = target.pivot * target.pivot - wp.dot(offset, offset)
        way = (offset + direction * (wp.sqrt(b * b + c) - b)) * (real(1.0) / target.pivot)
        sine = emitter.radius / target.pivot
        factor = real(1.0) + wp.sqrt(real(1.0) - sine * sine)
        return way, factor / (real(2.0) * wp.dot(way, direction))

    @wp.func
    def square_of_cone(target: target_type, origin: vec3, direction: vec3):
        """The two numbers that the cone from `origin` turns into `direction`."""
        sin2_half = cone_of(target, origin)
        x, y, z = from_world(direction, cone_axis(target, origin, sin2_half))
        return cone_square(x, y, z, sin2_half)

    @wp.func
    def cone_density(
        lamps: lamps_type, target: target_type, origin: vec3, direction: vec3, drawn: bool
    ):
        """Density of the directions from `origin` into the cone around the target."""
        sin2_half = cone_of(target, origin)
        if sin2_half < real(1.0) and not drawn:
            chord = direction - cone_axis(target, origin, sin2_half)
            if wp.dot(chord, chord) > real(4.0) * sin2_half:
                return real(0.0)
        density = real(1.0) / cone_solid_angle(sin2_half)
        if target.first_cdf >= 0:
            s, t = square_of_cone(target, origin, direction)
            density *= cell_density(lamps.cdf, target.first_cdf, s, t)
        return density

    @wp.func
    def area_density(
        lamps: lamps_type, emitter: emitter_type, target: target_type, origin: vec3,
        direction: vec3, drawn: bool,
    ):
        """Density of the rectangle's points, seen from `origin` along `direction`."""
        offset = target.centre - origin
        normal = target.frame[2]
        approach = wp.dot(direction, normal)
        if approach == real(0.0):
            return real(0.0)
        t = wp.dot(offset, normal) / approach
        if t <= real(0.0):
            return real(0.0)
        local = target.frame * (direction * t - offset)
        outside = wp.abs(local[0]) > target.half_u or wp.abs(local[1]) > target.half_v
        if outside and not drawn:
            return real(0.0)
        density = t * t / (real(4.0) * target.half_u * target.half_v * wp.abs(approach))
        density *= cell_density(
            lamps.cdf,
            target.first_cdf,
            real(0.5) + real(0.5) * local[0] / target.half_u,
            real(0.5) + real(0.5) * local[1] / target.half_v,
        )
        if emitter.kind == SPHERE_LAMP:
            # The lamp's point was drawn with the cosine about the way to the target's point,
            # where the lamp's own radiation goes with the cosine of the direction.
            outward = origin - emitter.centre
            way = outward + direction * t
            cosines = wp.max(wp.dot(outward, way), real(0.0)) / wp.dot(outward, direction)
            density *= cosines / wp.length(way)
        return density

    @wp.func
    def target_density(
        lamps: lamps_type, emitter: emitter_type, target: target_type, origin: vec3,
        direction: vec3, drawn: bool,
    ):
        """Density with which `target` draws `direction`, relative to the lamp's position.

        A spherical lamp's lines are counted per dω cosθ dA/(πR²); any other lamp's per dω dA/A.
        A direction that this very target has `drawn` is inside it, whatever rounding says.
        """
        if wp.static(distant):
            if emitter.kind == DISTANT:
                return distant_density(lamps, emitter, target, origin, direction, drawn)
        if target.kind == AIM_CONE:
            if emitter.kind == SPHERE_LAMP:
                way, factor = way_of(emitter, target, origin, direction)
                return factor * cone_density(lamps, target, emitter.centre, way, drawn)
            return cone_density(lamps, target, origin, direction, drawn)
        if target.kind == AIM_AREA:
            return area_density(lamps, emitter, target, origin, direction, drawn)
        return own_density(emitter, direction)

    @wp.func
    def square_of_target(
        emitter: emitter_type, target: target_type, origin: vec3, direction: vec3
    ):
        """The two numbers that a target around a sphere turns into this line."""
        if wp.static(distant):
            if emitter.kind == DISTANT:
                return square_of_line(target, origin, direction)
        if emitter.kind == SPHERE_LAMP:
            way, _factor = way_of(emitter, target, origin, direction)
            return square_of_cone(target, emitter.centre, way)
        return square_of_cone(target, origin, direction)

    return SimpleNamespace(
        own_density=own_density,
        target_density=target_density,
        cone_of=cone_of,
        cone_axis=cone_axis,
        square_of_target=square_of_target,
    )
