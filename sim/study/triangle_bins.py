"""Flux of many triangles, clipped exactly onto a regular grid of bins.

For a polygon with counter-clockwise boundary and a bin [i, i + 1] × [j, j + 1], Green's theorem on
the slice of the polygon at each height y gives the common area as a sum over the edges,

    A = Σ_edges ∫ clamp(x(y) − i, 0, 1) dy,   j ≤ y ≤ j + 1,

whose integrand is piecewise linear along an edge: no polygon is ever cut up.
"""

import functools
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

__all__ = ["bin_triangles"]

FloatArray = npt.NDArray[np.float64]

FLATTEST = 1e-10
"""A triangle thinner than this share of its length is a line, of which the middle is binned."""


@wp.func
def mean_of_clamped(xa: wp.float64, xb: wp.float64):
    """Mean of clamp(x, 0, 1) as x goes evenly from xa to xb."""
    zero, one = wp.float64(0.0), wp.float64(1.0)
    low = wp.min(xa, xb)
    high = wp.max(xa, xb)
    if high <= zero:
        return zero
    if low >= one:
        return one
    if high == low:
        return low
    a = wp.max(low, zero)
    b = wp.min(high, one)
    return (wp.float64(0.5) * (a + b) * (b - a) + (high - b)) / (high - low)


@wp.func
def area_of_edge(p: wp.vec2d, q: wp.vec2d, column: wp.float64, row: wp.float64):
    """∫ clamp(x − column, 0, 1) dy over the part of the edge from p to q inside the row."""
    top = row + wp.float64(1.0)
    ya = wp.clamp(p[1], row, top)
    yb = wp.clamp(q[1], row, top)
    if ya == yb:
        return wp.float64(0.0)
    run = q[0] - p[0]
    rise = q[1] - p[1]
    xa = p[0] + (ya - p[1]) / rise * run - column
    xb = p[0] + (yb - p[1]) / rise * run - column
    return (yb - ya) * mean_of_clamped(xa, xb)


@wp.func
def area_in_bin(p: wp.vec2d, q: wp.vec2d, r: wp.vec2d, column: int, row: int):
    """Signed area that a triangle and a bin have in common."""
    x = wp.float64(column)
    y = wp.float64(row)
    return area_of_edge(p, q, x, y) + area_of_edge(q, r, x, y) + area_of_edge(r, p, x, y)


@functools.cache
def make_bin_triangles() -> Any:
    """Kernel that adds each triangle's flux to the bins, in the order of the triangles."""

    @wp.kernel(module="unique", enable_backward=False)
    def add_triangles(
        corners: wp.array2d(dtype=wp.vec2d),
        flux: wp.array(dtype=wp.float64),
        layers: wp.array(dtype=int),
        out_bins: wp.array3d(dtype=wp.float64),
    ):
        i = wp.tid()
        p = corners[i, 0]
        q = corners[i, 1]
        r = corners[i, 2]
        low = wp.min(wp.min(p, q), r)
        high = wp.max(wp.max(p, q), r)
        extent = wp.max(high[0] - low[0], high[1] - low[1])
        area = wp.float64(0.5) * (
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        )
        flat = wp.abs(area) <= wp.float64(FLATTEST) * extent * wp.max(extent, wp.float64(1.0))
        if flat:
            low = (p + q + r) / wp.float64(3.0)
            high = low
        # Compared before they are made whole numbers: far outside, those would overflow.
        columns = wp.float64(out_bins.shape[2])
        rows = wp.float64(out_bins.shape[1])
        meets = low[0] < columns and low[1] < rows
        meets = meets and high[0] >= wp.float64(0.0) and high[1] >= wp.float64(0.0)
        if meets:
            first = int(wp.max(wp.floor(low[0]), wp.float64(0.0)))
            last = int(wp.min(wp.floor(high[0]), columns - wp.float64(1.0)))
            row = int(wp.max(wp.floor(low[1]), wp.float64(0.0)))
            last_row = int(wp.min(wp.floor(high[1]), rows - wp.float64(1.0)))
            alone = wp.floor(low[0]) == wp.floor(high[0]) and wp.floor(low[1]) == wp.floor(high[1])
            while row <= last_row:
                column = int(first)
                while column <= last:
                    share = wp.float64(1.0)
                    if not alone:
                        share = wp.max(area_in_bin(p, q, r, column, row) / area, wp.float64(0.0))
                    wp.atomic_add(out_bins, layers[i], row, column, flux[i] * share)
                    column += 1
                row += 1

    return add_triangles


def bin_triangles(
    corners: FloatArray,
    flux: FloatArray,
    layers: npt.NDArray[np.integer[Any]],
    shape: tuple[int, int, int],
    *,
    device: str = "cpu",
) -> FloatArray:
    """Spread each triangle's flux evenly over its area, and sum it up in bins.

    Args:
        corners: (n, 3, 2) corners in units of bins: bin [j, i] covers i ≤ x < i + 1 and
            j ≤ y < j + 1. All finite.
        flux: (n,), any unit.
        layers: (n,) which layer of bins each goes to.
        shape: (layers, rows, columns) of the bins; rows are along y.
        device: where to compute.

    Returns:
        (layers, rows, columns), in the unit of `flux`. What lies outside of the grid is left out.
    """
    bins = wp.zeros(shape, dtype=wp.float64, device=device)
    if len(flux):
        wp.launch(
            make_bin_triangles(),
            dim=len(flux),
            inputs=[
                wp.array(np.ascontiguousarray(corners), dtype=wp.vec2d, device=device),
                wp.array(np.ascontiguousarray(flux), dtype=wp.float64, device=device),
                wp.array(layers.astype(np.int32), dtype=int, device=device),
            ],
            outputs=[bins],
            device=device,
        )
    summed: FloatArray = bins.numpy()
    return summed
