"""Rays and planes."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.geometry.flat import intersect_plane, plane_coordinates
from sim.precision import precision_types


@functools.cache
def make_probes(precision):
    types = precision_types(precision)
    real, vec3, mat33 = types.real, types.vec3, types.mat33

    @wp.kernel(module=f"tests_flat_{precision}", enable_backward=False)
    def probe(
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        frame: mat33,
        out_t: wp.array(dtype=real),
        out_uv: wp.array2d(dtype=real),
    ):
        i = wp.tid()
        t = intersect_plane(origins[i], directions[i], frame[2])
        u, v = plane_coordinates(origins[i] + directions[i] * t, frame)
        out_t[i] = t
        out_uv[i, 0] = u
        out_uv[i, 1] = v

    return SimpleNamespace(probe=probe, types=types)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def intersected(precision, origins, directions, frame):
    """Distances (n,), −1 for none, and the coordinates in the plane (n, 2), as float64."""
    probes = make_probes(precision)
    inputs = [wp.array(a, dtype=probes.types.vec3, device="cpu") for a in (origins, directions)]
    rows = probes.types.mat33(*np.asarray(frame, dtype=np.float64).ravel())
    t = wp.zeros(len(origins), dtype=probes.types.real, device="cpu")
    uv = wp.zeros((len(origins), 2), dtype=probes.types.real, device="cpu")
    wp.launch(
        probes.probe, dim=len(origins), inputs=[*inputs, rows], outputs=[t, uv], device="cpu"
    )
    return t.numpy().astype(np.float64), uv.numpy().astype(np.float64)


def random_frame(rng):
    """Rows u, v, n: right-handed."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.linalg.det(q)


def test_hits_lie_where_linear_algebra_puts_them(precision):
    # o + t d = a u + b v: three equations for t, a and b.
    rng = np.random.default_rng(3)
    frame = random_frame(rng)
    origins = rng.uniform(-2.0, 2.0, (5000, 3))
    directions = rng.normal(size=(5000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    t, uv = intersected(precision, origins, directions, frame)
    columns = np.stack([np.tile(frame[0], (5000, 1)), np.tile(frame[1], (5000, 1)), -directions])
    solved = np.linalg.solve(columns.transpose(1, 2, 0), origins[..., None])[..., 0]
    cosine = np.abs(directions @ frame[2])
    ahead = solved[:, 2] >= 0.0
    height = np.abs(origins @ frame[2])
    sure = height > 20.0 * np.finfo(precision).eps  # else which side it is on is rounding
    assert np.all(t[sure & ~ahead] == -1.0)
    # Both the height of the start and the slope of the ray round by ε: relative to the cosine.
    bound = 12.0 * np.finfo(precision).eps * (4.0 + np.abs(solved[:, 2])) / cosine
    hit = sure & ahead
    assert np.all(np.abs(t - solved[:, 2])[hit] <= bound[hit])
    assert np.all(np.abs(uv - solved[:, :2])[hit] <= bound[hit, None])


UPRIGHT = np.eye(3)


@pytest.mark.parametrize("height", [1.0, 0.0, -1.0])
def test_parallel_rays_never_meet_the_plane(precision, height):
    origin, direction = np.array([[0.0, 0.0, height]]), np.array([[0.6, 0.8, 0.0]])
    t, _ = intersected(precision, origin, direction, UPRIGHT)
    assert t.tolist() == [-1.0]


def test_both_sides_are_met_and_what_is_behind_is_not(precision):
    origins = np.array([[1.0, 2.0, 3.0], [1.0, 2.0, -3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 0.0]])
    down, up = [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]
    t, uv = intersected(precision, origins, np.array([down, up, up, up]), UPRIGHT)
    assert t.tolist() == [3.0, 3.0, -1.0, 0.0]
    np.testing.assert_array_equal(uv, np.tile([1.0, 2.0], (4, 1)))
