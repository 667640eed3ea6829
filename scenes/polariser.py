"""The polariser: a sheet that lets one way of vibrating through and swallows the other."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from scenes.fields import Direction
from scenes.model import SceneModel

__all__ = ["Polariser"]

_LEAST_SINE = 1e-6
"""Of the angle between axis and normal: the part of the axis along the sheet must be known."""


class Polariser(SceneModel):
    """An ideal linear polariser: a sheet that neither reflects nor bends light.

    It swallows what vibrates along its absorbing axis, which lies in the sheet, across `axis`; a
    tilted one, what vibrates along that axis as seen along the ray.
    """

    type: Literal["polariser"] = Field(default="polariser", description="ideal linear polariser")
    axis: Direction = Field(
        description="light that vibrates this way passes; what counts is the part along the sheet"
    )

    def absorbing_axis(self, normal: ArrayLike) -> NDArray[np.float64] | None:
        """(3,), unit, in the sheet of unit normal (3,) and across the axis.

        None if the axis is perpendicular to the sheet.
        """
        across = np.cross(np.asarray(normal, dtype=np.float64), self.axis)
        sine = float(np.linalg.norm(across))
        return None if sine < _LEAST_SINE else across / sine
