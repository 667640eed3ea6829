"""The camera: a pinhole with perspective."""

import math
from typing import Self

from pydantic import Field, model_validator

from scenes.errors import Problem, refusal
from scenes.fields import MIN_SIZE_M, Degrees, Direction, Position
from scenes.frames import Frame, frame_about
from scenes.model import SceneModel

__all__ = ["Camera"]


class Camera(SceneModel):
    """A pinhole camera; its picture is upright and not mirrored."""

    position: Position = Field(description="the pinhole, a point [x, y, z] (length)")
    look_at: Position = Field(description="the point in the middle of the picture (length)")
    up: Direction = Field(
        default=(0.0, 1.0, 0.0), description="direction that is up in the picture"
    )
    fov_deg: Degrees = Field(
        gt=0, lt=180, description="vertical field of view, more than 0 and less than 180 degrees"
    )

    def frame(self) -> Frame:
        """Unit vectors (right, up, backward) in the world, each (3,), right-handed."""
        frame = self._frame()
        assert frame is not None  # the validator below has made sure
        return frame

    def _frame(self) -> Frame | None:
        backward = tuple(p - q for p, q in zip(self.position, self.look_at, strict=True))
        distance = math.dist(self.position, self.look_at)
        x, y, z = (component / distance for component in backward)
        return frame_about((x, y, z), self.up)

    @model_validator(mode="after")
    def _sees_something(self) -> Self:
        if math.dist(self.position, self.look_at) < MIN_SIZE_M:
            allowed = "a point other than the camera's position"
            raise refusal(Problem("look_at", f"must be {allowed}", self.look_at, allowed))
        if self._frame() is None:
            allowed = "a direction not parallel to the line of sight"
            raise refusal(Problem("up", f"must be {allowed}, is {list(self.up)}", self.up, allowed))
        return self
