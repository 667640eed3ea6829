"""The device-side layout of the lamps: emitters, what they aim at, and their spectra."""

import functools
from types import SimpleNamespace

import warp as wp

from sim.precision import precision_types

__all__ = [
    "AIM_AREA",
    "AIM_BASE",
    "AIM_CELLS",
    "AIM_CONE",
    "BEAM",
    "DISTANT",
    "POINT",
    "RECTANGLE_LAMP",
    "SPHERE_LAMP",
    "SPOT",
    "make_lamp_structs",
]

BEAM = wp.constant(0)
POINT = wp.constant(1)
SPOT = wp.constant(2)
SPHERE_LAMP = wp.constant(3)
RECTANGLE_LAMP = wp.constant(4)
DISTANT = wp.constant(5)
"""The same radiance along every line through the scene whose direction is in the emitter's cone."""

AIM_BASE = wp.constant(0)
"""Directions as the lamp itself distributes them."""
AIM_CONE = wp.constant(1)
"""Directions into the cone around a bounding sphere; from afar, lines through that sphere."""
AIM_AREA = wp.constant(2)
"""Directions to points of a rectangle, as densely as the camera looks there."""

AIM_CELLS = wp.constant(32)
"""Cells a side in which the density of points on a rectangle is given."""


@functools.cache
def make_lamp_structs(precision: str) -> SimpleNamespace:
    """Structs Emitter, Target, Segment (of a spectrum), Vibration and Lamps, and types."""
    types = precision_types(precision)
    real, vec3, mat33 = types.real, types.vec3, types.mat33

    @wp.struct
    class Emitter:
        kind: int
        round: int
        centre: vec3
        frame: mat33  # rows: u, v, axis
        half_u: real
        half_v: real
        radius: real  # of a sphere; of the disk through which all light from afar comes
        sin2_half: real  # sin² of half the cone's half angle
        visible: int
        widening: real  # of a beam, per length: the tangent of its half angle
        flux: real
        radiance: real  # of its surface, where it has one
        first_target: int
        target_count: int
        first_segment: int
        segment_count: int
        first_cdf: int  # of its segments, in Lamps.cdf
        first_mask: int  # of its mask's cells, columns first, in Lamps.cdf; −1: it has none
        mask_columns: int
        mask_rows: int

    @wp.struct
    class Target:
        """Where photons are aimed, and how many: the first target of an emitter is its base.

        The two numbers that choose what is aimed at are drawn from a distribution over the cells
        of their unit square, which starts at `first_cdf` of `Lamps.cdf`: AIM_CELLS + 1 numbers
        over the cells along the first, then as many for each of these along the second. Where
        `first_cdf` is negative it is uniform; areas always have one.
        """

        kind: int
        centre: vec3
        frame: mat33
        half_u: real
        half_v: real
        radius: real
        pivot: real  # where a cone's directions cross, from a spherical lamp's centre; 0: nowhere
        first_cdf: int
        photons: real

    @wp.struct
    class Segment:
        """A piece of a spectrum: density linear from `density_low` to `density_high` over `width`.

        A spectral line has no width.
        """

        wavelength_nm: real
        width_nm: real
        density_low: real
        density_high: real

    @wp.struct
    class Vibration:
        """(q, u, v) of an emitter's light, angles counted from `up` as seen across the ray."""

        light: vec3
        up: vec3

    @wp.struct
    class Lamps:
        emitters: wp.array(dtype=Emitter)
        targets: wp.array(dtype=Target)
        segments: wp.array(dtype=Segment)
        vibrations: wp.array(dtype=Vibration)  # one an emitter
        cdf: wp.array(dtype=real)
        guide: wp.array(dtype=int)
        sobol: wp.array(dtype=wp.uint32)
        seeds: wp.array(dtype=wp.uint32)

    return SimpleNamespace(
        real=real,
        vec3=vec3,
        Emitter=Emitter,
        Target=Target,
        Segment=Segment,
        Vibration=Vibration,
        Lamps=Lamps,
    )
