"""Where a mesh's smooth patches end: what the gather on them has to know.

A gather disc that overhangs a sharp edge or a border is corrected for the part beyond it. Most
discs do not, which a lower bound of the distance to the nearest border tells.
"""

import numpy as np
import numpy.typing as npt

from scenes.shapes import Surface

__all__ = ["distance_to_border", "neighbours_in_patch"]

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_MOST_PIECES = 64
"""Pieces that the longest border edges are cut into, so that a bound from their middles is near."""


def neighbours_in_patch(surface: Surface) -> IntArray:
    """(m, 3): the triangle across each side that is of the same patch, −1 where there is none."""
    there = surface.neighbours
    same = surface.patches[there] == surface.patches[:, None]
    return np.where((there >= 0) & same, there, -1)


def distance_to_border(surface: Surface) -> FloatArray:
    """(m,) a lower bound of the distance of any point of each triangle to a border [m].

    Of two points in a straight line, which is never longer than one on the surface. Infinite where
    no patch has a border.
    """
    from scipy.spatial import cKDTree

    triangles, sides = np.nonzero(neighbours_in_patch(surface) < 0)
    if not len(triangles):
        return np.full(len(surface.triangles), np.inf)
    corners = surface.corners
    start, end = corners[triangles, sides], corners[triangles, (sides + 1) % 3]
    lengths = np.linalg.norm(end - start, axis=1)
    pieces = np.clip(np.ceil(lengths / np.median(lengths)), 1, _MOST_PIECES).astype(np.int64)
    rows = np.repeat(np.arange(len(pieces)), pieces)
    within = np.arange(len(rows)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    middles = start[rows] + ((within + 0.5) / pieces[rows])[:, None] * (end - start)[rows]
    half = 0.5 * float((lengths / pieces).max())
    centroids = corners.mean(axis=1)
    radii = np.linalg.norm(corners - centroids[:, None], axis=2).max(axis=1)
    nearest, _ = cKDTree(middles).query(centroids)
    bound: FloatArray = np.maximum(nearest - half - radii, 0.0)
    return bound
