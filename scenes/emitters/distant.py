"""Light from beyond the scene: the sun, and an environment all around.

Both have the same radiance L along every line through the scene whose direction is in a cone: the
sun in a narrow one, the environment in all directions. They have no flux of their own; through a
disk of radius R that turns with the direction goes Φ = L Ω π R², with Ω = 4π sin²(θ/2).
"""

import math
from abc import abstractmethod
from typing import Literal

from pydantic import Field

from scenes.emitters.emitter import Emitter, Glowing
from scenes.fields import Degrees, Direction, Light

__all__ = ["DistantEmitter", "Environment", "Sun"]


class DistantEmitter(Emitter, Glowing):
    """A source of light that is infinitely far away."""

    @property
    @abstractmethod
    def axis(self) -> tuple[float, float, float]:
        """Middle of the directions that its light goes in, a unit vector."""

    @property
    @abstractmethod
    def cone_deg(self) -> float:
        """Half angle of the cone of these directions [degrees]."""

    def flux_through(self, radius: float) -> float:
        """Flux over the whole spectrum that comes into a sphere of this radius [m], in watts."""
        solid_angle = 4.0 * math.pi * math.sin(0.5 * math.radians(self.cone_deg)) ** 2
        return self.full_radiance * solid_angle * math.pi * radius**2


class Sun(DistantEmitter):
    """A disk in the sky, evenly bright; infinitely far away."""

    type: Literal["sun"] = Field(default="sun", description="disk in the sky")
    direction: Direction = Field(description="where its light goes")
    irradiance: Light = Field(
        description="irradiance over the whole spectrum of a surface that faces the sun [W m⁻²]"
    )
    half_angle_deg: Degrees = Field(
        default=0.2666,
        gt=0,
        lt=90,
        description="half the angle that the disk subtends, 0.2666 if not given: the sun's,"
        " more than 0, less than 90 [degrees]",
    )

    @property
    def axis(self) -> tuple[float, float, float]:
        """Middle of the directions that its light goes in, a unit vector."""
        return self.direction

    @property
    def cone_deg(self) -> float:
        """Half angle of the cone of these directions [degrees]."""
        return self.half_angle_deg

    @property
    def full_radiance(self) -> float:
        """E = π L sin²θ for a disk of half angle θ that is faced (Born & Wolf 1999, §4.8.1)."""
        return self.irradiance / (math.pi * math.sin(math.radians(self.half_angle_deg)) ** 2)


class Environment(DistantEmitter):
    """All around the scene, evenly bright in every direction; infinitely far away."""

    type: Literal["environment"] = Field(default="environment", description="evenly bright sky")
    radiance: Light = Field(
        description="radiance over the whole spectrum, in every direction [W m⁻² sr⁻¹]"
    )

    @property
    def axis(self) -> tuple[float, float, float]:
        """Any direction is the middle of all."""
        return (0.0, 0.0, 1.0)

    @property
    def cone_deg(self) -> float:
        """Half angle of a cone of all directions [degrees]."""
        return 180.0

    @property
    def full_radiance(self) -> float:
        """Radiance over the whole spectrum [W m⁻² sr⁻¹]."""
        return self.radiance
