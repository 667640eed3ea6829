"""Trees of boxes over triangles: complete, binary, and with as many triangles in each leaf.

Every node's triangles are parted at the median of their centroids along the widest axis, a level
at a time for all nodes at once. Reference: Wald (2007), "On fast construction of SAH-based
bounding volume hierarchies", §2, on the median split.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["MeshTree", "build_tree"]

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_LEAF_SIZE = 4
"""Triangles in a leaf, at most."""


@dataclass(frozen=True)
class MeshTree:
    """A tree: node i is above nodes 2i + 1 and 2i + 2.

    Attributes:
        low, high: (2^(levels + 1) − 1, 3) corners of the nodes' boxes.
        order: (leaves · leaf size) triangles in the order of the leaves; −1 fills up.
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
    order = np.where(is_filler, -1, order)
    return MeshTree(np.concatenate(lows[::-1]), np.concatenate(highs[::-1]), order, leaf_size)
