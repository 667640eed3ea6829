"""The path of one ray: its vertices, and what happened at each."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim.analytic import angle_between

__all__ = ["RayPath"]

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RayPath:
    """Where one ray went.

    Attributes:
        points: (n + 1, 3), start, vertices and end [m]. A ray that escapes ends at the scene's
            bounds, or one unit further where it has left them already.
        directions: (n, 3), unit, of each segment.
        events: n strings, what happened at the end of each segment: "refract", "reflect",
            "total internal reflection", "mirror" (a metal too), "pass" (a face with the same
            medium on both sides, hidden by another solid), "deposit", "absorb", "escape", or
            "limit" if the ray was still going after `max_interactions`.
        objects: n names of the objects met, "" where nothing was.
        reflectances: (n,) mean reflectance of s and p light at each vertex; 0 where the ray
            ends.
        absorptances: (n,) fraction of the flux lost on each segment to the medium, and to the
            mirror or metal at its end.
        wavelength_nm: of the ray.
    """

    points: FloatArray
    directions: FloatArray
    events: tuple[str, ...]
    objects: tuple[str, ...]
    reflectances: FloatArray
    absorptances: FloatArray
    wavelength_nm: float

    @property
    def deviation(self) -> float:
        """Angle between the first and the last direction [rad]."""
        return float(angle_between(self.directions[0], self.directions[-1]))

    @property
    def transmittance(self) -> float:
        """Fraction of the flux that takes this path."""
        factors = [
            {"refract": 1.0 - r, "reflect": r}.get(event, 1.0)
            for event, r in zip(self.events, self.reflectances, strict=True)
        ]
        return float(np.prod(factors) * np.prod(1.0 - self.absorptances))
