"""The beam: light from a bounded cross-section, all in nearly one direction."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from scenes.emitters.emitter import LocalEmitter
from scenes.emitters.mask import Mask
from scenes.errors import Problem, refusal
from scenes.fields import Degrees, Direction, Position, Size
from scenes.frames import Frame, frame_about
from scenes.model import SceneModel

__all__ = ["Beam", "Profile", "RoundProfile", "SlitProfile"]


class RoundProfile(SceneModel):
    """A disk, evenly filled."""

    type: Literal["round"] = Field(default="round", description="evenly filled disk")
    radius: Size = Field(description="radius (length)")


class SlitProfile(SceneModel):
    """A rectangle, evenly filled, or as a mask says."""

    type: Literal["slit"] = Field(default="slit", description="rectangle")
    width: Size = Field(description="extent across `up` (length)")
    height: Size = Field(description="extent along `up` (length)")
    up: Direction | None = Field(
        default=None,
        description="direction of the height; where not given, as near as can be to +y, or to -z"
        " if the beam is vertical",
    )
    mask: Mask | None = Field(
        default=None, description="where the light comes through; everywhere if not given"
    )


Profile = Annotated[RoundProfile | SlitProfile, Field(discriminator="type")]
"""The cross-section of a beam where it starts."""


class Beam(LocalEmitter):
    """A beam that starts from a profile perpendicular to its direction."""

    type: Literal["beam"] = Field(default="beam", description="collimated beam")
    position: Position = Field(description="centre of the profile (length)")
    direction: Direction = Field(description="where the light goes")
    profile: Profile = Field(description="cross-section at the start")
    divergence_deg: Degrees = Field(
        default=0.0,
        ge=0,
        lt=90,
        description="half angle of the cone that directions fill evenly, 0 to 90 [degrees]",
    )

    def frame(self) -> Frame:
        """Unit vectors (u, v, n), each (3,): along the width, along the height, the direction."""
        frame = self._frame()
        assert frame is not None  # the validator below has made sure
        return frame

    def _frame(self) -> Frame | None:
        up = self.profile.up if isinstance(self.profile, SlitProfile) else None
        return frame_about(self.direction, up)

    @model_validator(mode="after")
    def _has_a_frame(self) -> Self:
        if isinstance(self.profile, SlitProfile) and self._frame() is None:
            allowed = "a direction not parallel to the beam's"
            raise refusal(Problem("profile.up", f"must be {allowed}", self.profile.up, allowed))
        return self
