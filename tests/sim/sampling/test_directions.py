"""Points on disks and directions in cones: where they lie, and how densely."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.precision import precision_types
from sim.sampling.directions import (
    cone_solid_angle,
    cone_square,
    disk_square,
    from_world,
    sample_cone,
    sample_cosine_hemisphere,
    sample_disk,
    sample_sphere,
    to_world,
)

GRID = 400
"""Midpoints of GRID² cells stand for all of [0, 1)²: means of smooth maps are good to 1/GRID²."""


@functools.cache
def make_probes(precision):
    """One module a precision, so that it is compiled once."""
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3
    options = {"module": f"tests_directions_{precision}", "enable_backward": False}

    @wp.kernel(**options)
    def draw(
        u: wp.array2d(dtype=real),
        sin2_half: real,
        out_disk: wp.array(dtype=vec3),
        out_cone: wp.array(dtype=vec3),
        out_hemisphere: wp.array(dtype=vec3),
        out_sphere: wp.array(dtype=vec3),
    ):
        i = wp.tid()
        u0 = u[i, 0]
        u1 = u[i, 1]
        x, y = sample_disk(u0, u1)
        out_disk[i] = vec3(x, y, real(0.0))
        x1, y1, z1 = sample_cone(u0, u1, sin2_half)
        out_cone[i] = vec3(x1, y1, z1)
        x2, y2, z2 = sample_cosine_hemisphere(u0, u1)
        out_hemisphere[i] = vec3(x2, y2, z2)
        x3, y3, z3 = sample_sphere(u0, u1)
        out_sphere[i] = vec3(x3, y3, z3)

    @wp.kernel(**options)
    def turn(
        local: wp.array(dtype=vec3),
        axes: wp.array(dtype=vec3),
        out_world: wp.array(dtype=vec3),
        out_solid_angle: wp.array(dtype=real),
    ):
        i = wp.tid()
        v = local[i]
        out_world[i] = to_world(v[0], v[1], v[2], axes[i])
        out_solid_angle[i] = cone_solid_angle(v[0] * v[0])

    @wp.kernel(**options)
    def invert(
        u: wp.array2d(dtype=real), sin2_half: real, axis: vec3, out: wp.array2d(dtype=real)
    ):
        i = wp.tid()
        x, y = sample_disk(u[i, 0], u[i, 1])
        s, t = disk_square(x, y)
        out[i, 0] = s
        out[i, 1] = t
        x1, y1, z1 = sample_cone(u[i, 0], u[i, 1], sin2_half)
        x2, y2, z2 = from_world(to_world(x1, y1, z1, axis), axis)
        s1, t1 = cone_square(x2, y2, z2, sin2_half)
        out[i, 2] = s1
        out[i, 3] = t1

    return SimpleNamespace(draw=draw, turn=turn, invert=invert, types=types)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def drawn(precision, u, half_angle=0.5):
    """Points of a disk and directions of the three solids for (n, 2) numbers u, as float64."""
    probes = make_probes(precision)
    outs = [wp.zeros(len(u), dtype=probes.types.vec3, device="cpu") for _ in range(4)]
    inputs = [wp.array(u, dtype=probes.types.real, device="cpu"), np.sin(0.5 * half_angle) ** 2]
    wp.launch(probes.draw, dim=len(u), inputs=inputs, outputs=outs, device="cpu")
    disk, cone, hemisphere, sphere = (out.numpy().astype(np.float64) for out in outs)
    return SimpleNamespace(disk=disk, cone=cone, hemisphere=hemisphere, sphere=sphere)


def turned(precision, local, axes):
    probes = make_probes(precision)
    inputs = [wp.array(a, dtype=probes.types.vec3, device="cpu") for a in (local, axes)]
    world = wp.zeros(len(local), dtype=probes.types.vec3, device="cpu")
    solid_angle = wp.zeros(len(local), dtype=probes.types.real, device="cpu")
    wp.launch(
        probes.turn, dim=len(local), inputs=inputs, outputs=[world, solid_angle], device="cpu"
    )
    return world.numpy().astype(np.float64), solid_angle.numpy()


def eps(precision):
    return float(np.finfo(precision).eps)


@pytest.fixture
def grid():
    axis = (np.arange(GRID) + 0.5) / GRID
    return np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)


def corners_and_edges():
    """The ends of [0, 1)², its middle, and their neighbours; 1 - 2⁻²⁴ is float32's last."""
    ends = [0.0, 2.0**-24, 0.25, 0.5 - 2.0**-24, 0.5, 0.5 + 2.0**-24, 0.75, 1.0 - 2.0**-24]
    return np.array([(a, b) for a in ends for b in ends])


