"""Trees of boxes over triangles: complete, binary, and with as many triangles in each leaf.

Every node's triangles are parted at the median of their centroids along the widest axis, a level
at a time for all nodes at once. A triangle much larger than the others would swell the boxes of
all nodes above it, so it is entered in parts: each stands for it where the part is.

References:
    Wald (2007), "On fast construction of SAH-based bounding volume hierarchies", §2: the median
    split.
    Ernst & Greiner (2007), "Early split clipping for bounding volume hierarchies", §3: parts.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["MeshTree", "build_tree"]

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_LEAF_SIZE = 4
"""Triangles in a leaf, at most."""

_LARGE = 4.0
"""A triangle this many times as large as the middle one is entered in parts."""


@dataclass(frozen=True)
class MeshTree:
    """A tree: node i is above nodes 2i + 1 and 2i + 2.

    Attributes:
        low, high: (2^(levels + 1) − 1, 3) corners of the nodes' boxes.
        order: (leaves · leaf size) triangles in the order of the leaves; −1 fills up. A large one
            is there more than once.
        leaf_size: triangles in each leaf.
    """

    low: FloatArray
    high: FloatArray
    order: IntArray
    leaf_size: int

    @property
    def inner_nodes(self) -> int:
        """How many nodes are above the leaves; these come first."""
        return len(self.low) // 2


def build_tree(corners: FloatArray) -> MeshTree:
    """A tree over triangles, (m, 3, 3) their corners; m ≥ 1."""
    corners, owners = _parts(corners.copy())
    count = len(corners)
    levels = max(0, int(np.ceil(np.log2(count / _LEAF_SIZE))))
    leaves = 1 << levels
    leaf_size = -(-count // leaves)
    centroids = corners.mean(axis=1)
    order = np.concatenate([np.arange(count), np.full(leaves * leaf_size - count, count - 1)])
    is_filler = np.arange(len(order)) >= count
    for level in range(levels):
        size = len(order) >> level
        blocks = order.reshape(-1, size)
        places = centroids[blocks]
        axes = np.argmax(np.ptp(places, axis=1), axis=1)
        keys = np.take_along_axis(places, axes[:, None, None], axis=2)[:, :, 0]
        halves = np.argpartition(keys, size // 2, axis=1)
        order = np.take_along_axis(blocks, halves, axis=1).ravel()
        is_filler = np.take_along_axis(is_filler.reshape(-1, size), halves, axis=1).ravel()
    leaf_corners = corners[order].reshape(leaves, leaf_size * 3, 3)
    lows, highs = [leaf_corners.min(axis=1)], [leaf_corners.max(axis=1)]
    for _ in range(levels):
        lows.append(lows[-1].reshape(-1, 2, 3).min(axis=1))
        highs.append(highs[-1].reshape(-1, 2, 3).max(axis=1))
    order = np.where(is_filler, -1, owners[order])
    return MeshTree(np.concatenate(lows[::-1]), np.concatenate(highs[::-1]), order, leaf_size)


def _parts(corners: FloatArray) -> tuple[FloatArray, IntArray]:
    """Triangles (p, 3, 3), the large ones in parts, and which of those given each is of."""
    owners = np.arange(len(corners))
    limit = _LARGE * float(np.median(_extents(corners)))
    room = 2 * len(corners) + 64
    while len(corners) < room:
        extents = _extents(corners)
        large = np.flatnonzero(extents > max(limit, 0.5 * float(extents.max())))
        if not len(large):
            break
        # Halved across the longest side, which is turned to be the first.
        lengths = np.linalg.norm(np.roll(corners[large], -1, axis=1) - corners[large], axis=2)
        turns = (np.argmax(lengths, axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(corners[large], turns[:, :, None], 1), 1, 0)
        middle = 0.5 * (a + b)
        corners[large] = np.stack([a, middle, c], axis=1)
        corners = np.concatenate([corners, np.stack([middle, b, c], axis=1)])
        owners = np.concatenate([owners, owners[large]])
    return corners, owners


def _extents(corners: FloatArray) -> FloatArray:
    """(m,) the longest sides of triangles' boxes."""
    sides: FloatArray = np.ptp(corners, axis=1).max(axis=1)
    return sides
