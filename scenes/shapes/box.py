"""The box."""

from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from scenes.fields import Size
from scenes.shapes.convex import ConvexSolid, Faces

__all__ = ["Box"]


class Box(ConvexSolid):
    """A rectangular block about its centre."""

    type: Literal["box"] = Field(default="box", description="rectangular block")
    size: tuple[Size, Size, Size] = Field(description="[x, y, z] edge lengths (lengths)")

    def local_faces(self) -> Faces:
        """Six faces: +x, -x, +y, -y, +z, -z."""
        normals = np.array([sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)])
        return normals + 0.0, np.repeat(0.5 * np.array(self.size), 2)

    def local_vertices(self) -> NDArray[np.float64]:
        """Eight corners."""
        halves = [(-0.5 * edge, 0.5 * edge) for edge in self.size]
        return np.array(list(product(*halves)))