def assert_moments(values, expected, *, sigma=1.0):
    """Means over the grid's cells, whose midpoint rule is of second order."""
    np.testing.assert_allclose(values.mean(axis=0), expected, rtol=0, atol=20.0 * sigma / GRID**2)


def test_disk_points_lie_in_the_disk(precision, grid):
    for u in (grid, corners_and_edges()):
        r = np.linalg.norm(drawn(precision, u).disk, axis=1)
        assert r.max() <= 1.0 + 2.0 * eps(precision)


def test_disk_points_are_uniform(precision, grid):
    disk = drawn(precision, grid).disk
    assert_moments(disk[:, :2], [0.0, 0.0])
    assert_moments(disk[:, :2] ** 2, [0.25, 0.25])  # ∫ x² / π = 1/4
    assert_moments(disk[:, 0] * disk[:, 1], 0.0)
    # Equal rings hold equally many: a ring of the square goes to a ring of the disk.
    rings = np.histogram(np.sum(disk**2, axis=1), bins=(np.arange(11) / 10) ** 2)[0]
    expected = np.diff((np.arange(11) / 10) ** 2) * GRID**2
    np.testing.assert_allclose(rings, expected, rtol=0.02)


def test_the_disk_map_is_continuous(precision):
    # Shirley & Chiu (1997): a point moves by no more than a constant times its numbers do.
    u = corners_and_edges()
    step = 2.0**-12
    moved = np.clip(u + step * np.array([1.0, -0.5]), 0.0, 1.0 - 2.0**-24)
    distance = np.linalg.norm(drawn(precision, u).disk - drawn(precision, moved).disk, axis=1)
    assert distance.max() < 4.0 * step


@pytest.mark.parametrize("half_angle", [1e-3, 0.5, np.pi / 2, np.pi])
def test_cone_directions_lie_in_the_cone_uniformly(precision, grid, half_angle):
    for u in (grid, corners_and_edges()):
        cone = drawn(precision, u, half_angle).cone
        np.testing.assert_allclose(np.linalg.norm(cone, axis=1), 1.0, atol=4 * eps(precision))
        # Within the cone but for rounding: of the sine where the cone is narrow, of z else.
        sine = np.hypot(cone[:, 0], cone[:, 1])
        if half_angle < 1.5:
            assert sine.max() <= np.sin(half_angle) * (1.0 + 4.0 * eps(precision))
        assert cone[:, 2].min() >= np.cos(half_angle) - 4.0 * eps(precision)
    # Uniform in solid angle is uniform in 1 - cosθ, from 0 to S = 2 sin²(θ_max/2).
    cone, height = drawn(precision, grid, half_angle).cone, 2.0 * np.sin(half_angle / 2) ** 2
    rho2 = np.sum(cone[:, :2] ** 2, axis=1)
    assert_moments(cone[:, :2], [0.0, 0.0], sigma=np.sqrt(height))
    # ⟨sin²θ⟩ = ⟨s (2 - s)⟩ = S - S²/3 for s uniform up to S.
    assert_moments(rho2, height - height**2 / 3.0, sigma=height)
    if half_angle > 0.1:  # z itself has digits left
        assert_moments(cone[:, 2], 1.0 - height / 2.0)


@pytest.mark.parametrize("half_angle", [5e-6, 5e-3])
def test_narrow_cones_keep_their_digits(precision, half_angle):
    # An arc-second is 5e-6 rad; 1 - u (1 - cosθ_max) has no digit of it left in float32.
    u = np.stack([np.linspace(0.5, 1.0, 10_000, endpoint=False), np.full(10_000, 0.5)], axis=1)
    if precision == "float32":
        u = u.astype(np.float32)
    cone = drawn(precision, u, half_angle).cone
    sine = np.hypot(cone[:, 0], cone[:, 1])
    # On this line of the square r = 2 u₀ - 1 and sinθ = √(s (2 - s)), s = 2 r² sin²(θ_max/2).
    s = 2.0 * (2.0 * u[:, 0].astype(np.float64) - 1.0) ** 2 * np.sin(half_angle / 2.0) ** 2
    np.testing.assert_allclose(sine, np.sqrt(s * (2.0 - s)), rtol=6.0 * eps(precision))
    assert len(np.unique(sine)) == len(u)


