"""How far a flat shape reaches, against a walk along the direction."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

import scenes
from sim.device import start_device
from sim.geometry.extent import distance_to_circle, distance_to_planes, distance_to_sides
from sim.precision import precision_types
from sim.scene_data import struct_array
from sim.scene_structs import make_scene_structs

HALF_U, HALF_V, RADIUS = 1.5, 0.25, 0.75


@functools.cache
def make_probes(precision):
    types, structs = precision_types(precision), make_scene_structs(precision)
    real, vec3, plane_type = types.real, types.vec3, structs.Plane
    options = {"module": f"tests_extent_{precision}", "enable_backward": False}

    @wp.kernel(**options)
    def flat(
        uv: wp.array2d(dtype=real),
        phi: wp.array(dtype=real),
        half_u: real,
        half_v: real,
        radius2: real,
        out_sides: wp.array(dtype=real),
        out_circle: wp.array(dtype=real),
    ):
        i = wp.tid()
        u = uv[i, 0]
        v = uv[i, 1]
        c = wp.cos(phi[i])
        s = wp.sin(phi[i])
        out_sides[i] = distance_to_sides(u, v, half_u, half_v, c, s)
        out_circle[i] = distance_to_circle(u, v, radius2, c, s)

    @wp.kernel(**options)
    def solid(
        points: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        faces: wp.array(dtype=int),
        planes: wp.array(dtype=plane_type),
        out_distance: wp.array(dtype=real),
    ):
        i = wp.tid()
        out_distance[i] = distance_to_planes(
            points[i], directions[i], planes, 0, planes.shape[0], faces[i]
        )

    return SimpleNamespace(flat=flat, solid=solid, types=types, structs=structs)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def flat_distances(precision, uv, phi):
    """Distances to the sides of the rectangle and to the circle, as float64."""
    probes = make_probes(precision)
    inputs = [
        wp.array(uv, dtype=probes.types.real, device="cpu"),
        wp.array(phi, dtype=probes.types.real, device="cpu"),
        HALF_U, HALF_V, RADIUS**2,
    ]  # fmt: skip
    outs = [wp.zeros(len(phi), dtype=probes.types.real, device="cpu") for _ in range(2)]
    wp.launch(probes.flat, dim=len(phi), inputs=inputs, outputs=outs, device="cpu")
    return [out.numpy().astype(np.float64) for out in outs]


def furthest(inside, start, direction, reach):
    """How far one can walk from points before `inside` fails, by bisection; convex shapes."""
    low, high = np.zeros(len(start)), np.full(len(start), reach)
    for _ in range(60):
        middle = 0.5 * (low + high)
        is_in = inside(start + middle[:, None] * direction)
        low, high = np.where(is_in, middle, low), np.where(is_in, high, middle)
    return low


def test_rectangles_and_circles_end_where_their_points_do(precision):
    rng = np.random.default_rng(1)
    phi = np.concatenate([rng.uniform(0.0, 2.0 * np.pi, 3000), np.arange(4) * np.pi / 2.0])
    direction = np.stack([np.cos(phi), np.sin(phi)], axis=1)
    in_rectangle = rng.uniform(-1.0, 1.0, (len(phi), 2)) * [HALF_U, HALF_V]
    in_circle = in_rectangle * np.minimum(
        1.0, 0.99 * RADIUS / np.linalg.norm(in_rectangle, axis=1, keepdims=True)
    )
    sides, _ = flat_distances(precision, in_rectangle, phi)
    _, circle = flat_distances(precision, in_circle, phi)
    walked_sides = furthest(
        lambda p: np.all(np.abs(p) <= [HALF_U, HALF_V], axis=1), in_rectangle, direction, 10.0
    )
    walked_circle = furthest(
        lambda p: np.sum(p * p, axis=1) <= RADIUS**2, in_circle, direction, 10.0
    )
    # The start and the direction are rounded, and a side is met at an angle: ε over its sine.
    slack = 16.0 * np.finfo(precision).eps
    sine = np.maximum(np.abs(direction).min(axis=1), 1e-3)
    assert np.all(np.abs(sides - walked_sides) <= slack * (1.0 + 1.0 / sine))
    np.testing.assert_allclose(circle, walked_circle, rtol=0, atol=4.0 * slack)


def test_on_the_boundary_there_is_no_room_outward(precision):
    sides, circle = flat_distances(
        precision, np.array([[HALF_U, 0.0], [RADIUS, 0.0]]), np.array([0.0, 0.0])
    )
    assert sides[0] == 0.0
    assert circle[1] == pytest.approx(0.0, abs=float(np.finfo(precision).eps))


def test_faces_of_a_solid_end_at_their_neighbours(precision):
    probes = make_probes(precision)
    prism = scenes.Prism(
        position=(0.0, 0.0, 0.0), apex_deg=50.0, base=1.0, length=2.0,
        rotation_deg=(10.0, 30.0, 20.0),
    )  # fmt: skip
    normals, offsets = prism.faces()
    corners = prism.vertices_world()
    rng = np.random.default_rng(2)
    points, directions, faces = [], [], []
    for face, (normal, offset) in enumerate(zip(normals, offsets, strict=True)):
        own = corners[np.abs(corners @ normal - offset) < 1e-12]
        points.append(rng.dirichlet(np.ones(len(own)), 500) @ own)
        across = np.cross(rng.normal(size=(500, 3)), normal)
        directions.append(across / np.linalg.norm(across, axis=1, keepdims=True))
        faces.append(np.full(500, face))
    points, directions, faces = (np.concatenate(a) for a in (points, directions, faces))
    out = wp.zeros(len(points), dtype=probes.types.real, device="cpu")
    inputs = [
        *(wp.array(a, dtype=probes.types.vec3, device="cpu") for a in (points, directions)),
        wp.array(faces, dtype=int, device="cpu"),
        struct_array(probes.structs.Plane, list(zip(normals, offsets, strict=True)), "cpu"),
    ]  # fmt: skip
    wp.launch(probes.solid, dim=len(points), inputs=inputs, outputs=[out], device="cpu")
    walked = furthest(
        lambda p: np.all(p @ normals.T <= offsets + 1e-13, axis=1), points, directions, 10.0
    )
    # The nearest neighbour is met at an angle whose sine is at least a few hundredths, mostly.
    error = np.abs(out.numpy() - walked)
    assert np.quantile(error, 0.99) < 1e3 * np.finfo(precision).eps + 1e-11
