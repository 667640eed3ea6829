"""Lamps: light from a point, or from a surface that glows.

A lamp is light without matter: its surface shines, and stops nothing.
"""

import math
from typing import Literal

from pydantic import Field

from scenes.emitters.emitter import Glowing, LocalEmitter
from scenes.emitters.mask import Mask
from scenes.fields import Degrees, Direction, Position, Size
from scenes.shapes import FlatRectangle

__all__ = ["Point", "RectangleLamp", "SphereLamp", "Spot"]


class Point(LocalEmitter):
    """A point that shines evenly in all directions."""

    type: Literal["point"] = Field(default="point", description="point source")
    position: Position = Field(description="where it is (length)")


class Spot(LocalEmitter):
    """A point that shines evenly into a cone."""

    type: Literal["spot"] = Field(default="spot", description="point source with a cone")
    position: Position = Field(description="where it is (length)")
    direction: Direction = Field(description="axis of the cone")
    half_angle_deg: Degrees = Field(
        gt=0, le=180, description="half angle of the cone, more than 0, at most 180 [degrees]"
    )


class SphereLamp(LocalEmitter, Glowing):
    """A sphere that glows, equally bright from everywhere (Lambertian)."""

    type: Literal["sphere"] = Field(default="sphere", description="glowing sphere")
    position: Position = Field(description="centre (length)")
    radius: Size = Field(description="radius (length)")

    @property
    def full_radiance(self) -> float:
        """Φ = π A L of a Lambertian surface, here of A = 4π R² [W m⁻² sr⁻¹]."""
        return self.flux / (2.0 * math.pi * self.radius) ** 2


class RectangleLamp(FlatRectangle, LocalEmitter, Glowing):
    """A rectangle that glows (Lambertian) on the side its normal points to."""

    type: Literal["rectangle"] = Field(default="rectangle", description="glowing rectangle")
    mask: Mask | None = Field(
        default=None, description="where the light comes through; everywhere if not given"
    )

    @property
    def full_radiance(self) -> float:
        """Φ = π A L of a Lambertian surface, the mean over it if masked [W m⁻² sr⁻¹]."""
        return self.flux / (math.pi * self.size[0] * self.size[1])
