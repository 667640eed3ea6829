"""Charts: two coordinates, each 0 to 1, that number the rays of a lamp.

A chart spans the rays of one point of a lamp, or of one direction of a beam, that can meet the
sphere around an object. The flux of every cell of its coordinates is known exactly, up to a smooth
factor of the rays.

Round charts count s outwards and t around. Their radius goes with sin(π s / 2): the angle of
incidence on the sphere is then π s / 2, and what depends on the square root of the distance from
its rim, as refraction and reflectance do at grazing incidence, is smooth in s.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

__all__ = ["Chart", "ConeChart", "Emission", "ProfileChart", "RayBundle", "RimChart"]

FloatArray = npt.NDArray[np.float64]


class RayBundle(NamedTuple):
    """Rays, and the factors by which they are brighter than the chart says of their cell."""

    origins: FloatArray  # (n, 3) [m]
    directions: FloatArray  # (n, 3), unit
    intensity: FloatArray  # (n,), 0 where the lamp sends nothing


@dataclass(frozen=True, eq=False)
class Emission:
    """How a lamp's intensity depends on the direction.

    Attributes:
        axis: (3,), unit.
        least_cosine: only directions with a larger cosine to the axis are lit.
        is_lambertian: intensity is 4 times that cosine, as of a flat lamp, which has one side;
            else it is 1.
    """

    axis: FloatArray
    least_cosine: float = -2.0
    is_lambertian: bool = False

    def intensity(self, directions: FloatArray) -> FloatArray:
        """Relative to the mean over all directions, (n,)."""
        cosine = directions @ self.axis
        lit: FloatArray = (cosine > self.least_cosine).astype(np.float64)
        return 4.0 * cosine * lit if self.is_lambertian else lit


class Chart(Protocol):
    """Rays numbered by (s, t)."""

    @property
    def flux(self) -> float:
        """Flux of the whole chart at intensity 1, as a share of the lamp's."""

    @property
    def is_round(self) -> bool:
        """Whether t goes round, and s = 0 is one point."""

    def flux_below(self, s: FloatArray) -> FloatArray:
        """Share of the chart's flux from 0 to s; it is spread evenly over t."""

    def width(self, s: FloatArray) -> FloatArray:
        """How wide a step of t is at s, on any scale."""

    def rays(self, s: FloatArray, t: FloatArray) -> RayBundle:
        """The rays at coordinates (n,) and (n,)."""


@dataclass(frozen=True, eq=False)
class ProfileChart:
    """Parallel rays from a part of a beam's profile.

    Attributes:
        flux: share of the beam's flux.
        is_round: an ellipse, or else a parallelogram.
        centre: (3,) of the part [m].
        axes: (2, 3) from its centre to its edges [m].
        direction: (3,), unit.
    """

    flux: float
    is_round: bool
    centre: FloatArray
    axes: FloatArray
    direction: FloatArray

    def flux_below(self, s: FloatArray) -> FloatArray:
        """Share of the flux from 0 to s: of the width, or of the disk."""
        return _radius(s) ** 2 if self.is_round else s

    def width(self, s: FloatArray) -> FloatArray:
        """As long as the circle, or everywhere the same."""
        return _radius(s) if self.is_round else np.ones_like(s)

    def rays(self, s: FloatArray, t: FloatArray) -> RayBundle:
        """Rays from (x, y) of the profile."""
        place = _on_disk(s, t) if self.is_round else np.column_stack([2.0 * s - 1.0, 2.0 * t - 1.0])
        directions = np.broadcast_to(self.direction, (len(s), 3))
        return RayBundle(self.centre + place @ self.axes, directions, np.ones(len(s)))


@dataclass(frozen=True, eq=False)
class RimChart:
    """Rays of a point, or lines aside from it by one offset, up to the rim of a sphere.

    With the axis through the sphere's centre, a distance d away, and a direction (a, b, c) in the
    frame, the line through the offset (x, y), across the direction, passes the centre at the
    distance |d (a, b) + (x, y)|. So a sphere of radius R is a disk of radius R/d in (a, b),
    with the centre −(x, y)/d. Solid angle is da db / c.

    Attributes:
        flux: of the disk, (R/d)²/4 of a point's, as a share of the lamp's.
        origin: (3,) of the point [m].
        frame: (3, 3), rows e₁, e₂ and the axis.
        offset: (2,) aside from the point, along e₁ and e₂ turned with the axis onto the ray [m].
        centre: (2,) of the disk.
        radius: of the disk.
        emission: of the lamp.
    """

    flux: float
    origin: FloatArray
    frame: FloatArray
    offset: FloatArray
    centre: FloatArray
    radius: float
    emission: Emission

    @property
    def is_round(self) -> bool:
        """Always."""
        return True

    def flux_below(self, s: FloatArray) -> FloatArray:
        """Share of the disk within s."""
        return _radius(s) ** 2

    def width(self, s: FloatArray) -> FloatArray:
        """As long as the circle."""
        return _radius(s)

    def rays(self, s: FloatArray, t: FloatArray) -> RayBundle:
        """Rays at (a, b) of the disk."""
        a, b = (self.centre + self.radius * _on_disk(s, t)).T
        c = np.sqrt(1.0 - a * a - b * b)
        directions = np.column_stack([a, b, c]) @ self.frame
        lift = 1.0 / (1.0 + c)
        e1 = np.column_stack([1.0 - a * a * lift, -a * b * lift, -a]) @ self.frame
        e2 = np.column_stack([-a * b * lift, 1.0 - b * b * lift, -b]) @ self.frame
        origins = self.origin + self.offset[0] * e1 + self.offset[1] * e2
        return RayBundle(origins, directions, self.emission.intensity(directions) / c)


@dataclass(frozen=True, eq=False)
class ConeChart:
    """Rays of a point in a cone that has nothing to do with any sphere.

    Attributes:
        flux: of the cone at intensity 1, as a share of the lamp's.
        origin: (3,) of the point [m].
        frame: (3, 3), rows e₁, e₂ and the axis.
        half_angle: of the cone [rad], up to π.
        emission: of the lamp.
    """

    flux: float
    origin: FloatArray
    frame: FloatArray
    half_angle: float
    emission: Emission

    @property
    def is_round(self) -> bool:
        """Always."""
        return True

    def flux_below(self, s: FloatArray) -> FloatArray:
        """Share of the solid angle within s: sin²(θ/2) over that of the whole cone."""
        part, whole = np.sin(0.5 * self.half_angle * s), np.sin(0.5 * self.half_angle)
        share: FloatArray = (part / whole) ** 2
        return share

    def width(self, s: FloatArray) -> FloatArray:
        """As long as the circle of directions."""
        return np.sin(self.half_angle * s)

    def rays(self, s: FloatArray, t: FloatArray) -> RayBundle:
        """Rays at the polar angle θ = s · half_angle."""
        theta, phi = self.half_angle * s, 2.0 * np.pi * t
        sine = np.sin(theta)
        local = np.column_stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)])
        directions = local @ self.frame
        origins = np.broadcast_to(self.origin, directions.shape)
        return RayBundle(origins, directions, self.emission.intensity(directions))


def _radius(s: FloatArray) -> FloatArray:
    """Radius of the unit disk at s."""
    return np.sin(0.5 * np.pi * s)


def _on_disk(s: FloatArray, t: FloatArray) -> FloatArray:
    """Points (n, 2) of the unit disk."""
    radius, angle = _radius(s), 2.0 * np.pi * t
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
