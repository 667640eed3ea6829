"""How far points are from triangles, and on which side of a closed surface of them.

References:
    Ericson (2005), *Real-Time Collision Detection*, §5.1.5: the nearest point of a triangle.
    van Oosterom & Strackee (1983), "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng.
    30(2), 125.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["depth_inside", "nearest_on_triangles"]

FloatArray = NDArray[np.float64]

_INSIDE = 0.5
"""Of a whole turn: a closed surface fills 1 of the sphere around a point inside, and 0 outside."""


def nearest_on_triangles(point: FloatArray, corners: FloatArray) -> FloatArray:
    """(m, 3): the nearest point of each triangle to a point.

    Args:
        point: (3,) [m].
        corners: (m, 3, 3) [m].
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = _cross(b - a, c - a)
    area2 = _dot(normal, normal)
    height = _dot(a - point, normal)
    scale = np.divide(height, area2, out=np.zeros_like(area2), where=area2 > 0.0)
    foot = point + scale[:, None] * normal
    within = area2 > 0.0
    best = np.full(len(corners), np.inf)
    nearest = foot.copy()
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        within &= _dot(_cross(along, foot - start), normal) >= 0.0
        length2 = _dot(along, along)
        way = _dot(point - start, along)
        share = np.divide(way, length2, out=np.zeros_like(way), where=length2 > 0.0)
        candidate = start + np.clip(share, 0.0, 1.0)[:, None] * along
        distance2 = np.sum((candidate - point) ** 2, axis=1)
        nearest[distance2 < best] = candidate[distance2 < best]
        best = np.minimum(best, distance2)
    nearest[within] = foot[within]
    return nearest


def depth_inside(point: FloatArray, corners: FloatArray) -> float:
    """How deep a point is inside a closed surface of triangles [m]; negative outside it.

    Inside is where the triangles' solid angles Ω add up to a whole sphere: with a, b and c from
    the point to the corners, tan(Ω/2) = a·(b × c) / (abc + (a·b)c + (b·c)a + (c·a)b).

    Args:
        point: (3,) [m].
        corners: (m, 3, 3) [m], counter-clockwise seen from outside.
    """
    a, b, c = np.moveaxis(corners - point, 1, 0)
    lengths = [np.sqrt(_dot(one, one)) for one in (a, b, c)]
    below = lengths[0] * lengths[1] * lengths[2]
    below += _dot(a, b) * lengths[2] + _dot(b, c) * lengths[0] + _dot(c, a) * lengths[1]
    turns = float(np.sum(np.arctan2(_dot(a, _cross(b, c)), below))) / (2.0 * np.pi)
    # Only triangles with a corner this near can have the nearest point.
    nearest_corner = float(np.min(lengths))
    side = np.sqrt(np.maximum(_dot(b - a, b - a), _dot(c - a, c - a)))
    near = corners[lengths[0] - side <= nearest_corner]
    ways = nearest_on_triangles(point, near) - point
    distance = float(np.sqrt(np.min(_dot(ways, ways))))
    return distance if turns > _INSIDE else -distance


def _dot(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->i", one, other))


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    (a, b, c), (d, e, f) = one.T, other.T
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=1)
