"""How far shapes reach in a direction, and so whether two of them can meet."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.frames import rotation_matrix
from scenes.shapes.convex import ConvexSolid
from scenes.shapes.flat import Disk, FlatRectangle, Plane
from scenes.shapes.lens import Lens
from scenes.shapes.triangulated import Triangulated

__all__ = ["close_pairs", "count_close_pairs", "may_meet", "reach"]

FloatArray = NDArray[np.float64]


def reach(shape: Any, direction: FloatArray) -> float:  # noqa: PLR0911
    """The most that a point of `shape` has of `direction`: max of x · d [m], infinite for planes.

    That of a lens is of the cylinder around it: never less than its own. So is that of a shape
    that is not known here: its bounding sphere's.

    Args:
        shape: any shape.
        direction: (3,) unit.
    """
    if isinstance(shape, Plane):
        across = float(np.linalg.norm(np.cross(shape.normal, direction)))
        return math.inf if across > 1e-12 else float(np.dot(shape.position, direction))
    if isinstance(shape, ConvexSolid):
        return float(np.max(shape.vertices_world() @ direction))
    middle = float(np.dot(shape.position, direction))
    if isinstance(shape, Triangulated):  # of many vertices: the direction is turned, not they
        turned = direction @ rotation_matrix(shape.rotation_deg)
        return middle + float(np.max(shape.local_surface().vertices @ turned))
    if isinstance(shape, FlatRectangle):
        u, v, _ = shape.frame()
        half_u, half_v = 0.5 * shape.size[0], 0.5 * shape.size[1]
        return middle + half_u * abs(float(u @ direction)) + half_v * abs(float(v @ direction))
    if isinstance(shape, Disk):
        return middle + shape.radius * _sine(shape.normal, direction)
    if isinstance(shape, Lens):
        low, high = _ends(shape)
        along = float(np.dot(shape.axis, direction))
        return (
            middle
            + max(low * along, high * along)
            + 0.5 * shape.aperture * _sine(shape.axis, direction)
        )
    centre, radius = shape.bounding_sphere()
    return float(np.dot(centre, direction)) + float(radius)


def close_pairs(shapes: Sequence[Any], slack: float = 0.0) -> Iterator[tuple[int, int]]:
    """Pairs i < j of shapes whose bounding spheres are no further apart than `slack` [m].

    It sorts out nearly all pairs of a scene of many objects at little cost.
    """
    for i, close in enumerate(_close_to_each(shapes, slack)):
        for j in close:
            yield i, i + 1 + int(j)


def count_close_pairs(shapes: Sequence[Any]) -> int:
    """How many pairs of shapes have bounding spheres that meet."""
    return sum(len(close) for close in _close_to_each(shapes, 0.0))


def _close_to_each(shapes: Sequence[Any], slack: float) -> Iterator[NDArray[np.intp]]:
    """Of each shape but the last, the close ones among those behind it."""
    centres, radii = np.zeros((len(shapes), 3)), np.full(len(shapes), np.inf)
    for index, shape in enumerate(shapes):
        if not isinstance(shape, Plane):
            centres[index], radii[index] = shape.bounding_sphere()
    for i in range(len(shapes) - 1):
        apart = np.linalg.norm(centres[i + 1 :] - centres[i], axis=1)
        yield np.flatnonzero(apart - radii[i + 1 :] - radii[i] <= slack)


def may_meet(one: Any, other: Any, slack: float = 0.0) -> bool:
    """Whether two shapes come nearer to one another than `slack` [m]; if in doubt, they do.

    Two convex bodies are apart if and only if some direction parts them (the separating axis
    theorem; Ericson 2005, *Real-Time Collision Detection*, §5.2.1). The directions tried are
    those of faces and axes, and from centre to centre; edge against edge is not, so that bodies
    that only such a direction parts count as meeting.
    """
    for direction in _directions(one, other):
        for way in (direction, -direction):
            if -reach(other, -way) - reach(one, way) > slack:
                return False
    return True


def _directions(one: Any, other: Any) -> Iterator[FloatArray]:
    """Unit directions that may part two shapes, the likeliest first."""
    if not isinstance(one, Plane) and not isinstance(other, Plane):
        between = np.subtract(other.bounding_sphere()[0], one.bounding_sphere()[0])
        length = float(np.linalg.norm(between))
        if length > 0.0:
            yield between / length
        yield from np.eye(3)
    for shape in (one, other):
        if isinstance(shape, ConvexSolid):
            yield from shape.faces()[0]
        elif isinstance(shape, FlatRectangle):
            yield from shape.frame()
        elif isinstance(shape, Plane | Disk):
            yield np.array(shape.normal)
        elif isinstance(shape, Lens):
            yield np.array(shape.axis)


def _sine(axis: tuple[float, float, float], direction: FloatArray) -> float:
    """Sine of the angle between two unit vectors."""
    return float(np.linalg.norm(np.cross(axis, direction)))


def _ends(lens: Lens) -> tuple[float, float]:
    """Where the lens begins and ends along its axis, from its position [m]."""
    half, rim = 0.5 * lens.thickness, 0.5 * lens.aperture
    return -half + min(0.0, lens.first.sag(rim)), half + max(0.0, lens.second.sag(rim))
