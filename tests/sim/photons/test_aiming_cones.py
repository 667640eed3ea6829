"""The cone that a spherical lamp aims at glass with holds every line between the two."""

import numpy as np
import pytest

from sim.photons.aiming import _from_sphere


@pytest.mark.parametrize(("radius", "lamp"), [(0.8, 0.15), (0.1, 0.3), (0.5, 0.5)])
def test_every_line_between_lamp_and_glass_is_in_the_cone(radius, lamp):
    # Lines through random points of both balls, the lamp about 0, the glass about (0, 0, D).
    distance, count = 1.3, 200_000
    rng = np.random.default_rng(7)
    ends = rng.standard_normal((2, count, 3))
    ends /= np.linalg.norm(ends, axis=2, keepdims=True)
    start, end = ends[0] * lamp, ends[1] * radius + [0.0, 0.0, distance]
    direction = end - start
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    reach, pivot = _from_sphere(radius, lamp, distance)
    assert pivot == distance
    # Where each line leaves the sphere of the pivot's radius: |start + t direction| = D, t > 0.
    b = np.sum(start * direction, axis=1)
    t = np.sqrt(b * b + pivot**2 - lamp**2) - b
    crossing = (start + t[:, None] * direction) / pivot
    widest = np.arccos(crossing[:, 2].min())
    # Random lines come near to the widest one, and none is beyond it.
    assert np.arcsin(reach / distance) == pytest.approx(widest, rel=0.02)
    assert np.arcsin(reach / distance) >= widest


def test_a_lamp_that_is_too_near_sends_parallel_lines():
    assert _from_sphere(0.8, 0.15, 0.9) == (0.8 + 0.15, 0.0)
