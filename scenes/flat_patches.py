"""The flat parts of surfaces, and whether two of them lie in one place."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.shapes import ConvexSolid, Disk, FlatRectangle, Lens, Plane, Triangulated
from scenes.shapes.triangle_distance import nearest_on_triangles

__all__ = ["FlatPatch", "flat_patches", "share_a_place"]

FloatArray = NDArray[np.float64]

_PARALLEL = 1e-9
"""Sine of the angle between normals that count as parallel."""

_ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
"""Of the largest coordinate: how far apart what is meant to be in one place can be."""


@dataclass(frozen=True, eq=False)
class FlatPatch:
    """A convex polygon, a disk, or a plane without end.

    Attributes:
        middle: (3,) a point of it, a disk's centre [m].
        normal: (3,) unit.
        corners: (k, 3) of a polygon, in order around it [m]; none of a disk.
        radius: of a disk [m], infinite for a plane; 0 of a polygon.
    """

    middle: FloatArray
    normal: FloatArray
    corners: FloatArray
    radius: float = 0.0


def flat_patches(
    shape: Any, along: FloatArray, near: FloatArray | None = None, slack: float = 0.0
) -> Iterator[FlatPatch]:
    """Every flat part of a shape: of a lens its plane surfaces, of a mesh its triangles.

    Args:
        shape: any shape.
        along: (3,) unit; only the triangles with this normal, or its opposite, count.
        near: (3,) a point; only the triangles in its plane count; None: all [m].
        slack: how far from that plane they may be, rounding aside [m].
    """
    none = np.zeros((0, 3))
    if isinstance(shape, Plane | Disk):
        radius = shape.radius if isinstance(shape, Disk) else np.inf
        yield FlatPatch(np.array(shape.position), np.array(shape.normal), none, radius)
    elif isinstance(shape, FlatRectangle):
        u, v, normal = shape.frame()
        u, v = 0.5 * shape.size[0] * u, 0.5 * shape.size[1] * v
        middle = np.array(shape.position)
        yield FlatPatch(middle, normal, middle + np.array([-u - v, u - v, u + v, v - u]))
    elif isinstance(shape, Lens):
        for vertex, surface in zip(shape.vertices(), (shape.first, shape.second), strict=True):
            if surface.curvature == 0.0:
                yield FlatPatch(vertex, np.array(shape.axis), none, 0.5 * shape.aperture)
    elif isinstance(shape, Triangulated):
        triangles = shape.surface()
        normals = triangles.facet_normals
        some = _PARALLEL >= np.linalg.norm(np.cross(normals, along), axis=1)
        corners = shape.vertices_world()[triangles.triangles]
        if near is not None:
            between = corners[:, 0] - near
            farthest = max(float(np.abs(corners).max(initial=0.0)), float(np.abs(near).max()))
            aslant = _PARALLEL * np.linalg.norm(between, axis=1)
            some &= np.abs(between @ along) <= slack + _ROUNDING * farthest + aslant
        for row in np.flatnonzero(some):
            yield FlatPatch(corners[row, 0], normals[row], corners[row])
    elif isinstance(shape, ConvexSolid):
        vertices = shape.vertices_world()
        for normal, offset in zip(*shape.faces(), strict=True):
            heights = (vertices - np.array(shape.position)) @ normal - offset
            corners = vertices[heights > -1e-9 * np.ptp(vertices, axis=0).max()]
            yield FlatPatch(corners[0], normal, _around(corners, normal))


def _around(corners: FloatArray, normal: FloatArray) -> FloatArray:
    """The corners of a convex polygon, sorted by the angle around its middle."""
    out = corners - corners.mean(axis=0)
    u = out[0]
    angles = np.arctan2(out @ np.cross(normal, u), out @ u)
    return corners[np.argsort(angles)]


def share_a_place(one: FlatPatch, other: FlatPatch, touch: float) -> bool:
    """Whether two patches lie in one plane and have more than an edge in common.

    Args:
        one: a patch.
        other: a patch.
        touch: how far apart planes are one, and how wide what is in common must be [m].
    """
    # Coordinates far from the origin are rounded across planes as well as along them.
    touch = touch + _ROUNDING * float(np.abs([one.middle, other.middle]).max())
    if np.linalg.norm(np.cross(one.normal, other.normal)) > _PARALLEL:
        return False
    between = other.middle - one.middle
    lift = one.normal if np.isinf(one.radius) else other.normal  # a plane's middle may be far
    if abs(float(between @ lift)) > touch:
        return False
    if np.isinf(one.radius) or np.isinf(other.radius):
        return True
    if len(one.corners) and len(other.corners):
        return not (_parted(one, other, touch) or _parted(other, one, touch))
    if len(one.corners) or len(other.corners):
        polygon, disk = (one, other) if len(one.corners) else (other, one)
        return _distance(polygon, disk.middle) < disk.radius - touch
    return float(np.linalg.norm(between)) < one.radius + other.radius - touch


def _parted(one: FlatPatch, other: FlatPatch, touch: float) -> bool:
    """Whether a side of `one` has all of `other` beyond it (the separating axis theorem)."""
    middle = one.corners.mean(axis=0)
    for start, end in zip(one.corners, np.roll(one.corners, -1, axis=0), strict=True):
        out = np.cross(end - start, one.normal)
        length = float(np.linalg.norm(out))
        if length == 0.0:
            continue
        out = out / length * np.sign((start - middle) @ out)
        if float(np.min((other.corners - start) @ out)) > -touch:
            return True
    return False


def _distance(polygon: FlatPatch, point: FloatArray) -> float:
    """Of a point in a polygon's plane from the polygon [m]; 0 inside."""
    first, rest = polygon.corners[0], polygon.corners[1:]
    fan = np.array([(first, a, b) for a, b in itertools.pairwise(rest)])
    return float(np.min(np.linalg.norm(nearest_on_triangles(point, fan) - point, axis=1)))
