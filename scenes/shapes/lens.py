"""The lens: two conic surfaces on one axis, and a flat cylindrical rim.

The sag of a surface, the distance of a point from the plane that touches the vertex, is

    z(ρ) = c ρ² / (1 + √(1 - (1 + κ) c² ρ²))

with curvature c and conic constant κ (ISO 10110-12:2019, without aspheric terms; Born & Wolf 1999,
§4.10). It needs no case of its own for a plane (c = 0).
"""

import math
from typing import Any, ClassVar, Literal, Self, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_serializer,
    model_validator,
)

from scenes.errors import Problem, refusal
from scenes.fields import (
    Curvature,
    Direction,
    Number,
    Position,
    SignedRadius,
    Size,
    length_text,
)
from scenes.model import SceneModel
from scenes.shapes.bounds import Bounds

__all__ = ["Lens", "LensSurface"]

_LARGEST_CONIC = 1e6

_ROUNDING = 1e-12
"""Relative slack at the end of a conic: a hemisphere in mm must not fail by a last digit."""


def _without_default(schema: dict[str, Any]) -> None:
    """Curvature has no default: it is what the radius says."""
    schema.pop("default", None)


class LensSurface(SceneModel):
    """A conic of revolution; positive curvature has its centre further along the lens's axis."""

    radius: SignedRadius | None = Field(
        default=None, description="signed radius of curvature at the vertex (length)"
    )
    curvature: Curvature = Field(
        default=cast("float", None),
        validate_default=True,
        json_schema_extra=_without_default,
        description="signed curvature at the vertex (1/length), in place of radius; 0 is a plane",
    )
    conic: Number = Field(
        default=0.0,
        ge=-_LARGEST_CONIC,
        le=_LARGEST_CONIC,
        description="conic constant: 0 sphere, -1 paraboloid, less hyperboloid, else ellipsoid",
    )

    @property
    def steepness(self) -> float:
        """(1 + κ) c² [1/m²]: the sag exists where this times ρ² is at most 1."""
        return (1.0 + self.conic) * self.curvature**2

    @property
    def largest_radius(self) -> float:
        """Distance from the axis at which the surface ends [m]; infinite if it never does."""
        return 1.0 / math.sqrt(self.steepness) if self.steepness > 0.0 else math.inf

    def reaches(self, rho: float) -> bool:
        """Whether the surface exists at a distance from the axis [m]."""
        return self.steepness * rho**2 <= 1.0 + _ROUNDING

    def sag(self, rho: float) -> float:
        """Distance along the axis from the vertex's tangent plane [m], `rho` [m] off the axis."""
        root = math.sqrt(max(1.0 - self.steepness * rho**2, 0.0))
        return self.curvature * rho**2 / (1.0 + root)

    @field_validator("curvature", mode="wrap")
    @classmethod
    def _is_one_of_two(
        cls, value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo
    ) -> float:
        if "radius" not in info.data:
            return 0.0  # a wrong radius has been reported, and the lens will not be built
        radius = info.data["radius"]
        if (radius is None) == (value is None):
            allowed = "either radius or curvature"
            given = "neither" if value is None else "both"
            raise refusal(Problem("", f"must be given as {allowed}, not {given}", value, allowed))
        return 1.0 / radius if value is None else float(handler(value))

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = handler(self)
        if self.radius is not None:
            del fields["curvature"]
        return fields


class Lens(SceneModel):
    """A lens: biconvex, plano, meniscus or concave, by the signs of its two curvatures."""

    is_closed: ClassVar[bool] = True

    type: Literal["lens"] = Field(default="lens", description="lens of two conic surfaces")
    position: Position = Field(
        description="midpoint of the two surfaces' vertices on the axis (length)"
    )
    axis: Direction = Field(
        default=(0.0, 0.0, 1.0), description="direction from the first surface to the second"
    )
    thickness: Size = Field(description="distance between the vertices (length)")
    aperture: Size = Field(description="clear diameter (length)")
    first: LensSurface = Field(description="surface that the axis meets first")
    second: LensSurface = Field(description="surface that the axis meets last")

    def vertices(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The points where the axis meets the first and the second surface, each (3,) [m]."""
        half = 0.5 * self.thickness * np.array(self.axis)
        return np.array(self.position) - half, np.array(self.position) + half

    def thickness_at(self, rho: float) -> float:
        """Distance between the surfaces [m], parallel to the axis, `rho` [m] away from it."""
        return self.thickness + self.second.sag(rho) - self.first.sag(rho)

    @property
    def edge_thickness(self) -> float:
        """Length of the cylindrical rim [m]."""
        return self.thickness_at(0.5 * self.aperture)

    def bounding_sphere(self) -> Bounds:
        """The sphere around the cylinder that just holds the lens."""
        half, rim = 0.5 * self.thickness, 0.5 * self.aperture
        start = -half + min(0.0, self.first.sag(rim))
        end = half + max(0.0, self.second.sag(rim))
        centre = np.array(self.position) + 0.5 * (start + end) * np.array(self.axis)
        return centre, math.hypot(rim, 0.5 * (end - start))

    def thinnest(self) -> tuple[float, float]:
        """Where within the aperture the lens is thinnest.

        The thickness d(ρ) = t + z₂(ρ) - z₁(ρ) is extreme on the axis, at the rim, or where both
        surfaces have the same slope cρ/√(1 - (1 + κ)c²ρ²), which gives
        ρ² = (c₁² - c₂²) / (c₁² c₂² (κ₂ - κ₁)).

        Returns:
            Distance from the axis and thickness there, both [m].
        """
        rim = 0.5 * self.aperture
        candidates = [0.0, rim]
        c1, c2 = self.first.curvature, self.second.curvature
        denominator = c1**2 * c2**2 * (self.second.conic - self.first.conic)
        if denominator != 0.0:
            rho2 = (c1**2 - c2**2) / denominator
            if 0.0 < rho2 < rim**2:
                candidates.append(math.sqrt(rho2))
        return min(((rho, self.thickness_at(rho)) for rho in candidates), key=lambda pair: pair[1])

    @model_validator(mode="after")
    def _holds_together(self, info: ValidationInfo) -> Self:
        rim = 0.5 * self.aperture
        surfaces = {"first": self.first, "second": self.second}
        short = {name: one for name, one in surfaces.items() if not one.reaches(rim)}
        if short:
            widest = 2.0 * min(surface.largest_radius for surface in short.values())
            allowed = f"at most {length_text(widest, info)}, where the {' and '.join(short)} ends"
            message = f"must be {allowed}; is {length_text(self.aperture, info)}"
            raise refusal(Problem("aperture", message, self.aperture, allowed))
        rho, thickness = self.thinnest()
        if thickness <= 0.0:
            allowed = "a lens of some thickness everywhere inside its aperture"
            message = (
                f"makes the surfaces cross: {length_text(rho, info)} off the axis"
                f" the lens is {length_text(thickness, info)} thick; allowed: {allowed}"
            )
            raise refusal(Problem("thickness", message, self.thickness, allowed))
        return self
