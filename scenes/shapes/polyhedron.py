"""The convex polyhedron, given by its corners."""

from functools import lru_cache
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, model_validator

from scenes.budget import charge
from scenes.errors import Problem, refusal
from scenes.fields import MIN_SIZE_M, Position
from scenes.shapes.convex import ConvexSolid, Faces

__all__ = ["Polyhedron"]

_MAX_VERTICES = 512

_ON_HULL = 1e-9
"""Distance, as a fraction of the extent, within which a corner counts as on a face."""

_SAME_NORMAL = 1e-7
"""Normals closer than this belong to one face that the hull was given in triangles."""

_Vertices = Annotated[
    tuple[Position, ...], Field(min_length=4, max_length=_MAX_VERTICES, fail_fast=True)
]


class Polyhedron(ConvexSolid):
    """The convex hull of its vertices."""

    type: Literal["polyhedron"] = Field(default="polyhedron", description="convex polyhedron")
    vertices: _Vertices = Field(
        description="corners [x, y, z] in the local frame (lengths), 4 to 512, each on the hull"
    )

    def local_faces(self) -> Faces:
        """The faces of the hull; triangles in one plane are one face."""
        return _hull(self.vertices)

    def local_vertices(self) -> NDArray[np.float64]:
        """The corners, as given."""
        return np.array(self.vertices)

    @model_validator(mode="after")
    def _is_convex(self, info: ValidationInfo) -> Self:
        charge(info, "pairs of a polyhedron's corners", len(self.vertices) ** 2, "vertices")
        try:
            normals, offsets = _hull(self.vertices)
        except ValueError:
            allowed = "at least four corners that do not lie in one plane"
            raise refusal(Problem("vertices", f"must be {allowed}", None, allowed)) from None
        corners = np.array(self.vertices)
        depth = -(corners @ normals.T - offsets).max(axis=1)
        inside = depth > _ON_HULL * np.ptp(corners, axis=0).max()
        if inside.any():
            allowed = "corners of a convex solid"
            message = f"must be on the hull of the others; allowed: {allowed}"
            problems = [
                Problem(f"vertices[{index}]", message, self.vertices[index], allowed)
                for index in np.flatnonzero(inside)
            ]
            raise refusal(*problems)
        return self


@lru_cache(maxsize=256)
def _hull(vertices: tuple[tuple[float, float, float], ...]) -> Faces:
    """Outward unit normals and offsets of a convex hull (Barber, Dobkin & Huhdanpaa 1996).

    Raises:
        ValueError: if the vertices lie in one plane.
    """
    from scipy.spatial import ConvexHull, QhullError

    corners = np.array(vertices)
    centre = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    extent = float(np.ptp(corners, axis=0).max())
    if extent < MIN_SIZE_M:
        raise ValueError("all vertices are the same point")
    try:  # about its middle and of size 1, so that Qhull's absolute tolerances fit
        hull = ConvexHull((corners - centre) / extent)
    except QhullError as error:
        raise ValueError("the vertices lie in one plane") from error
    normals, count = np.zeros((len(hull.equations), 3)), 0
    for equation in hull.equations:
        normal = equation[:3] / np.linalg.norm(equation[:3])
        apart = np.linalg.norm(normals[:count] - normal, axis=1)
        if not (apart < _SAME_NORMAL).any():
            normals[count] = normal
            count += 1
    outward = normals[:count].copy()
    offsets = (corners @ outward.T).max(axis=0)
    outward.flags.writeable = offsets.flags.writeable = False  # the cache hands them out again
    return outward, offsets
