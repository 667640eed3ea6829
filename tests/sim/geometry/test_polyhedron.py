"""Rays and convex polyhedra, against a search over all faces in extended precision."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

import scenes
from sim.device import start_device
from sim.geometry.polyhedron import intersect_polyhedron
from sim.precision import precision_types
from sim.scene_data import struct_array
from sim.scene_structs import make_scene_structs

WIDE = np.longdouble


@functools.cache
def make_probes(precision):
    types, structs = precision_types(precision), make_scene_structs(precision)
    real, vec3, plane_type = types.real, types.vec3, structs.Plane

    @wp.kernel(module=f"tests_polyhedron_{precision}", enable_backward=False)
    def probe(
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        leaving: wp.array(dtype=int),
        planes: wp.array(dtype=plane_type),
        first: int,
        out_t: wp.array(dtype=real),
        out_face: wp.array(dtype=int),
    ):
        i = wp.tid()
        count = planes.shape[0] - 2 * first
        t, face = intersect_polyhedron(
            origins[i], directions[i], planes, first, count, leaving[i]
        )
        out_t[i] = t
        out_face[i] = face

    return SimpleNamespace(probe=probe, types=types, structs=structs)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def intersected(precision, faces, origins, directions, leaving=None):
    """Distances, −1 for none, as float64, and faces counted from 0, −1 for none."""
    probes = make_probes(precision)
    # The rows stand between those of two bodies that are not asked for.
    other = (np.array([0.0, 0.0, 1.0]), -9.0)
    rows = [other, *zip(*faces, strict=True), other]
    leaving = np.full(len(origins), -1) if leaving is None else np.asarray(leaving)
    inputs = [
        *(wp.array(a, dtype=probes.types.vec3, device="cpu") for a in (origins, directions)),
        wp.array(np.where(leaving < 0, -1, leaving + 1), dtype=int, device="cpu"),
        struct_array(probes.structs.Plane, rows, "cpu"), 1,
    ]  # fmt: skip
    t = wp.zeros(len(origins), dtype=probes.types.real, device="cpu")
    face = wp.zeros(len(origins), dtype=int, device="cpu")
    wp.launch(probes.probe, dim=len(origins), inputs=inputs, outputs=[t, face], device="cpu")
    found = face.numpy()
    return t.numpy().astype(np.float64), np.where(found < 0, -1, found - 1)


def random_hull(seed, corners):
    """Faces of the hull of random points of the unit sphere."""
    points = np.random.default_rng(seed).normal(size=(corners, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return scenes.Polyhedron(position=(0.0, 0.0, 0.0), vertices=points.tolist()).faces()


BOX = scenes.Box(position=(0.0, 0.0, 0.0), size=(1.0, 2.0, 0.5), rotation_deg=(10.0, 20.0, 30.0))
WEDGE = scenes.Prism(
    position=(0.0, 0.0, 0.0), apex_deg=1e-3, base=0.8, length=1.0, height=1.5,
    rotation_deg=(0.0, 40.0, 5.0),
)  # fmt: skip
SOLIDS = {
    "box": BOX.faces(),
    "wedge": WEDGE.faces(),
    "tetrahedron": random_hull(3, 4),
    "hull": random_hull(4, 20),
}


def depths(faces, points):
    """How deep points (n, 3) lie below each face (n, m); negative outside."""
    normals, offsets = (np.asarray(a, dtype=WIDE) for a in faces)
    return offsets - points @ normals.T


def brute_force(faces, origins, directions, precision):
    """First crossing ahead of the body's surface, where a face's plane is hit inside all others.

    Returns:
        Distances (n,), inf for none, and how clearly the ray hits or misses (n,): the least
        distance by which any plane would have to move to change which face is hit, or whether.
    """
    faces = [np.asarray(a).astype(precision) for a in faces]
    o, d = origins.astype(precision).astype(WIDE), directions.astype(precision).astype(WIDE)
    normals = np.asarray(faces[0], dtype=WIDE)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = depths(faces, o) / (d @ normals.T)
        points = o[:, None, :] + t[..., None] * d[:, None, :]
        room = np.stack([depths(faces, points[:, face]) for face in range(len(normals))], axis=1)
    for face in range(len(normals)):
        room[:, face, face] = np.inf
    least = np.nan_to_num(room.min(axis=2), nan=-np.inf)
    is_hit = (least >= 0.0) & (t >= 0.0)
    first = np.where(is_hit, t, np.inf).min(axis=1)
    clear = np.minimum(np.abs(least).min(axis=1), np.abs(np.nan_to_num(t, nan=1.0)).min(axis=1))
    return first, clear


def random_rays(count, seed):
    """Starts in a box around the bodies, so that some are inside, and directions at random."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return rng.uniform(-1.2, 1.2, (count, 3)), directions


