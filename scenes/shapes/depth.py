"""How deep points lie inside a solid."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.shapes.convex import ConvexSolid
from scenes.shapes.lens import Lens, LensSurface
from scenes.shapes.sphere import Sphere

__all__ = ["height_above"]

FloatArray = NDArray[np.float64]


def height_above(shape: Any, points: FloatArray) -> FloatArray | None:
    """Height of points above a solid's surface [m], (n,), negative inside.

    It is the distance to the surface wherever a face's own extension is nearest, and never more
    than the distance elsewhere. Its sign is always right.

    Args:
        shape: any shape.
        points: (n, 3) [m].

    Returns:
        None if the shape is no solid that is known here.
    """
    local = points - np.asarray(shape.position)
    if isinstance(shape, Sphere):
        height: FloatArray = np.linalg.norm(local, axis=1) - shape.radius
        return height
    if isinstance(shape, ConvexSolid):
        normals, offsets = shape.faces()
        height = np.max(local @ normals.T - offsets, axis=1)
        return height
    if isinstance(shape, Lens):
        return _above_lens(shape, local)
    return None


def _above_lens(lens: Lens, local: FloatArray) -> FloatArray:
    z = local @ np.asarray(lens.axis)
    rho = np.sqrt(np.maximum(np.sum(local * local, axis=1) - z * z, 0.0))
    rim, half = 0.5 * lens.aperture, 0.5 * lens.thickness
    inside = np.minimum(rho, rim)
    front = (_sags(lens.first, inside) - half - z) * _steepness(lens.first, inside)
    back = (z - half - _sags(lens.second, inside)) * _steepness(lens.second, inside)
    height: FloatArray = np.maximum(np.maximum(front, back), rho - rim)
    return height


def _sags(surface: LensSurface, rho: FloatArray) -> FloatArray:
    root = np.sqrt(np.maximum(1.0 - surface.steepness * rho**2, 0.0))
    sags: FloatArray = surface.curvature * rho**2 / (1.0 + root)
    return sags


def _steepness(surface: LensSurface, rho: FloatArray) -> FloatArray:
    """Cosine of the surface's slope: from heights along the axis to heights above the surface."""
    root2 = np.maximum(1.0 - surface.steepness * rho**2, 0.0)
    slope = surface.curvature * rho
    cosine: FloatArray = np.sqrt(root2 / (root2 + slope**2 + np.finfo(np.float64).tiny))
    return cosine
