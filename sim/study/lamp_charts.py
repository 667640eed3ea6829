"""The charts of a lamp: all its rays that can meet the sphere around an object.

A lamp with an extent is a sum over its points, and a beam with a divergence over its directions;
each has a chart of its own. A glowing sphere sends the same light along every line through it, so
it is a sum over the lines' offsets from its centre, evenly over a disk.
"""

import math
from collections.abc import Sequence
from typing import TypeGuard

import numpy as np
import numpy.typing as npt

import scenes
from scenes.emitters import AnyEmitter, AnyLocalEmitter, LocalEmitter, has_mask
from sim.errors import SettingsError
from sim.scene_data import axis_frame
from sim.study.beam_charts import make_beam_charts
from sim.study.quadrature import disk_nodes, unit_nodes
from sim.study.ray_charts import Chart, ConeChart, Emission, RimChart

__all__ = ["has_charts", "has_extent", "make_charts"]

FloatArray = npt.NDArray[np.float64]

RIM = 1.0 - 1e-9
"""Share of a bounding sphere's radius that charts span: a ray along a sphere's very rim would hit
it or miss it by rounding. Hardly any light enters there."""


def has_charts(emitter: AnyEmitter) -> TypeGuard[AnyLocalEmitter]:
    """Whether the lamp's rays can be charted: it is somewhere in the scene, and has no mask."""
    return isinstance(emitter, LocalEmitter) and not has_mask(emitter)


def has_extent(emitter: AnyEmitter) -> bool:
    """Whether the lamp is a sum over points or directions."""
    if isinstance(emitter, scenes.Beam):
        return emitter.divergence_deg > 0.0
    return isinstance(emitter, scenes.SphereLamp | scenes.RectangleLamp)


def make_charts(
    emitter: AnyLocalEmitter, centre: FloatArray, radius: float, points: int
) -> Sequence[Chart]:
    """Charts of the lamp's rays that can meet a sphere.

    Args:
        emitter: one of a scene's emitters, one that has charts.
        centre: (3,) of the sphere [m].
        radius: of the sphere [m].
        points: nodes along each direction of the lamp's extent, or along the radius.

    Raises:
        SettingsError: a glowing sphere overlaps the sphere.
    """
    rim = RIM * radius
    if isinstance(emitter, scenes.Beam):
        return make_beam_charts(emitter, centre, rim, points)
    position = np.asarray(emitter.position, dtype=np.float64)
    if isinstance(emitter, scenes.SphereLamp):
        return _sphere_charts(emitter, position, (centre, rim), points)
    if isinstance(emitter, scenes.RectangleLamp):
        emission = Emission(emitter.frame()[2], 0.0, True)
        return [
            _point_chart(point, (centre, rim), weight, emission)
            for point, weight in _rectangle_points(emitter, points)
        ]
    if isinstance(emitter, scenes.Spot):
        return [_spot_chart(emitter, position, (centre, rim))]
    return [_point_chart(position, (centre, rim), 1.0, Emission(np.zeros(3)))]


def _point_chart(
    origin: FloatArray, sphere: tuple[FloatArray, float], share: float, emission: Emission
) -> Chart:
    """All rays of a point that can meet the sphere (centre, radius).

    `share` is the lamp's flux at intensity 1 into all directions.
    """
    centre, radius = sphere
    distance = float(np.linalg.norm(centre - origin))
    if distance <= radius:
        return ConeChart(share, origin, np.eye(3), math.pi, emission)
    frame, size = _frame_along(centre - origin), radius / distance
    flux = share * 0.25 * size**2
    return RimChart(flux, origin, frame, np.zeros(2), np.zeros(2), size, emission)


def _spot_chart(
    emitter: scenes.Spot, origin: FloatArray, sphere: tuple[FloatArray, float]
) -> Chart:
    """The spot's own cone if all of it meets the sphere, else what of it can."""
    axis = np.asarray(emitter.direction, dtype=np.float64)
    half_angle = math.radians(emitter.half_angle_deg)
    share = 1.0 / math.sin(0.5 * half_angle) ** 2
    offset = sphere[0] - origin
    apart = math.atan2(float(np.linalg.norm(np.cross(axis, offset))), float(axis @ offset))
    distance = float(np.linalg.norm(offset))
    around = math.pi if distance <= sphere[1] else math.asin(sphere[1] / distance)
    if apart + half_angle <= around:
        return ConeChart(1.0, origin, _frame_along(axis), half_angle, Emission(axis))
    least_cosine = -2.0 if apart + around <= half_angle else math.cos(half_angle)
    return _point_chart(origin, sphere, share, Emission(axis, least_cosine))


def _sphere_charts(
    emitter: scenes.SphereLamp,
    origin: FloatArray,
    sphere: tuple[FloatArray, float],
    points: int,
) -> Sequence[Chart]:
    """A chart for each offset of the lines through a glowing sphere."""
    centre, radius = sphere
    distance = float(np.linalg.norm(centre - origin))
    if distance <= radius + emitter.radius:
        allowed = "an object whose bounding sphere does not overlap the lamp"
        raise SettingsError("target", f"around {tuple(centre)}", allowed)
    frame, size = _frame_along(centre - origin), radius / distance
    charts = []
    for square, angle, weight in disk_nodes(points):
        offset = emitter.radius * math.sqrt(square) * np.array([math.cos(angle), math.sin(angle)])
        charts.append(
            RimChart(
                weight * 0.25 * size**2, origin, frame, offset, -offset / distance, size,
                Emission(frame[2]),
            )
        )
    return charts


def _frame_along(axis: FloatArray) -> FloatArray:
    """(3, 3) frame whose third row is along `axis`."""
    x, y, z = (float(one) for one in axis / np.linalg.norm(axis))
    return axis_frame((x, y, z))


def _rectangle_points(
    emitter: scenes.RectangleLamp, points: int
) -> list[tuple[FloatArray, float]]:
    """Points (3,) of a rectangle [m], and their weights."""
    nodes, weights = unit_nodes(points)
    u, v, _ = emitter.frame()
    width, height = emitter.size
    return [
        (emitter.position + (s - 0.5) * width * u + (t - 0.5) * height * v, float(ws * wt))
        for s, ws in zip(nodes, weights, strict=True)
        for t, wt in zip(nodes, weights, strict=True)
    ]
