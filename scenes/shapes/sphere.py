"""The sphere."""

from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from scenes.fields import Position, Size
from scenes.model import SceneModel
from scenes.shapes.bounds import Bounds

__all__ = ["Sphere"]


class Sphere(SceneModel):
    """A ball."""

    is_closed: ClassVar[bool] = True

    type: Literal["sphere"] = Field(default="sphere", description="ball")
    position: Position = Field(description="centre (length)")
    radius: Size = Field(description="radius (length)")

    def bounding_sphere(self) -> Bounds:
        """The sphere itself."""
        return np.array(self.position), self.radius
