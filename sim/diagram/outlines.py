"""The outlines of shapes and lamps, as curves in space that a diagram projects."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenes.emitters import Beam, Emitter, RectangleLamp, RoundProfile, SlitProfile, SphereLamp
from scenes.frames import frame_about
from scenes.shapes import (
    ConvexSolid,
    Disk,
    FlatRectangle,
    Lens,
    LensSurface,
    Sphere,
    Triangulated,
)
from scenes.shapes import Shape as AnyShape

__all__ = ["Curve", "emitter_outline", "shape_outline"]

Curve = NDArray[np.float64]
"""Points of a closed polyline, shape (n, 3) [m]."""

_CIRCLE_POINTS = 96
_PROFILE_POINTS = 65


def shape_outline(shape: AnyShape, toward_viewer: NDArray[np.float64]) -> Curve | None:
    """The outline of a shape as seen from one side.

    Args:
        shape: What to outline.
        toward_viewer: Unit vector (3,) toward who looks.

    Returns:
        The silhouette; of a lens, the section through its axis that faces the viewer, and of a
        mesh or a height field its hull's. None for an infinite plane.
    """
    match shape:
        case Sphere():
            return _circle(shape.position, toward_viewer, shape.radius)
        case Disk():
            return _circle(shape.position, shape.normal, shape.radius)
        case FlatRectangle():
            return _rectangle(shape.position, shape.frame()[:2], shape.size)
        case Lens():
            return _lens_section(shape, toward_viewer)
        case ConvexSolid() | Triangulated():
            return _silhouette(shape.vertices_world(), toward_viewer)
        case _:
            return None


def emitter_outline(emitter: Emitter, toward_viewer: NDArray[np.float64]) -> Curve | None:
    """The outline of a lamp or of a beam's profile; None for a lamp that is a point."""
    match emitter:
        case SphereLamp():
            return _circle(emitter.position, toward_viewer, emitter.radius)
        case RectangleLamp():
            return _rectangle(emitter.position, emitter.frame()[:2], emitter.size)
        case Beam(profile=RoundProfile(radius=radius)):
            return _circle(emitter.position, emitter.direction, radius)
        case Beam(profile=SlitProfile(width=width, height=height)):
            return _rectangle(emitter.position, emitter.frame()[:2], (width, height))
        case _:
            return None


def _across(normal: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors perpendicular to `normal` and to each other."""
    x, y, z = np.asarray(normal, dtype=np.float64).tolist()
    frame = frame_about((x, y, z))
    assert frame is not None  # Only an `up` of one's own can be parallel to the normal.
    return frame[0], frame[1]


def _circle(centre: ArrayLike, normal: ArrayLike, radius: float) -> Curve:
    angle = np.linspace(0.0, 2.0 * np.pi, _CIRCLE_POINTS, endpoint=False)
    u, v = _across(normal)
    offsets = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v
    return np.asarray(centre) + radius * offsets


def _rectangle(
    centre: ArrayLike,
    edges: tuple[NDArray[np.float64], NDArray[np.float64]],
    size: tuple[float, float],
) -> Curve:
    corners = 0.5 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size
    return np.asarray(centre) + corners @ np.stack(edges)


def _silhouette(vertices: NDArray[np.float64], toward_viewer: NDArray[np.float64]) -> Curve:
    """The vertices on the convex hull of what is seen, in order around it.

    Of a flat sheet seen from its edge, the two ends.
    """
    from scipy.spatial import ConvexHull, QhullError

    seen = vertices @ np.stack(_across(toward_viewer), axis=-1)
    try:
        around: NDArray[np.intp] = ConvexHull(seen).vertices
    except QhullError:
        along = seen @ (seen[np.argmax(np.linalg.norm(seen - seen[0], axis=1))] - seen[0])
        around = np.array([np.argmin(along), np.argmax(along)])
    return vertices[around]


def _lens_section(lens: Lens, toward_viewer: NDArray[np.float64]) -> Curve:
    """Both surfaces' profiles in the plane of the axis that faces the viewer, rim to rim.

    A lens seen along its axis is a circle.
    """
    axis = np.array(lens.axis)
    across = np.cross(axis, toward_viewer)
    length = np.linalg.norm(across)
    if length < 1e-6:
        return _circle(lens.position, axis, 0.5 * lens.aperture)
    rho = np.linspace(-0.5, 0.5, _PROFILE_POINTS) * lens.aperture
    first, second = lens.vertices()
    there = first + _profile(lens.first, rho, axis, across / length)
    back = second + _profile(lens.second, rho[::-1], axis, across / length)
    return np.concatenate([there, back])


def _profile(
    surface: LensSurface, rho: NDArray[np.float64], axis: Curve, across: Curve
) -> NDArray[np.float64]:
    sag = np.array([surface.sag(abs(r)) for r in rho.tolist()])
    return rho[:, None] * across + sag[:, None] * axis
