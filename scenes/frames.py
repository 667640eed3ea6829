"""Orientation in space: rotations given by three angles, and frames about a direction."""

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["Frame", "frame_about", "rotation_matrix"]

Frame = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""Three unit vectors (u, v, n), right-handed: u × v = n."""

_NEARLY_PARALLEL = 0.999
_PARALLEL_SINE = 1e-6

_X, _Y, _Z = np.eye(3)


def rotation_matrix(rotation_deg: tuple[float, float, float]) -> NDArray[np.float64]:
    """The turn by three angles about the fixed axes x, then y, then z: R = Rz Ry Rx.

    Quarter turns are exact. Reference: Goldstein, Poole & Safko 2002, Classical Mechanics, §4.4,
    for the elementary rotations (right-handed, counter-clockwise seen against the axis).

    Args:
        rotation_deg: (rx, ry, rz) [degrees].

    Returns:
        (3, 3); its columns are the local axes in the world, so `matrix @ local` is in the world.
    """
    matrix = np.eye(3)
    for axis, angle_deg in enumerate(rotation_deg):
        cosine, sine = _cosine_and_sine(angle_deg)
        turn = np.eye(3)
        j, k = (axis + 1) % 3, (axis + 2) % 3
        turn[j, j], turn[j, k], turn[k, j], turn[k, k] = cosine, -sine, sine, cosine
        matrix = turn @ matrix
    return matrix


def _cosine_and_sine(angle_deg: float) -> tuple[float, float]:
    quarters, rest_deg = divmod(math.fmod(angle_deg, 360.0) + 45.0, 90.0)
    angle = math.radians(rest_deg - 45.0)
    cosine, sine = math.cos(angle), math.sin(angle)
    turned = ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))
    return turned[int(quarters) % 4]


def frame_about(
    normal: tuple[float, float, float], up: tuple[float, float, float] | None = None
) -> Frame | None:
    """A right-handed frame whose third axis is `normal`.

    Args:
        normal: Unit vector.
        up: Unit vector that the second axis comes as close to as it can. None takes the world's
            +y, or -z (away from someone who looks along -z) where the normal is within 2.6° of
            the y axis.

    Returns:
        (u, v, n): unit vectors (3,) with u × v = n; None if `up` is parallel to `normal`.
    """
    n = np.asarray(normal, dtype=np.float64)
    if up is None:
        wanted = -_Z if abs(n[1]) > _NEARLY_PARALLEL else _Y
    else:
        wanted = np.asarray(up, dtype=np.float64)
    u = np.cross(wanted, n)
    sine = float(np.linalg.norm(u))
    if sine < _PARALLEL_SINE:
        return None
    u /= sine
    return u, np.cross(n, u), n
