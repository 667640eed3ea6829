"""Rays and spheres, against the quadratic in extended precision."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.geometry.sphere import intersect_sphere
from sim.precision import precision_types

WIDE = np.longdouble


@functools.cache
def make_probes(precision):
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3

    @wp.kernel(module=f"tests_sphere_{precision}", enable_backward=False)
    def probe(
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        radius: real,
        leaving: bool,
        out_t: wp.array(dtype=real),
    ):
        i = wp.tid()
        out_t[i] = intersect_sphere(origins[i], directions[i], radius, leaving)

    return SimpleNamespace(probe=probe, types=types)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def intersected(precision, origins, directions, radius=1.0, *, leaving=False):
    """Distances (n,), −1 for none, as float64."""
    probes = make_probes(precision)
    inputs = [wp.array(a, dtype=probes.types.vec3, device="cpu") for a in (origins, directions)]
    out = wp.zeros(len(origins), dtype=probes.types.real, device="cpu")
    wp.launch(
        probes.probe, dim=len(origins), inputs=[*inputs, radius, leaving], outputs=[out],
        device="cpu",
    )  # fmt: skip
    return out.numpy().astype(np.float64)


def rounded(precision, vectors):
    """The vectors as the device sees them, in extended precision."""
    return vectors.astype(precision).astype(WIDE)


def roots(o, d, radius):
    """Both roots of |o + t d| = radius, and the distance of closest approach; NaN for none."""
    a, b = np.sum(d * d, axis=1), np.sum(o * d, axis=1)
    across = o - (b / a)[:, None] * d
    closest2 = np.sum(across * across, axis=1)
    with np.errstate(invalid="ignore"):
        half = np.sqrt((radius**2 - closest2) / a)
    return -b / a - half, -b / a + half, np.sqrt(closest2)


def random_rays(count, distance, seed=1):
    """Starts at `distance` from the centre, aimed at a disk somewhat larger than the sphere."""
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins *= distance / np.linalg.norm(origins, axis=1, keepdims=True)
    targets = rng.uniform(-1.1, 1.1, (count, 3))
    directions = targets - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize("distance", [0.0, 0.5, 1.5, 3.0, 1000.0])
def test_the_first_root_ahead_is_found(precision, distance):
    origins, directions = random_rays(20_000, distance)
    t = intersected(precision, origins, directions)
    o, d = rounded(precision, origins), rounded(precision, directions)
    near, far, closest = roots(o, d, 1.0)
    expected = np.where(near >= 0.0, near, far)
    # o + t d is rounded by some ε |o|, and that turns into 1/cosθ times as much along the ray.
    eps = np.finfo(precision).eps
    blur = 3.0 * eps * (distance + 1.0)
    sure = np.abs(1.0 - closest) > 4.0 * blur
    hit = sure & (closest < 1.0) & (expected >= 0.0)
    missed = sure & ~hit
    assert np.all(t[missed] == -1.0)
    cosine = np.sqrt(1.0 - closest[hit] ** 2)
    assert np.all(np.abs(t[hit] - expected[hit]) <= blur * (1.0 + closest[hit] / cosine))
    assert hit.sum() > 0.3 * len(t)


def test_far_spheres_are_met_where_they_are(precision):
    # A thousand radii away the textbook's quadratic is wrong by a fifth of the radius in float32;
    # the discriminant from the closest approach by the rounding of the distance itself.
    origins, directions = random_rays(20_000, 1000.0)
    t = intersected(precision, origins, directions)
    near, _, closest = roots(rounded(precision, origins), rounded(precision, directions), 1.0)
    central = closest < 0.7
    assert np.max(np.abs(t - near)[central]) < 4.0 * np.finfo(precision).eps * 1000.0


def points_on_sphere(count, radius, seed=2):
    rng = np.random.default_rng(seed)
    points, directions = rng.normal(size=(2, count, 3))
    points *= radius / np.linalg.norm(points, axis=1, keepdims=True)
    return points, directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize("radius", [1.0, 1e4, 1e-6])
def test_a_ray_that_leaves_does_not_meet_its_own_start(precision, radius):
    # The sphere's second root, 2 (-o·d), exactly; on a sphere of 10 km a fixed epsilon of 1e-4 m
    # would meet the start again with every second ray.
    points, directions = points_on_sphere(20_000, radius)
    t = intersected(precision, points, directions, radius, leaving=True)
    p, d = rounded(precision, points), rounded(precision, directions)
    chord = -2.0 * np.sum(p * d, axis=1)
    eps = np.finfo(precision).eps
    sure = np.abs(chord) > 8.0 * eps * radius
    assert np.all(t[sure & (chord < 0.0)] == -1.0)
    inward = sure & (chord > 0.0)
    assert np.max(np.abs(t - chord)[inward]) <= 8.0 * eps * radius
    ends = p[inward] + t[inward, None] * d[inward]
    # The start was rounded onto the sphere, and so the end is as near to it.
    distances = np.abs(np.linalg.norm(ends.astype(np.float64), axis=1) - radius)
    assert distances.max() <= 8.0 * eps * radius


def test_grazing_rays(precision):
    # One tangent, exactly in both precisions; one an ulp outside, one inside.
    step = 4.0 * float(np.finfo(precision).eps)
    origins = np.array([[-2.0, 1.0, 0.0], [-2.0, 1.0 + step, 0.0], [-2.0, 1.0 - step, 0.0]])
    t = intersected(precision, origins, np.tile([1.0, 0.0, 0.0], (3, 1)))
    assert t[0] == 2.0
    assert t[1] == -1.0
    # The half chord is √(2 step), to the first order.
    assert t[2] == pytest.approx(2.0 - np.sqrt(2.0 * step), abs=4.0 * step)
