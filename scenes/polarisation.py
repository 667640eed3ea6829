"""How light vibrates where it starts: natural, or polarised in part or whole."""

import math
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from scenes.fields import Degrees, Direction, Number
from scenes.frames import frame_about
from scenes.model import SceneModel

__all__ = ["Polarisation"]


class Polarisation(SceneModel):
    """Polarised light: which way it vibrates, and which part of it does.

    Angles are those of Born & Wolf 1999, Principles of Optics, §1.4.2 eq. (45): the Stokes vector
    is flux × (1, P cos 2χ cos 2ψ, P cos 2χ sin 2ψ, P sin 2χ), P the degree, ψ the angle from the
    reference and χ the ellipticity, right-handed where it is positive.
    """

    degree: Annotated[Number, Field(ge=0, le=1)] = Field(
        default=1.0, description="part of the light that is polarised, 0 to 1"
    )
    angle_deg: Degrees = Field(
        default=0.0,
        description="angle between the vibration and `up`, as seen across the ray: counterclockwise"
        " for one whom the light comes towards [degrees]",
    )
    ellipticity_deg: Degrees = Field(
        default=0.0,
        ge=-45,
        le=45,
        description="0 vibrates in a line, 45 is circular and right-handed (clockwise for one whom"
        " the light comes towards), -45 left-handed [degrees]",
    )
    up: Direction | None = Field(
        default=None,
        description="direction that angles are counted from, as far as it lies across the ray; if"
        " not given, as near as can be to +y, or to -z if the lamp shines up or down",
    )

    def stokes(self) -> NDArray[np.float64]:
        """(q, u, v), the Stokes vector over the flux, in the frame of `reference`."""
        psi, chi = math.radians(2.0 * self.angle_deg), math.radians(2.0 * self.ellipticity_deg)
        return self.degree * np.array(
            [math.cos(chi) * math.cos(psi), math.cos(chi) * math.sin(psi), math.sin(chi)]
        )

    def reference(self, direction: ArrayLike) -> NDArray[np.float64] | None:
        """(3,), the unit vector across a ray that angles are counted from.

        Args:
            direction: (3,), of the light, unit.

        Returns:
            None if `up` is parallel to the ray.
        """
        x, y, z = np.asarray(direction, dtype=np.float64)
        frame = frame_about((x, y, z), self.up)
        return None if frame is None else frame[1]
