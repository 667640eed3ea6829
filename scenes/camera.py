"""The camera: perspective through a pinhole, or through a thin lens that is focused.

A thin lens of focal length f images a plane at the distance s in front of it at the distance v
behind it, 1/s + 1/v = 1/f (Hecht 2017, *Optics*, §5.2.3). The field of view is that of the focused
picture, tan(fov/2) = h/(2v) with the sensor's height h, so that f follows from fov, h and s. The
f-number is N = f/(2R), with the aperture's radius R.
"""

import math
from typing import Self

from pydantic import Field, model_validator

from scenes.errors import Problem, refusal
from scenes.exposure import SensorExposure
from scenes.fields import MIN_SIZE_M, Degrees, Direction, Extent, Position, Positive, Size
from scenes.frames import Frame, frame_about
from scenes.model import SceneModel

__all__ = ["Camera"]


class Camera(SceneModel):
    """A camera; its picture is upright and not mirrored.

    Without an aperture it is a pinhole, and everything is sharp.
    """

    position: Position = Field(
        description="the pinhole, or the middle of the lens, a point [x, y, z] (length)"
    )
    look_at: Position = Field(description="the point in the middle of the picture (length)")
    up: Direction = Field(
        default=(0.0, 1.0, 0.0), description="direction that is up in the picture"
    )
    fov_deg: Degrees = Field(
        gt=0, lt=180, description="vertical field of view, more than 0 and less than 180 degrees"
    )
    aperture_radius: Extent | None = Field(
        default=None,
        description="radius of the lens' aperture (length); a pinhole if 0 or not given",
    )
    f_number: Positive | None = Field(
        default=None,
        description="focal length over the aperture's diameter, in place of aperture_radius",
    )
    focus_distance: Size | None = Field(
        default=None,
        description="distance along the line of sight from the lens to the plane that is sharp"
        " (length); as far as look_at if not given",
    )
    sensor_height: Size = Field(
        default=0.024,
        description="height of the sensor (length); with fov_deg it decides the focal length, and"
        " so what an f-number means; 24 mm if not given",
    )

    exposure: SensorExposure | None = Field(
        default=None,
        description="sensitivity and shutter, from which the exposure of the picture follows;"
        " in place of the film's exposure_stops",
    )

    @property
    def white_luminance(self) -> float | None:
        """Luminance that the exposure makes full white [cd/m²]; None where there is none."""
        if self.exposure is None:
            return None
        f_number = self.exposure.f_number or self.f_number
        if f_number is None:
            f_number = 0.5 * self.focal_length / self.lens_radius
        return self.exposure.white_luminance(f_number)

    @property
    def sharp_distance(self) -> float:
        """Distance along the line of sight from the lens to the plane that is sharp [m]."""
        distance = self.focus_distance
        return math.dist(self.position, self.look_at) if distance is None else distance

    @property
    def focal_length(self) -> float:
        """Focal length of the lens: 1/f = 1/s + 1/v with v = h / (2 tan(fov/2)) [m]."""
        image_distance = 0.5 * self.sensor_height / math.tan(0.5 * math.radians(self.fov_deg))
        return 1.0 / (1.0 / self.sharp_distance + 1.0 / image_distance)

    @property
    def lens_radius(self) -> float:
        """Radius of the aperture [m], whichever way it is given; 0 for a pinhole."""
        if self.f_number is None:
            return self.aperture_radius or 0.0
        return 0.5 * self.focal_length / self.f_number

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

    @model_validator(mode="after")
    def _has_one_aperture(self) -> Self:
        if self.f_number is not None and self.aperture_radius is not None:
            allowed = "aperture_radius or f_number, not both"
            raise refusal(Problem("f_number", f"allowed: {allowed}", self.f_number, allowed))
        if self.focus_distance is not None and self.lens_radius == 0.0:
            allowed = "left out, or an aperture_radius or f_number given: a pinhole has no focus"
            message = f"must be {allowed}"
            raise refusal(Problem("focus_distance", message, self.focus_distance, allowed))
        if self.exposure is not None and self.exposure.f_number is None and not self.lens_radius:
            allowed = "given, since a pinhole has no f-number of its own"
            raise refusal(Problem("exposure.f_number", f"must be {allowed}", None, allowed))
        return self
