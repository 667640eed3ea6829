"""How deep a solid of triangles and another solid enter one another.

Two solids share space if the surface of one has a point inside the other, or else if one holds the
other whole, which any of the other's points tells. So triangles are searched for the point that is
deepest inside the other solid, and one inner point decides what is left.

- Against a sphere, the deepest point of a triangle is the nearest to the centre: exact.
- Against a convex solid of flat faces, and against a lens, triangles are cut into ever smaller ones
  where the depth may still be more than the deepest found: by the faces' planes, which is exact, of
  a lens by how steep its height can be, down to 1/64 of a triangle's side.
- Against triangles, every edge is tested against every face near it, and the pieces behind pierced
  faces are asked how deep they are, the longest first, 256 at most; if none is, so are points
  behind some triangles. The depth found is never too much, and often too little. It can miss solids
  that share space without an edge through a face's inside, as twins shifted along their own edges
  do, if no point that is asked is in both; and, of more than 131,072 pairs of triangles near one
  another, or 262,144 triangles, those that are not followed.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.shapes import ConvexSolid, Sphere, Triangulated
from scenes.shapes.depth import height_above
from scenes.shapes.triangle_distance import depth_inside, nearest_on_triangles
from scenes.shapes.triangle_pairs import box_pairs

__all__ = ["mesh_overlap_depth"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_ACCURACY = 1e-3
"""Relative: how near the depth found comes to the deepest."""

_LEVELS = {True: 40, False: 6}
"""How often triangles are halved; by whether the bounds are exact."""

_MOST = 1 << 17
"""Triangles, and pairs of them, that are followed at once: time, and memory, are bounded."""

_PROBES = 8
"""Points that are asked in any case: which of them is deepest is told."""

_MOST_PROBES = 256
"""Points that are asked, one after the other, until one is inside both solids."""

_ASKED = 1 << 20
"""Points of which the depth inside triangles is found, at most; each asks all of the triangles, and
all together about this many, so that the largest meshes do not keep a scene from loading."""

_STEEPEST = 2.0
"""A lens's height changes by at most this times the way, where it matters: near its surface."""


def mesh_overlap_depth(mesh: Triangulated, other: Any, touch: float) -> float:
    """How deep the surface of one solid lies inside the other [m]; 0 if neither enters the other.

    Args:
        mesh: a closed one.
        other: a closed shape of any kind.
        touch: what counts as touching [m].
    """
    corners = mesh.vertices_world()[mesh.surface().triangles]
    if isinstance(other, Triangulated):
        others = other.vertices_world()[other.surface().triangles]
        return _between_meshes(corners, others, touch)
    depth = _deepest(corners, other, touch)
    if depth > touch:
        return depth
    inner = _inner_point(other)
    height = height_above(other, inner[None, :])
    assert height is not None  # every closed shape but triangles is known there
    # What holds the other whole holds it as deep as it is itself.
    return -float(height[0]) if depth_inside(inner, corners) > touch else depth


def _inner_point(shape: Any) -> FloatArray:
    if isinstance(shape, ConvexSolid):
        return np.asarray(shape.vertices_world().mean(axis=0))
    return np.asarray(shape.position, dtype=np.float64)


