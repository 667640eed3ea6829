"""Functions given by samples joined with straight lines, and their exact integrals."""

import numpy as np
import numpy.typing as npt

from spectra.arrays import FloatArray
from spectra.errors import SpectraError

__all__ = ["band_edges", "integrate_bands", "interpolate"]


def band_edges(edges_nm: npt.ArrayLike) -> FloatArray:
    """``edges_nm`` [nm] as a float64 array, shape (bands + 1,), checked.

    Raises:
        SpectraError: If there are fewer than 2, or they are not finite and strictly increasing.
    """
    edges = np.asarray(edges_nm, dtype=np.float64)
    increasing = edges.ndim == 1 and edges.size > 1 and np.all(np.diff(edges) > 0.0)
    if not (increasing and np.all(np.isfinite(edges))):
        raise SpectraError(
            f"band edges of shape {edges.shape}; allowed: 2 or more finite, strictly increasing"
        )
    return edges


def interpolate(at: FloatArray, knots: FloatArray, values: FloatArray) -> FloatArray:
    """The piecewise linear function at any points; 0 outside the knots.

    Args:
        at: Points, any shape.
        knots: Strictly increasing, shape (n,).
        values: Values at the knots, shape (n,) or (n, columns).

    Returns:
        Values, shape ``at.shape`` or ``at.shape + (columns,)``.
    """
    columns = values.reshape(len(knots), -1).T
    columnwise = [np.interp(at, knots, column, left=0.0, right=0.0) for column in columns]
    return np.stack(columnwise, axis=-1).reshape(np.shape(at) + values.shape[1:])


def integrate_bands(edges: FloatArray, knots: FloatArray, values: FloatArray) -> FloatArray:
    """Exact integral of the piecewise linear function over each band; 0 outside the knots.

    The trapezoidal rule is exact on every piece once the edges are themselves made knots. Each
    band is summed on its own: differences of one running integral would leave the rounding error
    of the whole in the smallest band.

    Args:
        edges: Band edges, strictly increasing, shape (bands + 1,).
        knots: Strictly increasing, shape (n,).
        values: Values at the knots, shape (n,) or (n, columns).

    Returns:
        Integrals, shape (bands,) or (bands, columns).
    """
    low, high = max(edges[0], knots[0]), min(edges[-1], knots[-1])
    bands = len(edges) - 1
    integrals = np.zeros((bands, *values.shape[1:]), dtype=np.float64)
    if low >= high:
        return integrals
    points = np.union1d(edges, knots)
    points = points[(points >= low) & (points <= high)]
    at_points = interpolate(points, knots, values)
    widths = np.diff(points).reshape((-1,) + (1,) * (values.ndim - 1))
    pieces = 0.5 * widths * (at_points[1:] + at_points[:-1])
    band = np.searchsorted(edges, points[:-1], side="right") - 1
    np.add.at(integrals, band, pieces)
    return integrals
