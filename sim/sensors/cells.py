"""The cells of a sensor and how large they are."""

import numpy as np
import numpy.typing as npt

__all__ = ["cell_areas", "cell_edges"]

FloatArray = npt.NDArray[np.float64]


def cell_edges(half: FloatArray, pixels: tuple[int, int]) -> tuple[FloatArray, FloatArray]:
    """Edges of the columns, left to right, and of the rows, from the top down [m].

    Args:
        half: (2,) half the width and half the height [m].
        pixels: columns and rows.
    """
    columns, rows = pixels
    return np.linspace(-half[0], half[0], columns + 1), np.linspace(half[1], -half[1], rows + 1)


def cell_areas(
    half: FloatArray, pixels: tuple[int, int], *, radius: float | None = None
) -> FloatArray:
    """(rows, columns) area of each cell [m²], of a disk the part that lies in it; exact.

    With A(x, y) the area of the disk left of x and below y, a cell between x₀, x₁ and y₀, y₁ has
    A(x₁, y₁) − A(x₀, y₁) − A(x₁, y₀) + A(x₀, y₀).

    Args:
        half: (2,) half the width and half the height [m].
        pixels: columns and rows.
        radius: of the disk [m]; None: the whole rectangle counts.
    """
    x, y = cell_edges(half, pixels)
    if radius is None:
        areas: FloatArray = np.outer(-np.diff(y), np.diff(x))
        return areas
    below = radius**2 * _area_of_quadrant(x[None, :] / radius, y[:, None] / radius)
    areas = -np.diff(np.diff(below, axis=1), axis=0)
    # What lies outside is a difference of equal areas: rounding must not make a cell of it.
    nearest = [
        np.where(edges[1:] * edges[:-1] < 0.0, 0.0, np.minimum(abs(edges[1:]), abs(edges[:-1])))
        for edges in (x, y)
    ]
    outside = np.hypot(nearest[0][None, :], nearest[1][:, None]) >= radius
    return np.where(outside, 0.0, areas)


def _area_of_quadrant(x: FloatArray, y: FloatArray) -> FloatArray:
    """Area of the unit disk left of x and below y, for x and y in [−1, 1].

    The circle's height over s is √(1 − s²), with the integral F(s) = (s √(1 − s²) + asin s)/2.
    Below y the disk reaches, over s, from −√(1 − s²) to the lesser of y and √(1 − s²), as long as
    that is more than −√(1 − s²): with c = √(1 − y²), inside |s| < c to y, and beyond it to the
    top where y > 0, and not at all where y < 0.
    """
    x, y = np.broadcast_arrays(np.clip(x, -1.0, 1.0), np.clip(y, -1.0, 1.0))
    c = np.sqrt((1.0 - y) * (1.0 + y))
    inner = np.clip(x, -c, c)
    middle = y * (inner + c) + _half_disk(inner) - _half_disk(-c)
    left = _half_disk(np.minimum(x, -c)) - _half_disk(np.full_like(c, -1.0))
    right = _half_disk(np.maximum(x, c)) - _half_disk(c)
    return middle + np.where(y > 0.0, 2.0 * (left + right), 0.0)


def _half_disk(s: FloatArray) -> FloatArray:
    """Integral of the circle's height √(1 − s²) from 0 to s."""
    integral: FloatArray = 0.5 * (s * np.sqrt((1.0 - s) * (1.0 + s)) + np.arcsin(s))
    return integral