def test_hemisphere_directions_follow_the_cosine(precision, grid):
    for u in (grid, corners_and_edges()):
        hemisphere = drawn(precision, u).hemisphere
        assert hemisphere[:, 2].min() >= 0.0
        np.testing.assert_allclose(
            np.linalg.norm(hemisphere, axis=1), 1.0, rtol=0, atol=4 * eps(precision)
        )
    hemisphere = drawn(precision, grid).hemisphere
    # Density cosθ/π: ⟨z⟩ = 2/3, ⟨z²⟩ = 1/2, ⟨x²⟩ = ⟨y²⟩ = 1/4. z has a root's end at the rim.
    assert_moments(hemisphere[:, 2], 2.0 / 3.0, sigma=10.0)
    assert_moments(hemisphere**2, [0.25, 0.25, 0.5])


def test_sphere_directions_are_isotropic(precision, grid):
    for u in (grid, corners_and_edges()):
        sphere = drawn(precision, u).sphere
        np.testing.assert_allclose(
            np.linalg.norm(sphere, axis=1), 1.0, rtol=0, atol=4 * eps(precision)
        )
    sphere = drawn(precision, grid).sphere
    assert_moments(sphere, [0.0, 0.0, 0.0])
    assert_moments(sphere**2, [1.0 / 3.0] * 3)


def axes_to_turn_to():
    rng = np.random.default_rng(8)
    axes = rng.normal(size=(300, 3))
    nearly_down = np.array([[1e-4, 0.0, -1.0], [1e-9, 1e-9, -1.0], [0.0, -1e-20, -1.0]])
    flat = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, -0.0], [0.6, 0.8, -1e-12], [0.6, 0.8, 1e-12]])
    axes = np.vstack([axes, np.eye(3), -np.eye(3), nearly_down, flat])
    return axes / np.linalg.norm(axes, axis=1, keepdims=True)


def test_frames_are_right_handed_and_about_their_axis(precision):
    axes = axes_to_turn_to().astype(precision).astype(np.float64)
    rows = [
        turned(precision, np.tile(unit, (len(axes), 1)), axes)[0] for unit in np.eye(3)
    ]  # (3, n, 3): u, v, axis
    frames = np.stack(rows, axis=1)
    np.testing.assert_allclose(frames[:, 2], axes, rtol=0, atol=2 * eps(precision))
    np.testing.assert_allclose(
        frames @ frames.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frames.shape), rtol=0,
        atol=8 * eps(precision),
    )  # fmt: skip
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, rtol=0, atol=16 * eps(precision))


def test_solid_angle_of_a_cone(precision):
    # 2π (1 - cosθ) = 4π sin²(θ/2): the hemisphere, the sphere, and a cone of an arc-second.
    half_angles = np.array([np.pi / 2, np.pi, 5e-6])
    local = np.zeros((3, 3))
    local[:, 0] = np.sin(half_angles / 2.0)
    _, solid_angle = turned(precision, local, np.tile([0.0, 0.0, 1.0], (3, 1)))
    expected = [2.0 * np.pi, 4.0 * np.pi, np.pi * 5e-6**2]
    np.testing.assert_allclose(solid_angle, expected, rtol=4 * eps(precision) + 1e-11)


@pytest.mark.parametrize("half_angle", [1e-6, 0.3, np.pi])
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.6, 0.0, -0.8), (-0.36, 0.48, 0.8)])
def test_squares_are_what_was_drawn_from(precision, half_angle, axis):
    # Midpoints and the edges between the map's four sectors, but for the corners of the disk's
    # square, where the whole sphere's map ends in one point.
    u = (np.indices((41, 41)).reshape(2, -1).T + 0.5) / 41.0
    probes = make_probes(precision)
    real = probes.types.real
    numbers = wp.array(np.ascontiguousarray(u, dtype=precision), dtype=real, device="cpu")
    out = wp.zeros((len(u), 4), dtype=real, device="cpu")
    sin2_half = float(np.sin(0.5 * half_angle) ** 2)
    inputs = [numbers, sin2_half, probes.types.vec3(*axis), out]
    wp.launch(probes.invert, dim=len(u), inputs=inputs, device="cpu")
    found = out.numpy().astype(np.float64)
    # Some ten roundings; in a narrow cone ε of a unit vector is ε/θ of its disk.
    np.testing.assert_allclose(found[:, :2], u, atol=10.0 * eps(precision))
    blur = 10.0 * eps(precision) * (1.0 + 1.0 / half_angle)
    if half_angle == np.pi:
        # Near the far pole ε moves 1 + z by ε, and a point of the disk by ε/√(1 + z).
        blur = 10.0 * np.sqrt(eps(precision))
    if blur < 0.1:
        np.testing.assert_allclose(found[:, 2:], u, atol=blur)
