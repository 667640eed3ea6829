"""Photons from afar: lines through the scene, drawn on disks that face them. Device side.

Along every direction of its cone a distant lamp sends the same flux through each square metre that
faces it. So a line's density is that of its direction, which all targets draw alike and which
cancels, times one per area across the line: over the disk that covers the scene, over one that
covers a target's bounding sphere, or over a rectangle's points, as they face the line.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.photons.cells import make_cell_functions
from sim.photons.lamp_structs import AIM_AREA, AIM_CONE, make_lamp_structs
from sim.sampling.directions import disk_square, frame_of, sample_cone, sample_disk, to_world

__all__ = ["make_distant_functions"]

OUTSIDE = 1.0 + 1e-3
"""Photons start this many radii of the scene's bounding sphere before its middle."""

PI = wp.constant(3.141592653589793)


@functools.cache
def make_distant_functions(precision: str) -> SimpleNamespace:
    """Device functions of lines from afar.

    Returns:
        A namespace with `sample_distant(emitter, target, u0, u1, u3, u4)`, origin and direction;
        `distant_density(lamps, emitter, target, origin, direction, drawn)` of that line per area
        across it [1/m²]; and `square_of_line(target, origin, direction)`, the numbers (u0, u1) that
        a target's disk turns into it.
    """
    structs = make_lamp_structs(precision)
    real, vec3, lamps_type = structs.real, structs.vec3, structs.Lamps
    emitter_type, target_type = structs.Emitter, structs.Target
    cell_density = make_cell_functions(precision).cell_density

    @wp.func
    def sample_distant(
        emitter: emitter_type, target: target_type, u0: real, u1: real, u3: real, u4: real
    ):
        x, y, z = sample_cone(u3, u4, emitter.sin2_half)
        direction = to_world(x, y, z, emitter.frame[2])
        point = vec3()
        if target.kind == AIM_AREA:
            point = target.centre + target.frame[0] * ((u0 + u0 - real(1.0)) * target.half_u)
            point += target.frame[1] * ((u1 + u1 - real(1.0)) * target.half_v)
        else:
            across, along = sample_disk(u0, u1)
            u, v = frame_of(direction)
            radius = emitter.radius
            if target.kind == AIM_CONE:
                point = target.centre
                radius = target.radius
            point += (u * across + v * along) * radius
        back = wp.dot(point, direction) + real(OUTSIDE) * emitter.radius
        return point - direction * back, direction

    @wp.func
    def place_on_disk(target: target_type, origin: vec3, direction: vec3):
        """Where the line crosses the disk about the target's centre, in radii."""
        offset = origin - target.centre
        u, v = frame_of(direction)
        inverse = real(1.0) / target.radius
        return wp.dot(offset, u) * inverse, wp.dot(offset, v) * inverse

    @wp.func
    def square_of_line(target: target_type, origin: vec3, direction: vec3):
        x, y = place_on_disk(target, origin, direction)
        return disk_square(x, y)

    @wp.func
    def disk_density(
        lamps: lamps_type, target: target_type, origin: vec3, direction: vec3, drawn: bool
    ):
        x, y = place_on_disk(target, origin, direction)
        if x * x + y * y > real(1.0) and not drawn:
            return real(0.0)
        density = real(1.0) / (real(PI) * target.radius * target.radius)
        if target.first_cdf >= 0:
            s, t = disk_square(x, y)
            density *= cell_density(lamps.cdf, target.first_cdf, s, t)
        return density

    @wp.func
    def rectangle_density(
        lamps: lamps_type, target: target_type, origin: vec3, direction: vec3, drawn: bool
    ):
        offset = target.centre - origin
        approach = wp.dot(direction, target.frame[2])
        if approach == real(0.0):
            return real(0.0)
        there = wp.dot(offset, target.frame[2]) / approach
        local = target.frame * (direction * there - offset)
        x = local[0] / target.half_u
        y = local[1] / target.half_v
        if (wp.abs(x) > real(1.0) or wp.abs(y) > real(1.0)) and not drawn:
            return real(0.0)
        half = real(0.5)
        density = cell_density(lamps.cdf, target.first_cdf, half + half * x, half + half * y)
        return density / (real(4.0) * target.half_u * target.half_v * wp.abs(approach))

    @wp.func
    def distant_density(
        lamps: lamps_type, emitter: emitter_type, target: target_type, origin: vec3,
        direction: vec3, drawn: bool,
    ):
        if target.kind == AIM_CONE:
            return disk_density(lamps, target, origin, direction, drawn)
        if target.kind == AIM_AREA:
            return rectangle_density(lamps, target, origin, direction, drawn)
        return real(1.0) / (real(PI) * emitter.radius * emitter.radius)

    return SimpleNamespace(
        sample_distant=sample_distant,
        distant_density=distant_density,
        square_of_line=square_of_line,
    )
