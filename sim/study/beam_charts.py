"""The charts of a beam: for each of its directions, the part of its profile that can meet a sphere.

A beam's rays start evenly over its profile, and fill the cone of its divergence evenly, one
independently of the other.
"""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

import scenes
from sim.study.quadrature import disk_nodes
from sim.study.ray_charts import Chart, ProfileChart

__all__ = ["make_beam_charts"]

FloatArray = npt.NDArray[np.float64]


def make_beam_charts(
    emitter: scenes.Beam, centre: FloatArray, radius: float, points: int
) -> Sequence[Chart]:
    """A chart for each direction of the beam that has light on the sphere.

    Args:
        emitter: the beam.
        centre: (3,) of the sphere [m].
        radius: of the sphere [m].
        points: directions along a radius of the cone, as of `disk_nodes`.
    """
    offset = centre - np.asarray(emitter.position, dtype=np.float64)
    make_chart = (
        _round_chart if isinstance(emitter.profile, scenes.RoundProfile) else _slit_chart
    )
    charts = [
        make_chart(emitter, direction, weight, offset, radius)
        for direction, weight in _directions(emitter, points)
    ]
    return [chart for chart in charts if chart is not None]


def _directions(emitter: scenes.Beam, points: int) -> list[tuple[FloatArray, float]]:
    """Directions (3,) of the beam and their weights."""
    u, v, axis = emitter.frame()
    if emitter.divergence_deg == 0.0:
        return [(axis, 1.0)]
    # They fill the cone evenly in sin²(θ/2), as points fill a disk in r².
    largest = math.sin(0.5 * math.radians(emitter.divergence_deg)) ** 2
    directions = []
    for square, phi, weight in disk_nodes(points):
        half = square * largest
        sine = 2.0 * math.sqrt(half * (1.0 - half))
        way = sine * (math.cos(phi) * u + math.sin(phi) * v) + (1.0 - 2.0 * half) * axis
        directions.append((way, weight))
    return directions


def _round_chart(
    emitter: scenes.Beam, direction: FloatArray, weight: float, offset: FloatArray, radius: float
) -> ProfileChart | None:
    """The sphere's shadow where that is within the disk, else the whole disk."""
    assert isinstance(emitter.profile, scenes.RoundProfile)
    own, frame = emitter.profile.radius, np.stack(emitter.frame())
    middle, slant = _shadow(frame, direction, offset)
    apart, reach = float(np.linalg.norm(middle)), radius / slant
    if apart >= own + reach:
        return None
    if apart + reach < own:
        share = weight * (radius / own) ** 2 / slant
        return _shadow_chart(emitter, direction, share, middle, radius)
    return ProfileChart(
        weight, True, np.asarray(emitter.position), own * frame[:2], direction
    )


def _slit_chart(
    emitter: scenes.Beam, direction: FloatArray, weight: float, offset: FloatArray, radius: float
) -> ProfileChart | None:
    """The sphere's shadow where that is within the slit, else a rectangle around their overlap."""
    assert isinstance(emitter.profile, scenes.SlitProfile)
    frame = np.stack(emitter.frame())
    half = 0.5 * np.array([emitter.profile.width, emitter.profile.height])
    middle, slant = _shadow(frame, direction, offset)
    reach = radius / slant
    low, high = np.maximum(middle - reach, -half), np.minimum(middle + reach, half)
    if np.any(low >= high):
        return None
    if np.all(np.abs(middle) + reach < half):
        share = weight * math.pi * radius**2 / (slant * float(np.prod(2.0 * half)))
        return _shadow_chart(emitter, direction, share, middle, radius)
    share = weight * float(np.prod((high - low) / (2.0 * half)))
    centre = emitter.position + 0.5 * (low + high) @ frame[:2]
    axes = (0.5 * (high - low))[:, None] * frame[:2]
    return ProfileChart(share, False, centre, axes, direction)


def _shadow(
    frame: FloatArray, direction: FloatArray, offset: FloatArray
) -> tuple[FloatArray, float]:
    """Where on the profile (2,) the sphere's centre is seen [m], and the cosine of the slant."""
    slant = float(direction @ frame[2])
    return frame[:2] @ (offset - direction * (float(offset @ frame[2]) / slant)), slant


def _shadow_chart(
    emitter: scenes.Beam, direction: FloatArray, flux: float, middle: FloatArray, radius: float
) -> ProfileChart:
    """The ellipse that a sphere's disk makes on the profile along a slanted direction."""
    frame = np.stack(emitter.frame())
    across = frame[:2] - np.outer(frame[:2] @ direction, direction)
    across[0] /= np.linalg.norm(across[0])
    across[1] = np.cross(direction, across[0])
    slant = float(direction @ frame[2])
    axes = radius * (across - np.outer(across @ frame[2], direction) / slant)
    return ProfileChart(flux, True, emitter.position + middle @ frame[:2], axes, direction)