def _deepest(corners: FloatArray, other: Any, touch: float) -> float:
    """How deep a point of triangles is inside a solid that has a formula; 0 if none is."""
    if isinstance(other, Sphere):
        centre = np.asarray(other.position)
        nearest = nearest_on_triangles(centre, corners)
        distance = np.sqrt(np.min(np.sum((nearest - centre) ** 2, axis=1)))
        return max(0.0, other.radius - float(distance))
    best = 0.0
    for _ in range(_LEVELS[isinstance(other, ConvexSolid)]):
        middles = corners.mean(axis=1)
        heights = height_above(other, middles)
        assert heights is not None
        best = max(best, -float(heights.min()))
        bounds = _depth_bounds(corners, middles, heights, other)
        may = bounds > max(best * (1.0 + _ACCURACY), touch)
        order = np.argsort(-bounds[may], kind="stable")[: _MOST // 4]
        corners = _halved(corners[may][order])
        if not len(corners):
            break
    return best


def _depth_bounds(
    corners: FloatArray, middles: FloatArray, heights: FloatArray, other: Any
) -> FloatArray:
    """(m,): what no point of a triangle is deeper inside the solid than [m]."""
    if isinstance(other, ConvexSolid):
        normals, offsets = other.faces()
        bounds = np.full(len(corners), np.inf)
        for normal, offset in zip(normals, offsets, strict=True):
            depths = offset - (corners - np.asarray(other.position)) @ normal
            np.minimum(bounds, depths.max(axis=1), out=bounds)
        return bounds
    reach = np.linalg.norm(corners - middles[:, None, :], axis=2).max(axis=1)
    bounds = _STEEPEST * reach - heights
    return np.asarray(bounds)


def _halved(corners: FloatArray) -> FloatArray:
    """Four triangles of half the size for each."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def _between_meshes(one: FloatArray, other: FloatArray, touch: float) -> float:
    """The depth inside each of two closed surfaces of some points of the other's."""
    low = np.maximum(one.min(axis=(0, 1)), other.min(axis=(0, 1)))
    high = np.minimum(one.max(axis=(0, 1)), other.max(axis=(0, 1)))
    near = [
        corners[np.all((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low), axis=1)]
        for corners in (one, other)
    ]
    if np.any(low > high) or not (len(near[0]) and len(near[1])):
        return 0.0
    most = max(1, min(_MOST_PROBES, _ASKED // max(len(one), len(other))))
    steps = [1 + len(corners) // (2 * _MOST) for corners in near]
    near = [corners[::step] for corners, step in zip(near, steps, strict=True)]
    i, j = box_pairs(near[0], near[1], _MOST)
    sides = ((near[0], near[1][j], i, other), (near[1], near[0][i], j, one))
    probes = [
        (_piercing(rows, mine, faces, touch)[:most], whole) for mine, faces, rows, whole in sides
    ]
    depth = _deepest_of(probes, touch)
    if depth <= touch:
        few = min(_PROBES, most)
        probes = [(_just_inside(mine, touch, few), whole) for mine, _, _, whole in sides]
        depth = _deepest_of(probes, touch)
    if depth > touch:
        for middle in (0.5 * (low + high), one.mean(axis=(0, 1)), other.mean(axis=(0, 1))):
            depth = max(depth, min(depth_inside(middle, one), depth_inside(middle, other)))
    return depth


def _deepest_of(probes: list[tuple[FloatArray, FloatArray]], touch: float) -> float:
    """Of points (k, 3), each with the triangles that it may be inside; 0 if none is.

    Of the first few it is the deepest; more are asked until one is deeper than `touch`.
    """
    depth = 0.0
    for points, whole in probes:
        for row, point in enumerate(points):
            if row >= _PROBES and depth > touch:
                break
            depth = max(depth, depth_inside(point, whole))
    return depth


def _just_inside(corners: FloatArray, touch: float, count: int) -> FloatArray:
    """(k, 3): points behind the middles of some triangles.

    What is just behind its own surface, and deeper than `touch` inside another one, is in both,
    even where the surfaces are the same; where solids are flush, it is outside the other one.
    """
    some = corners[np.unique(np.linspace(0, len(corners) - 1, count).astype(np.int64))]
    normals = np.cross(some[:, 1] - some[:, 0], some[:, 2] - some[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    return np.asarray(some.mean(axis=1) - 4.0 * touch * normals)


def _piercing(rows: IntArray, edged: FloatArray, faces: FloatArray, touch: float) -> FloatArray:
    """(k, 3): middles of pieces of edges that begin or end in a pierced face, the longest first.

    Args:
        rows: (n,) of `edged`: whose edges are followed.
        edged: (m, 3, 3) triangles.
        faces: (n, 3, 3) the triangle that each of them may pierce.
        touch: ends nearer to the face's plane than this [m] do not pierce it.
    """
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    heights = np.einsum("nij,nj->ni", edged[rows] - faces[:, :1], normals)
    edges, shares, enters = [], [], []
    for side in range(3):
        start, end = heights[:, side], heights[:, (side + 1) % 3]
        clear = (np.minimum(start, end) < -touch) & (np.maximum(start, end) > touch)
        row = np.flatnonzero(clear)
        share = start[row] / (start[row] - end[row])
        a, b = edged[rows[row], side], edged[rows[row], (side + 1) % 3]
        within = _is_over(a + share[:, None] * (b - a), faces[row], normals[row])
        edges.append(3 * rows[row][within] + side)
        shares.append(share[within])
        enters.append(start[row][within] > 0.0)
    edge, share, enter = (np.concatenate(parts) for parts in (edges, shares, enters))
    if not len(edge):
        return np.zeros((0, 3))
    order = np.lexsort((share, edge))
    edge, share, enter = edge[order], share[order], enter[order]
    fresh = np.diff(edge, prepend=-1) != 0
    before = np.where(fresh, 0.0, np.roll(share, 1))
    after = np.where(np.roll(fresh, -1), 1.0, np.roll(share, -1))
    first, last = np.where(enter, share, before), np.where(enter, after, share)
    a, b = edged[edge // 3, edge % 3], edged[edge // 3, (edge + 1) % 3]
    longest = np.argsort(-np.linalg.norm(b - a, axis=1) * (last - first), kind="stable")
    middles = a + (0.5 * (first + last))[:, None] * (b - a)
    return np.asarray(middles[longest])


def _is_over(points: FloatArray, faces: FloatArray, normals: FloatArray) -> NDArray[np.bool_]:
    """Whether points (k, 3) in the planes of triangles (k, 3, 3) lie in them."""
    over = np.ones(len(points), dtype=bool)
    for side in range(3):
        along = faces[:, (side + 1) % 3] - faces[:, side]
        turn = np.cross(along, points - faces[:, side])
        over &= np.einsum("ij,ij->i", turn, normals) >= 0.0
    return over
