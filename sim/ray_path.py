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
            medium on both sides, hidden by another solid), "polarise" (a polariser), "deposit",
            "absorb", "escape", or "limit" if the ray was still going after `max_interactions`.
        objects: n names of the objects met, "" where nothing was.
        reflectances: (n,) reflectance at each vertex, of light as it is polarised there; 0 where
            the ray ends.
        absorptances: (n,) fraction of the flux lost on each segment to the medium, and to the
            mirror, metal or polariser at its end.
        polarisations: (n, 3), (q, u, v) on each segment, the Stokes vector over the flux.
        frames: (n, 3), unit, what q and u are told by: s, across the ray, with p = direction × s.
            See `sim.analytic_polarisation`.
        normals: (n, 3), unit, of the surface at each vertex, toward the ray that comes; 0 where
            nothing was met.
        wavelength_nm: of the ray.
    """

    points: FloatArray
    directions: FloatArray
    events: tuple[str, ...]
    objects: tuple[str, ...]
    reflectances: FloatArray
    absorptances: FloatArray
    polarisations: FloatArray
    frames: FloatArray
    normals: FloatArray
    wavelength_nm: float

    @property
    def deviation(self) -> float:
        """Angle between the first and the last direction [rad]."""
        return float(angle_between(self.directions[0], self.directions[-1]))

    @property
    def transmittance(self) -> float:
        """Fraction of the flux that takes this path."""
        return float(np.prod(self._factors))

    @property
    def stokes(self) -> FloatArray:
        """(n, 4), Stokes vector at the start of each segment, over the flux that set out."""
        flux = np.cumprod([1.0, *self._factors[:-1]])
        vectors: FloatArray = flux[:, None] * np.c_[np.ones(len(flux)), self.polarisations]
        return vectors

    @property
    def _factors(self) -> FloatArray:
        """(n,) part of the flux that goes on from each vertex along this path."""
        shares = [
            {"refract": 1.0 - r, "reflect": r}.get(event, 1.0)
            for event, r in zip(self.events, self.reflectances, strict=True)
        ]
        factors: FloatArray = np.array(shares) * (1.0 - self.absorptances)
        return factors
