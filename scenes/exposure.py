"""How a photographer sets a camera: sensitivity, shutter and f-number.

The focal plane receives H = q L t / N² lux seconds from a luminance L, with q = 0.65 for a common
lens, and a sensor of speed S is saturated at H = 78/S (ISO 12232:2019, §6.2; ISO 2720:1974 for q).
Hence the luminance that becomes full white:

    L = (78 / 0.65) N² / (S t) = 120 N² / (S t)  [cd m⁻²]
"""

from typing import Final

from pydantic import Field

from scenes.fields import Positive
from scenes.model import SceneModel

__all__ = ["SensorExposure"]

_SATURATION_LX_S: Final = 78.0
_LENS_FACTOR: Final = 0.65


class SensorExposure(SceneModel):
    """Sensitivity, shutter and f-number; together they say what luminance is white."""

    iso: Positive = Field(default=100.0, description="speed of the sensor, ISO arithmetic")
    shutter_s: Positive = Field(description="time that the shutter is open [s]")
    f_number: Positive | None = Field(
        default=None, description="focal length over the aperture's diameter; the lens' own if not"
        " given, but a pinhole has none",
    )  # fmt: skip

    def white_luminance(self, f_number: float) -> float:
        """Luminance that becomes full white [cd/m²], through a lens of this f-number."""
        factor = _SATURATION_LX_S / _LENS_FACTOR
        return factor * f_number**2 / (self.iso * self.shutter_s)
