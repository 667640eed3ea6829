"""How far shapes reach, held against their own points."""

import math

import numpy as np
import pytest

from scenes import Box, Disk, Lens, LensSurface, Plane, Prism, Rectangle, Sphere
from scenes.shapes.reach import close_pairs, may_meet, reach

RANDOM = np.random.default_rng(11)
WAYS = RANDOM.normal(size=(50, 3))
WAYS /= np.linalg.norm(WAYS, axis=1)[:, None]
AXIS = (2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0)
MENISCUS = Lens(
    position=(0.1, 0.2, 0.3), axis=AXIS, thickness=0.3, aperture=1.2,
    first=LensSurface(radius=1.0), second=LensSurface(radius=1.5),
)  # fmt: skip


def box_points(shape):
    return shape.vertices_world()


def rectangle_points(shape):
    u, v, _ = shape.frame()
    half_u, half_v = 0.5 * shape.size[0], 0.5 * shape.size[1]
    return np.array([
        np.array(shape.position) + a * half_u * u + b * half_v * v
        for a in (-1, 1) for b in (-1, 1)
    ])  # fmt: skip


def disk_points(shape):
    normal = np.array(shape.normal)
    u = np.cross(normal, [0.3, 0.5, -0.8])
    u /= np.linalg.norm(u)
    phi = np.linspace(0.0, 2.0 * math.pi, 100_001)[:, None]
    ring = np.cos(phi) * u + np.sin(phi) * np.cross(normal, u)
    return np.array(shape.position) + shape.radius * ring


def lens_points(shape):
    """Of both caps, by their sags: never beyond the reach of the cylinder around them."""
    axis = np.array(shape.axis)
    u = np.cross(axis, [0.3, 0.5, -0.8])
    u /= np.linalg.norm(u)
    v = np.cross(axis, u)
    points = []
    for rho in np.linspace(0.0, 0.5 * shape.aperture, 20):
        for phi in np.linspace(0.0, 2.0 * math.pi, 60):
            side = rho * (math.cos(phi) * u + math.sin(phi) * v)
            for half, cap in ((-0.5, shape.first), (0.5, shape.second)):
                along = half * shape.thickness + cap.sag(rho)
                points.append(np.array(shape.position) + side + along * axis)
    return np.array(points)


@pytest.mark.parametrize(
    ("shape", "points", "slack"),
    [
        (Box(position=(1, 2, 3), size=(1, 2, 0.5), rotation_deg=(10, 20, 30)), box_points, 0.0),
        (Prism(position=(1, 2, 3), apex_deg=50, base=1, length=2), box_points, 0.0),
        (Rectangle(position=(1, 2, 3), size=(1, 2), normal=AXIS), rectangle_points, 0.0),
        # A polygon of 100,000 corners is short of the circle by r (π/100,000)²/2 = 5e-10 r.
        (Disk(position=(1, 2, 3), radius=0.7, normal=AXIS), disk_points, 5e-10),
        # The cylinder around a meniscus is larger than it: by its sags, here 0.2 at most.
        (MENISCUS, lens_points, 0.25),
    ],
    ids=lambda value: type(value).__name__,
)
def test_no_point_is_beyond_the_reach_and_one_is_at_it(shape, points, slack):
    corners = points(shape)
    for way in WAYS:
        furthest = float(np.max(corners @ way))
        assert furthest - 1e-14 <= reach(shape, way) <= furthest + slack + 1e-14


def test_a_sphere_and_a_plane_reach_as_far_as_they_do():
    sphere = Sphere(position=(1, 2, 3), radius=0.5)
    plane = Plane(position=(1, 2, 3), normal=AXIS)
    for way in WAYS:
        assert reach(sphere, way) == pytest.approx(float(np.dot((1, 2, 3), way)) + 0.5, abs=1e-14)
        assert reach(plane, way) == math.inf
    height = float(np.dot(AXIS, (1, 2, 3)))
    assert reach(plane, np.array(AXIS)) == pytest.approx(height, abs=1e-14)
    assert reach(plane, -np.array(AXIS)) == pytest.approx(-height, abs=1e-14)


UNIT = Box(position=(0, 0, 0), size=(1, 1, 1))


@pytest.mark.parametrize(
    ("other", "gap"),
    [
        (Box(position=(1.2, 0.3, 0), size=(1, 1, 1)), 0.2),
        (Sphere(position=(0, 2, 0), radius=1.2), 0.3),
        (Plane(position=(0, -0.6, 0), normal=(0, 1, 0)), 0.1),
        (Disk(position=(0, 0.75, 0), normal=(0, 1, 0), radius=5.0), 0.25),
        (Rectangle(position=(0, 0, 0.54), size=(0.1, 0.1), normal=(0, 0, 1)), 0.04),
        # Corner to the middle of a face: (√3 − 1)/2 above it.
        (Plane(position=(1.0, 1.0, 1.0), normal=(1, 1, 1)), math.sqrt(3.0) / 2.0),
        (Lens(position=(0, 0, 0.9), axis=(0, 0, 1), thickness=0.6, aperture=0.4,
              first=LensSurface(radius=0.5), second=LensSurface(curvature=0.0)), 0.1),
    ],
    ids=lambda value: type(value).__name__,
)  # fmt: skip
def test_shapes_meet_where_slack_bridges_the_gap_between_them(other, gap):
    for pair in ((UNIT, other), (other, UNIT)):
        assert not may_meet(*pair)
        assert not may_meet(*pair, 0.99 * gap)
        assert may_meet(*pair, 1.01 * gap)


@pytest.mark.parametrize(
    "other",
    [
        Box(position=(1.0, 0.0, 0.0), size=(1, 1, 1)),  # flush
        Box(position=(0.0, 0.0, 0.0), size=(0.2, 0.2, 0.2)),  # nested
        Plane(position=(0.0, 0.3, 0.0), normal=AXIS),
        Sphere(position=(0.0, 0.0, 0.0), radius=10.0),
    ],
)
def test_what_touches_or_nests_meets(other):
    assert may_meet(UNIT, other, 1e-12)
    assert may_meet(other, UNIT, 1e-12)


def test_close_pairs_are_those_of_nearby_bounding_spheres():
    shapes = [
        *(Sphere(position=p, radius=0.1) for p in RANDOM.uniform(-1, 1, (40, 3)).tolist()),
        Plane(position=(0, -50, 0), normal=(0, 1, 0)),
        UNIT,
    ]
    expected = []
    for i, one in enumerate(shapes):
        for j in range(i + 1, len(shapes)):
            if isinstance(one, Plane) or isinstance(shapes[j], Plane):
                expected.append((i, j))
                continue
            (here, r), (there, s) = one.bounding_sphere(), shapes[j].bounding_sphere()
            if np.linalg.norm(np.subtract(here, there)) - r - s <= 0.05:
                expected.append((i, j))
    assert list(close_pairs(shapes, 0.05)) == expected
    assert 41 < len(expected) < 41 * 42 / 2
    assert list(close_pairs([])) == []