@pytest.mark.parametrize("solid", SOLIDS)
def test_the_first_face_ahead_is_found(precision, solid):
    faces = SOLIDS[solid]
    origins, directions = random_rays(10_000, 5)
    t, face = intersected(precision, faces, origins, directions)
    expected, clear = brute_force(faces, origins, directions, precision)
    eps = float(np.finfo(precision).eps)
    sure = clear > 40.0 * eps
    assert sure.mean() > 0.99
    hit = np.isfinite(expected)
    assert np.all(t[sure & ~hit] == -1.0)
    assert np.all(face[sure & ~hit] == -1)
    found = sure & hit
    assert found.sum() > 500
    # A plane's distance rounds by some ε, and the ray meets it at an angle.
    cosine = np.abs(np.sum(faces[0][face[found]] * directions[found], axis=1))
    bound = 16.0 * eps * (1.0 + expected[found]) / cosine
    assert np.all(np.abs(t[found] - expected[found]) <= bound)


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_ray_that_leaves_a_face_meets_another_or_none(precision, solid):
    faces = SOLIDS[solid]
    origins, directions = random_rays(10_000, 6)
    t, face = intersected(precision, faces, origins, directions)
    on = face >= 0
    points = (origins + t[:, None] * directions)[on]
    _, onward = random_rays(on.sum(), 7)
    t2, face2 = intersected(precision, faces, points, onward, leaving=face[on])
    approach = np.sum(faces[0][face[on]] * onward, axis=1)
    assert np.all(t2[approach > 0.0] == -1.0)  # outward, never again
    inward = approach < 0.0
    assert np.all(t2[inward] >= 0.0)  # inward, out through another face
    assert np.all(face2[inward] != face[on][inward])
    exits = points[inward] + t2[inward, None] * onward[inward]
    assert depths(faces, exits.astype(WIDE)).min() > -1e3 * np.finfo(precision).eps


def test_a_polyhedron_of_a_boxs_corners_is_the_box(precision):
    corners = BOX.vertices_world()
    hull = scenes.Polyhedron(position=(0.0, 0.0, 0.0), vertices=corners.tolist()).faces()
    assert len(hull[0]) == 6
    origins, directions = random_rays(20_000, 8)
    t_box, face_box = intersected(precision, BOX.faces(), origins, directions)
    t_hull, face_hull = intersected(precision, hull, origins, directions)
    both = (t_box >= 0.0) & (t_hull >= 0.0)
    assert np.mean(both == ((t_box >= 0.0) | (t_hull >= 0.0))) > 0.9999  # but for an edge grazed
    np.testing.assert_allclose(
        BOX.faces()[0][face_box[both]], hull[0][face_hull[both]], rtol=0, atol=1e-14
    )
    cosine = np.abs(np.sum(BOX.faces()[0][face_box] * directions, axis=1))[both]
    eps = np.finfo(precision).eps
    assert np.all(np.abs(t_box - t_hull)[both] <= 64.0 * eps / cosine)


UNIT_BOX = scenes.Box(position=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0)).faces()  # ±x, ±y, ±z


def test_rays_along_the_axes(precision):
    origins = np.array([[-2.0, 0.1, 0.2], [-2.0, 0.6, 0.2], [0.0, 0.1, 0.2], [2.0, 0.1, 0.2]])
    t, face = intersected(precision, UNIT_BOX, origins, np.tile([1.0, 0.0, 0.0], (4, 1)))
    assert t.tolist() == [1.5, -1.0, 0.5, -1.0]
    assert face.tolist() == [1, -1, 0, -1]


@pytest.mark.parametrize("beyond", [0.0, 1e-7, -1e-7])
def test_a_ray_inside_that_runs_along_an_edge_finds_its_way_out(precision, beyond):
    # The last hit was on the face +x, next to the edge with +y; rounding may have put the point
    # a hair outside +y, along which the ray now runs.
    origin, direction = [[0.5, 0.5 + beyond, 0.0]], [[-0.6, 0.0, 0.8]]
    t, face = intersected(precision, UNIT_BOX, np.array(origin), np.array(direction), leaving=[0])
    assert face.tolist() == [4]
    assert t[0] == pytest.approx(0.5 / 0.8, rel=4e-7)


def test_a_ray_that_leaves_past_an_edge_goes_out_at_once(precision):
    # Inward of +x, outward of +y, whose plane is already a hair behind.
    t, face = intersected(
        precision, UNIT_BOX, np.array([[0.5, 0.5 + 1e-7, 0.0]]), np.array([[-0.6, 0.8, 0.0]]),
        leaving=[0],
    )  # fmt: skip
    assert (t.tolist(), face.tolist()) == ([0.0], [2])


def test_what_another_body_left_does_not_count(precision):
    # The ray has just left a face of some other body that happens to lie in this one.
    t, face = intersected(
        precision, UNIT_BOX, np.array([[0.0, 0.0, 0.0]]), np.array([[1.0, 0.0, 0.0]]), leaving=[9]
    )
    assert (t.tolist(), face.tolist()) == ([0.5], [0])
