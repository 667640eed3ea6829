"""Which triangles of two surfaces come near one another: two trees of boxes, walked together.

Reference:
    Ericson (2005), *Real-Time Collision Detection*, §6.3.2: simultaneous descent of two trees.
"""

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["box_pairs"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_Level = tuple[FloatArray, FloatArray]
"""Lowest and highest corners of a level's boxes, (2^level, 3) each."""


def box_pairs(one: FloatArray, other: FloatArray, most: int) -> tuple[IntArray, IntArray]:
    """Pairs of triangles whose boxes, parallel to the axes, have a point in common.

    Args:
        one: (m, 3, 3) corners.
        other: (n, 3, 3) corners.
        most: how many pairs are followed at most; of more, an even share is.

    Returns:
        Rows of `one` and rows of `other`, both (k,).
    """
    orders, trees = zip(*(_tree(corners) for corners in (one, other)), strict=True)
    rows = [np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)]
    for level in range(max(len(tree) for tree in trees)):
        if level > 0:
            for side, tree in enumerate(trees):
                if level < len(tree):
                    rows[1 - side] = np.repeat(rows[1 - side], 2)
                    rows[side] = (2 * rows[side][:, None] + np.array([0, 1])).ravel()
        (low, high), (other_low, other_high) = (
            tree[min(level, len(tree) - 1)] for tree in trees
        )
        i, j = rows
        meet = np.all((low[i] <= other_high[j]) & (other_low[j] <= high[i]), axis=1)
        rows = [i[meet], j[meet]]
        if len(rows[0]) > most:
            kept = np.linspace(0, len(rows[0]) - 1, most).astype(np.int64)
            rows = [row[kept] for row in rows]
    return orders[0][rows[0]], orders[1][rows[1]]


def _tree(corners: FloatArray) -> tuple[IntArray, list[_Level]]:
    """Triangles in the order of a complete tree's leaves (−1: none there), and boxes by level."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    middle = 0.5 * (low + high)
    levels = math.ceil(math.log2(len(corners))) if len(corners) > 1 else 0
    order = np.full(1 << levels, -1, dtype=np.int64)
    order[: len(corners)] = np.arange(len(corners))
    for level in range(levels):  # halve every part across its longest side
        parts = order.reshape(1 << level, -1)
        there = parts >= 0
        places = np.where(there[:, :, None], middle[parts], np.nan)
        span = np.where(there[:, :, None], places, -np.inf).max(axis=1)
        span = span - np.where(there[:, :, None], places, np.inf).min(axis=1)
        axis = np.argmax(np.where(np.isfinite(span), span, -1.0), axis=1)
        keys = np.take_along_axis(places, axis[:, None, None], axis=2)[:, :, 0]
        order = np.take_along_axis(parts, np.argsort(keys, axis=1), axis=1).ravel()
    there = (order >= 0)[:, None]
    boxes = [(np.where(there, low[order], np.inf), np.where(there, high[order], -np.inf))]
    for _ in range(levels):
        low, high = boxes[0]
        boxes.insert(0, (np.minimum(low[::2], low[1::2]), np.maximum(high[::2], high[1::2])))
    return order, boxes
