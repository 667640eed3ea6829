"""The prism: a triangular or, with the apex cut off, trapezoidal cross-section."""

import math
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, model_validator

from scenes.errors import Problem, refusal
from scenes.fields import MAX_LENGTH_M, MIN_SIZE_M, Degrees, Size, length_text
from scenes.shapes.convex import ConvexSolid, Faces

__all__ = ["Prism"]

_ROUNDING = 1e-12
_SHARPEST_DEG = 1e-6


class Prism(ConvexSolid):
    """A prism with a symmetric section in the local x-y plane and its length along z.

    The apex points toward +y, the base lies below it, parallel to x. The local origin is in the
    middle of the section's height, from the base to the apex or to where that is cut off.
    """

    type: Literal["prism"] = Field(default="prism", description="isosceles prism")
    apex_deg: Degrees = Field(
        ge=_SHARPEST_DEG,
        le=180.0 - _SHARPEST_DEG,
        description="angle between the two refracting faces [degrees], more than 0, less than 180",
    )
    base: Size = Field(description="width of the base (length)")
    length: Size = Field(description="length along the refracting edge (length)")
    height: Size | None = Field(
        default=None,
        description="height of the section where the apex is cut off parallel to the base; the"
        " whole triangle if not given (length)",
    )

    @property
    def full_height(self) -> float:
        """Height of the whole triangle, base / (2 tan(apex / 2)) [m]."""
        return 0.5 * self.base / math.tan(self._half_apex)

    @property
    def is_truncated(self) -> bool:
        """Whether a face takes the place of the refracting edge."""
        return self.height is not None and self.height < self.full_height * (1.0 - _ROUNDING)

    @property
    def section_height(self) -> float:
        """Height of the section, from the base to the edge or to the cut [m]."""
        if self.height is None or not self.is_truncated:
            return self.full_height
        return self.height

    @property
    def _half_apex(self) -> float:
        return 0.5 * math.radians(self.apex_deg)

    def local_faces(self) -> Faces:
        """The faces: base, right (+x), left (-x), both ends (+z, -z), and the cut if any."""
        half_height = 0.5 * self.section_height
        cosine, sine = math.cos(self._half_apex), math.sin(self._half_apex)
        side = cosine * 0.5 * self.base - sine * half_height
        half_length = 0.5 * self.length
        faces = [
            ((0.0, -1.0, 0.0), half_height),
            ((cosine, sine, 0.0), side),
            ((-cosine, sine, 0.0), side),
            ((0.0, 0.0, 1.0), half_length),
            ((0.0, 0.0, -1.0), half_length),
        ]
        if self.is_truncated:
            faces.append(((0.0, 1.0, 0.0), half_height))
        return np.array([normal for normal, _ in faces]), np.array([offset for _, offset in faces])

    def local_vertices(self) -> NDArray[np.float64]:
        """Six corners, or eight if the apex is cut off."""
        y = 0.5 * self.section_height
        x = 0.5 * self.base
        section = [(-x, -y), (x, -y)]
        if self.is_truncated:
            top = (self.full_height - self.section_height) * math.tan(self._half_apex)
            section += [(top, y), (-top, y)]
        else:
            section += [(0.0, y)]
        half_length = 0.5 * self.length
        return np.array([(x, y, z) for z in (-half_length, half_length) for x, y in section])

    @model_validator(mode="after")
    def _fits_its_triangle(self, info: ValidationInfo) -> Self:
        if self.height is not None and self.height > self.full_height * (1.0 + _ROUNDING):
            allowed = f"at most {length_text(self.full_height, info)}, where the faces meet"
            message = f"must be {allowed}; is {length_text(self.height, info)}"
            raise refusal(Problem("height", message, self.height, allowed))
        if not MIN_SIZE_M <= self.section_height <= MAX_LENGTH_M:
            allowed = "an angle that the base allows, or a height that cuts the apex off"
            high = length_text(self.section_height, info)
            message = f"makes a prism {high} high; allowed: {allowed}"
            raise refusal(Problem("apex_deg", message, self.apex_deg, allowed))
        return self
