"""Shapes made of triangles: what meshes and height fields have in common."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from scenes.fields import Position, Rotation
from scenes.frames import rotation_matrix
from scenes.model import SceneModel
from scenes.shapes.bounds import Bounds, sphere_around
from scenes.shapes.surface import Surface

__all__ = ["Triangulated"]


class Triangulated(SceneModel):
    """A surface of triangles, described in a local frame and then turned and placed."""

    position: Position = Field(description="where the local origin goes (length)")
    rotation_deg: Rotation = Field(
        default=(0.0, 0.0, 0.0), description="turns about the fixed x, then y, then z axes [deg]"
    )

    def local_surface(self) -> Surface:
        """The triangles in the local frame."""
        raise NotImplementedError

    def surface(self) -> Surface:
        """The triangles in the world's orientation, relative to `position`."""
        return _turned(self.local_surface(), self.rotation_deg)

    def vertices_world(self) -> NDArray[np.float64]:
        """The corners in the world, (k, 3) [m]."""
        return np.array(self.position) + self.surface().vertices

    def bounding_sphere(self) -> Bounds:
        """A sphere around the surface, as tight for every rotation."""
        centre, radius = sphere_around(self.local_surface().vertices)
        return np.array(self.position) + rotation_matrix(self.rotation_deg) @ centre, radius

    @property
    def is_closed(self) -> bool:
        """Whether it encloses a volume."""
        return not self.openness

    @property
    def openness(self) -> str:
        """Why it encloses no volume, in words; "" if it does."""
        surface = self.local_surface()
        if surface.seams.text:
            return f"it is not watertight: {surface.seams.text}"
        return "it is inside out" if surface.volume <= 0.0 else ""


@lru_cache(maxsize=16)
def _turned(surface: Surface, rotation_deg: tuple[float, float, float]) -> Surface:
    """Kept: how far a mesh reaches is asked for in dozens of directions, one by one."""
    return surface.moved(rotation_matrix(rotation_deg))
