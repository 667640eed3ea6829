"""Rays and lens surfaces, against a search along the ray for where it crosses the sag."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from scenes import LensSurface
from sim.device import start_device
from sim.geometry.lens import cap_normal, intersect_cap, intersect_rim
from sim.precision import precision_types

WIDE = np.longdouble
STEPS = 200


@functools.cache
def make_probes(precision):
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3
    options = {"module": f"tests_lens_{precision}", "enable_backward": False}

    @wp.kernel(**options)
    def cap(
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        curvature: real,
        one_plus_conic: real,
        rho2_limit: real,
        leaving: bool,
        out_t: wp.array(dtype=real),
        out_normal: wp.array(dtype=vec3),
    ):
        i = wp.tid()
        t = intersect_cap(
            origins[i], directions[i], curvature, one_plus_conic, rho2_limit, leaving
        )
        out_t[i] = t
        out_normal[i] = cap_normal(origins[i] + directions[i] * t, curvature, one_plus_conic)

    @wp.kernel(**options)
    def rim(
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        radius: real,
        z_low: real,
        z_high: real,
        leaving: bool,
        out_t: wp.array(dtype=real),
    ):
        i = wp.tid()
        out_t[i] = intersect_rim(origins[i], directions[i], radius, z_low, z_high, leaving)

    return SimpleNamespace(cap=cap, rim=rim, types=types)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def vectors(precision, *arrays):
    dtype = precision_types(precision).vec3
    return [wp.array(a, dtype=dtype, device="cpu") for a in arrays]


def cap_hits(precision, origins, directions, surface, rim, *, leaving=False):
    """Distances (n,), −1 for none, and unit normals (n, 3), as float64."""
    probes = make_probes(precision)
    shape = [surface.curvature, 1.0 + surface.conic, rim * rim, leaving]
    t = wp.zeros(len(origins), dtype=probes.types.real, device="cpu")
    normal = wp.zeros(len(origins), dtype=probes.types.vec3, device="cpu")
    inputs = [*vectors(precision, origins, directions), *shape]
    wp.launch(probes.cap, dim=len(origins), inputs=inputs, outputs=[t, normal], device="cpu")
    return t.numpy().astype(np.float64), normal.numpy().astype(np.float64)


def rim_hits(precision, origins, directions, *, leaving=False):
    """Distances (n,) to the cylinder of radius 1 between z = −0.5 and 0.75, as float64."""
    probes = make_probes(precision)
    t = wp.zeros(len(origins), dtype=probes.types.real, device="cpu")
    inputs = [*vectors(precision, origins, directions), 1.0, -0.5, 0.75, leaving]
    wp.launch(probes.rim, dim=len(origins), inputs=inputs, outputs=[t], device="cpu")
    return t.numpy().astype(np.float64)


def sag(surface, rho2):
    """Born & Wolf (1999), §4.10, as in `scenes`, over an array of ρ², extended precision."""
    c, k = WIDE(surface.curvature), WIDE(surface.conic)
    return c * rho2 / (1.0 + np.sqrt(np.maximum(1.0 - (1.0 + k) * c * c * rho2, 0.0)))


def crossings(surface, rim, origins, directions, *, start=0.0):
    """First distance beyond `start` where each ray crosses the surface; inf where none is seen.

    Walks along the part of the ray inside the cylinder of the rim, and bisects the first change
    of sign of z − sag(ρ). It does not see two crossings closer together than a step.
    """
    o, d = origins.astype(WIDE), directions.astype(WIDE)
    a = np.sum(d[:, :2] ** 2, axis=1)
    b = np.sum(o[:, :2] * d[:, :2], axis=1)
    c = np.sum(o[:, :2] ** 2, axis=1) - WIDE(rim) ** 2
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    enter, leave = np.maximum((-b - root) / a, start), (-b + root) / a
    meets = (b * b > a * c) & (leave > enter)

    def above(t):
        p = o + t[:, None] * d
        return p[:, 2] - sag(surface, np.sum(p[:, :2] ** 2, axis=1)) > 0.0

    first = above(enter)
    low = high = enter
    found = np.zeros(len(o), dtype=bool)
    for step in np.linspace(0.0, 1.0, STEPS)[1:]:
        t = enter + step * (leave - enter)
        low, high = np.where(found, low, high), np.where(found, high, t)
        found |= meets & (above(t) != first)
    for _ in range(64):
        middle = 0.5 * (low + high)
        same = above(middle) == first
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.where(found, low, WIDE(np.inf))


SURFACES = {
    "sphere": (LensSurface(radius=1.0), 0.9),
    "hemisphere": (LensSurface(radius=1.0), 1.0),
    "concave": (LensSurface(radius=-1.2), 1.0),
    "paraboloid": (LensSurface(radius=0.5, conic=-1.0), 1.0),
    "hyperboloid": (LensSurface(radius=-0.5, conic=-2.3), 1.0),
    "oblate": (LensSurface(radius=1.0, conic=0.5), 0.8),
    "prolate": (LensSurface(radius=0.8, conic=-0.6), 1.0),
    "shallow": (LensSurface(curvature=1e-6), 1.0),
    "plane": (LensSurface(curvature=0.0), 1.0),
}


def random_rays(count, seed=1, distance=3.0):
    """Starts around the vertex and inside the bowl, aimed at points near the surface."""
    rng = np.random.default_rng(seed)
    origins = rng.uniform(-1.0, 1.0, (count, 3)) * [1.0, 1.0, distance]
    directions = rng.uniform(-1.0, 1.0, (count, 3)) - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def steepness(surface, points):
    """Gradient of z − sag(ρ) at points (n, 3): (−s x/ρ, −s y/ρ, 1) with slope s = dz/dρ."""
    c, k = surface.curvature, surface.conic
    rho2 = np.sum(points[:, :2] ** 2, axis=1)
    slope_over_rho = c / np.sqrt(np.maximum(1.0 - (1.0 + k) * c * c * rho2, 1e-30))
    return np.column_stack([-slope_over_rho[:, None] * points[:, :2], np.ones(len(points))])


@pytest.mark.parametrize("name", SURFACES)
def test_the_first_crossing_of_the_sag_is_found(precision, name):
    surface, rim = SURFACES[name]
    origins, directions = (a.astype(precision) for a in random_rays(1500))
    t, normal = cap_hits(precision, origins, directions, surface, rim)
    expected = crossings(surface, rim, origins, directions)
    eps = float(np.finfo(precision).eps)
    seen = np.isfinite(expected)
    hit = seen & (t >= 0.0)
    # Next to the rim, at glancing incidence and at a start on the surface rounding decides.
    assert np.mean(hit == seen) > 0.995
    assert seen.sum() > 350
    points = origins[hit] + expected[hit, None].astype(np.float64) * directions[hit]
    gradient = steepness(surface, points)
    cosine = np.abs(np.sum(gradient * directions[hit], axis=1)) / np.linalg.norm(gradient, axis=1)
    error = np.abs(t[hit] - expected[hit])
    # The quadratic is in coordinates of size 1 to 2, so its terms round by some ε, and the ray
    # meets the surface at an angle.
    clear = cosine > 0.05
    assert np.all(error[clear] <= 40.0 * eps / cosine[clear])
    # The normal looks toward −z, across the surface.
    tilt = np.linalg.norm(np.cross(normal[hit], gradient), axis=1)
    tilt /= np.linalg.norm(gradient, axis=1)
    flat_enough = clear & (np.abs(gradient).max(axis=1) < 30.0)
    bend = abs(surface.curvature) * np.linalg.norm(gradient, axis=1) ** 3 + 1.0
    assert np.all(tilt[flat_enough] <= 100.0 * eps * (bend / cosine)[flat_enough])
    assert np.all(normal[hit][:, 2] < 0.0)


@pytest.mark.parametrize("name", SURFACES)
def test_what_is_found_lies_on_the_sheet_of_the_vertex(precision, name):
    # Also the hits that the walk along the ray does not see: double ones near a tangent.
    surface, rim = SURFACES[name]
    origins, directions = (a.astype(precision) for a in random_rays(20_000, seed=2))
    t, _ = cap_hits(precision, origins, directions, surface, rim)
    hit = t >= 0.0
    points = origins[hit].astype(np.float64) + t[hit, None] * directions[hit].astype(np.float64)
    eps = float(np.finfo(precision).eps)
    rho = np.hypot(points[:, 0], points[:, 1])
    assert rho.max() <= rim * (1.0 + 16.0 * eps)
    off = points[:, 2] - sag(surface, rho**2).astype(np.float64)
    across = off / np.linalg.norm(steepness(surface, points), axis=1)
    # At a tangent the rounding ε of the discriminant is one of √ε along the ray, and that along
    # the surface, which falls away from the tangent by the square: ε again.
    assert np.abs(across).max() <= 400.0 * eps


@pytest.mark.parametrize("name", SURFACES)
def test_a_ray_that_leaves_finds_the_other_crossing_only(precision, name):
    surface, rim = SURFACES[name]
    rng = np.random.default_rng(3)
    rho, phi = 0.95 * rim * np.sqrt(rng.uniform(size=1500)), rng.uniform(0.0, 2.0 * np.pi, 1500)
    z = sag(surface, rho.astype(WIDE) ** 2).astype(np.float64)
    origins = np.column_stack([rho * np.cos(phi), rho * np.sin(phi), z]).astype(precision)
    directions = rng.normal(size=(1500, 3))
    directions = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(precision)
    t, _ = cap_hits(precision, origins, directions, surface, rim, leaving=True)
    expected = crossings(surface, rim, origins, directions, start=1e-3)
    seen = np.isfinite(expected)
    assert np.mean((t > 1e-3) == seen) > 0.99
    both = seen & (t > 1e-3)
    gradient = steepness(surface, origins.astype(np.float64))
    cosine = np.abs(np.sum(gradient * directions, axis=1)) / np.linalg.norm(gradient, axis=1)
    clear = both & (cosine > 0.05)
    eps = float(np.finfo(precision).eps)
    # The start is ε off the surface, and so the end is off by that over the cosine there, which
    # for a conic is not the one here: a generous factor.
    assert np.all(np.abs(t - expected)[clear] <= 400.0 * eps / cosine[clear])
    if surface.curvature == 0.0:
        assert not both.any()


def test_a_plane_is_the_limit_of_small_curvatures(precision):
    # z = c ρ²/2: no jump on the way to c = 0, from either side.
    origins, directions = random_rays(5000, seed=4)
    flat, _ = cap_hits(precision, origins, directions, LensSurface(curvature=0.0), 1.0)
    eps = float(np.finfo(precision).eps)
    for c in (1e-30, 1e-12, 1e-9, 1e-6, 1e-3):
        for sign in (1.0, -1.0):
            bent, _ = cap_hits(precision, origins, directions, LensSurface(curvature=sign * c), 1.0)
            both = (flat > 0.0) & (bent > 0.0) & (np.abs(directions[:, 2]) > 0.1)
            assert np.mean((flat > 0.0) == (bent > 0.0)) > 0.998
            # ρ ≤ 1, the ray's slope up to 10 and the distance up to some 4.
            assert np.max(np.abs(flat - bent)[both]) <= 10.0 * c + 200.0 * eps


def test_the_far_half_of_an_ellipsoid_and_the_other_hyperboloid_are_not_there(precision):
    up = np.array([[0.0, 0.0, 1.0]])
    start = np.array([[0.1, 0.0, 0.5]])
    sphere, hyperboloid = LensSurface(radius=1.0), LensSurface(radius=1.0, conic=-3.0)
    # From inside the sphere upward only its far half is ahead; downward lies the cap.
    assert cap_hits(precision, start, up, sphere, 0.9)[0].tolist() == [-1.0]
    down, _ = cap_hits(precision, start, -up, sphere, 0.9)
    assert down[0] == pytest.approx(0.5 - (1.0 - np.sqrt(0.99)), rel=1e-6)
    # ρ² − 2z² − 2z = 0 has its other sheet below z = −1.
    assert cap_hits(precision, -2.0 * up, -up, hyperboloid, 1.0)[0].tolist() == [-1.0]
    assert cap_hits(precision, -2.0 * up, up, hyperboloid, 1.0)[0][0] == pytest.approx(2.0)


def cylinder_roots(origins, directions):
    """Both distances to the endless cylinder of radius 1, extended precision; NaN for none."""
    o, d = origins.astype(WIDE), directions.astype(WIDE)
    a = np.sum(d[:, :2] ** 2, axis=1)
    b = np.sum(o[:, :2] * d[:, :2], axis=1) / a
    across = o[:, :2] - b[:, None] * d[:, :2]
    with np.errstate(invalid="ignore"):
        half = np.sqrt((1.0 - np.sum(across * across, axis=1)) / a)
    return -b - half, -b + half


def rim_reference(origins, directions, start=0.0):
    """First root at or beyond `start` between the heights of the rim; inf for none."""
    first = np.full(len(origins), WIDE(np.inf))
    clear = np.ones(len(origins), dtype=WIDE)
    for t in cylinder_roots(origins, directions):
        z = origins[:, 2] + t * directions[:, 2]
        with np.errstate(invalid="ignore"):
            valid = (t >= start) & (z >= -0.5) & (z <= 0.75)
        first = np.where(valid, np.minimum(first, np.nan_to_num(t)), first)
        for limit in (-0.5, 0.75):
            clear = np.fmin(clear, np.abs(z - limit))
        clear = np.fmin(clear, np.abs(t - start))
    return first, clear


@pytest.mark.parametrize("distance", [0.5, 3.0, 1000.0])
def test_the_rim_is_met_where_it_is(precision, distance):
    # From a thousand radii away too, where the textbook's quadratic has no digit left in float32.
    rng = np.random.default_rng(5)
    origins = rng.normal(size=(20_000, 3))
    origins *= distance / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = rng.uniform(-1.1, 1.1, (20_000, 3)) - origins
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins, directions = (a.astype(precision) for a in (origins, directions))
    t = rim_hits(precision, origins, directions)
    expected, clear = rim_reference(origins, directions)
    near, far = cylinder_roots(origins, directions)
    slope2 = np.sum(directions[:, :2].astype(np.float64) ** 2, axis=1)
    eps = float(np.finfo(precision).eps)
    # The start rounds by ε |o|; the cylinder is met at the angle whose cosine is the half chord,
    # and t is measured along a ray that runs along the axis for 1/√(dx² + dy²) of it.
    half = np.nan_to_num((far - near) / 2.0 * np.sqrt(slope2), nan=0.0).astype(np.float64)
    sure = (half > 0.1) & (slope2 > 0.01)
    bound = 8.0 * eps * (distance + 1.0) / (half * np.sqrt(slope2) + 1e-30)
    sure &= clear > 2.0 * bound
    hit = sure & np.isfinite(expected)
    assert np.all(t[sure & ~np.isfinite(expected)] == -1.0)
    assert np.all(np.abs(t - expected)[hit] <= bound[hit])
    assert hit.sum() > 1000


def test_a_ray_that_leaves_the_rim_crosses_to_the_other_side(precision):
    rng = np.random.default_rng(6)
    phi, z = rng.uniform(0.0, 2.0 * np.pi, 5000), rng.uniform(-0.5, 0.75, 5000)
    origins = np.column_stack([np.cos(phi), np.sin(phi), z]).astype(precision)
    directions = rng.normal(size=(5000, 3))
    directions = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(precision)
    t = rim_hits(precision, origins, directions, leaving=True)
    o, d = origins.astype(np.float64), directions.astype(np.float64)
    chord = -2.0 * np.sum(o[:, :2] * d[:, :2], axis=1) / np.sum(d[:, :2] ** 2, axis=1)
    end = o[:, 2] + chord * d[:, 2]
    expected = np.where((chord > 0.0) & (end >= -0.5) & (end <= 0.75), chord, -1.0)
    eps = float(np.finfo(precision).eps)
    sure = np.minimum(np.abs(end + 0.5), np.abs(end - 0.75)) > 100.0 * eps
    sure &= np.abs(chord) > 100.0 * eps
    # o·d rounds by ε, and is divided by the square of the ray's slope to the axis.
    error = np.abs(t - expected) * np.sum(d[:, :2] ** 2, axis=1)
    assert np.all(error[sure] <= 8.0 * eps)


def test_rays_along_the_axis_never_meet_the_rim(precision):
    origins = np.array([[0.5, 0.0, -2.0], [1.0, 0.0, -2.0], [2.0, 0.0, -2.0]])
    t = rim_hits(precision, origins, np.tile([0.0, 0.0, 1.0], (3, 1)))
    assert t.tolist() == [-1.0, -1.0, -1.0]
    leaving = rim_hits(precision, origins[1:2], np.array([[0.0, 0.0, 1.0]]), leaving=True)
    assert leaving.tolist() == [-1.0]
