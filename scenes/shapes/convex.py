"""Convex solids with flat faces: what boxes, prisms and polyhedra have in common."""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from scenes.fields import Position, Rotation
from scenes.frames import rotation_matrix
from scenes.model import SceneModel
from scenes.shapes.bounds import Bounds, sphere_around

__all__ = ["ConvexSolid", "Faces"]

Faces = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Outward unit normals (m, 3) and offsets (m,) [m]: the solid is where normals @ x <= offsets."""


class ConvexSolid(SceneModel):
    """A convex polyhedron, described in a local frame and then turned and placed."""

    is_closed: ClassVar[bool] = True

    position: Position = Field(description="where the local origin goes (length)")
    rotation_deg: Rotation = Field(
        default=(0.0, 0.0, 0.0), description="turns about the fixed x, then y, then z axes [deg]"
    )

    def local_faces(self) -> Faces:
        """The faces in the local frame."""
        raise NotImplementedError

    def local_vertices(self) -> NDArray[np.float64]:
        """The corners in the local frame, (k, 3) [m]."""
        raise NotImplementedError

    def faces(self) -> Faces:
        """The faces: outward unit normals in the world, and offsets relative to `position`.

        A point x of the world is inside where normals @ (x - position) < offsets.
        """
        normals, offsets = self.local_faces()
        return normals @ rotation_matrix(self.rotation_deg).T, offsets

    def vertices_world(self) -> NDArray[np.float64]:
        """The corners in the world, (k, 3) [m]."""
        rotation = rotation_matrix(self.rotation_deg)
        return np.array(self.position) + np.asarray(self.local_vertices() @ rotation.T)

    def bounding_sphere(self) -> Bounds:
        """A sphere around the solid, as tight for every rotation."""
        centre, radius = sphere_around(self.local_vertices())
        return np.array(self.position) + rotation_matrix(self.rotation_deg) @ centre, radius
