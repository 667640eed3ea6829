"""Flat shapes without thickness: they bound no medium, so they carry surfaces only."""

import math
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from scenes.errors import Problem, refusal
from scenes.fields import Direction, Position, Size
from scenes.frames import Frame, frame_about
from scenes.model import SceneModel
from scenes.shapes.bounds import Bounds

__all__ = ["Disk", "FlatRectangle", "Plane", "Rectangle"]


class Plane(SceneModel):
    """An infinite plane."""

    is_closed: ClassVar[bool] = False

    type: Literal["plane"] = Field(default="plane", description="infinite plane")
    position: Position = Field(description="any point of the plane (length)")
    normal: Direction = Field(description="normal; its length does not matter")


class FlatRectangle(SceneModel):
    """A rectangle's place and orientation, for surfaces and for lamps."""

    position: Position = Field(description="centre (length)")
    size: tuple[Size, Size] = Field(description="[width, height] (lengths)")
    normal: Direction = Field(default=(0.0, 1.0, 0.0), description="normal")
    up: Direction | None = Field(
        default=None,
        description="direction of the height; where not given, as near as can be to +y, or to -z"
        " if the rectangle is horizontal",
    )

    def frame(self) -> Frame:
        """Unit vectors (u, v, n), each (3,): along the width, along the height, the normal."""
        frame = frame_about(self.normal, self.up)
        assert frame is not None  # the validator below has made sure
        return frame

    def bounding_sphere(self) -> Bounds:
        """The smallest sphere around the rectangle."""
        width, height = self.size
        return np.array(self.position), 0.5 * math.hypot(width, height)

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        if frame_about(self.normal, self.up) is None:
            allowed = "a direction not parallel to the normal"
            raise refusal(Problem("up", f"must be {allowed}", self.up, allowed))
        return self


class Rectangle(FlatRectangle):
    """A rectangle."""

    is_closed: ClassVar[bool] = False

    type: Literal["rectangle"] = Field(default="rectangle", description="flat rectangle")


class Disk(SceneModel):
    """A disk."""

    is_closed: ClassVar[bool] = False

    type: Literal["disk"] = Field(default="disk", description="flat disk")
    position: Position = Field(description="centre (length)")
    normal: Direction = Field(description="normal; its length does not matter")
    radius: Size = Field(description="radius (length)")

    def bounding_sphere(self) -> Bounds:
        """The smallest sphere around the disk."""
        return np.array(self.position), self.radius
