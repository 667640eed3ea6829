"""Rays and meshes, against a search over all triangles in extended precision."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

import scenes
from scenes.shapes import Surface
from sim.device import start_device
from sim.geometry.mesh import intersect_mesh, mesh_normal
from sim.geometry.mesh_height import height_above_mesh
from sim.mesh_data import PlacedMesh, compile_meshes
from sim.mesh_structs import make_mesh_structs
from sim.precision import precision_types

WIDE = np.longdouble
CENTRE = np.array([0.25, -0.5, 1.0])


class Given(scenes.Triangulated):
    """A surface handed over as it is."""

    def local_surface(self) -> Surface:
        return SURFACES[self.position[0]]


def bumpy_ball(seed, cells=10):
    """A closed surface, smooth-normalled and neither convex nor a ball: a bumpy globe."""
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(np.arange(2 * cells), np.arange(1, cells), indexing="ij")
    around, down = np.pi * u / cells, np.pi * v / cells
    ring = np.stack(
        [np.cos(around) * np.sin(down), np.sin(around) * np.sin(down), np.cos(down)], axis=-1
    )
    points = (ring * rng.uniform(0.7, 1.3, ring.shape[:2])[..., None]).reshape(-1, 3)
    points = np.vstack([points, [0, 0, 1.0], [0, 0, -1.0]])
    row = (np.arange(2 * cells) * (cells - 1))[:, None] + np.arange(cells - 1)
    ahead = np.roll(row, -1, axis=0)
    a, b = row[:, :-1].ravel(), row[:, 1:].ravel()
    c, d = ahead[:, 1:].ravel(), ahead[:, :-1].ravel()
    top, bottom = np.full(2 * cells, len(points) - 2), np.full(2 * cells, len(points) - 1)
    triangles = np.concatenate([
        np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1),
        np.stack([top, row[:, 0], ahead[:, 0]], axis=1),
        np.stack([bottom, ahead[:, -1], row[:, -1]], axis=1),
    ])  # fmt: skip
    return Surface(points, triangles)


def box():
    """Of 2 × 2 × 2, two triangles a face: every patch is flat, and large for its number."""
    points = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)])
    return Surface(points, np.array([
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]))  # fmt: skip


SURFACES = {0.0: bumpy_ball(1), 1.0: box(), 2.0: bumpy_ball(2).smoothed()}


@functools.cache
def make_probe(precision):
    types, structs = precision_types(precision), make_mesh_structs(precision)
    real, vec3, meshes_type = types.real, types.vec3, structs.Meshes

    @wp.kernel(module=f"tests_mesh_{precision}", enable_backward=False)
    def probe(
        meshes: meshes_type,
        row: int,
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        leaving: wp.array(dtype=int),
        tolerance: real,
        out_t: wp.array(dtype=real),
        out_face: wp.array(dtype=int),
        out_normal: wp.array(dtype=vec3),
        out_height: wp.array(dtype=real),
    ):
        i = wp.tid()
        mesh = meshes.rows[row]
        t, face = intersect_mesh(
            meshes, mesh, origins[i], directions[i], leaving[i], real(wp.inf)
        )
        out_t[i] = t
        out_face[i] = face
        if face >= 0:
            point = origins[i] + directions[i] * t
            out_normal[i] = mesh_normal(meshes, mesh, face, point, directions[i])
        height, _nearest, _up = height_above_mesh(meshes, mesh, origins[i], tolerance)
        out_height[i] = height

    return SimpleNamespace(probe=probe, types=types)


@functools.cache
def compiled(precision):
    shapes = [
        PlacedMesh(Given(position=(key, 0.0, 0.0)), CENTRE, row) for row, key in enumerate(SURFACES)
    ]
    return compile_meshes(shapes, precision=precision, device="cpu")


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def probed(precision, row, origins, directions, leaving=None, tolerance=0.0):
    made = make_probe(precision)
    types, n = made.types, len(origins)
    leaving = np.full(n, -1) if leaving is None else np.asarray(leaving)
    out = [
        wp.zeros(n, dtype=dtype, device="cpu")
        for dtype in (types.real, int, types.vec3, types.real)
    ]
    wp.launch(
        made.probe, dim=n,
        inputs=[
            compiled(precision), row,
            wp.array(origins.astype(types.dtype), dtype=types.vec3, device="cpu"),
            wp.array(directions.astype(types.dtype), dtype=types.vec3, device="cpu"),
            wp.array(leaving.astype(np.int32), dtype=int, device="cpu"), tolerance,
        ],
        outputs=out, device="cpu",
    )  # fmt: skip
    t, face, normal, height = (one.numpy() for one in out)
    return SimpleNamespace(
        t=t.astype(float), face=face, normal=normal.astype(float), height=height.astype(float)
    )


def crossings(surface, origins, directions):
    """(rays, triangles) distances by Möller & Trumbore (1997), infinite where there is none."""
    a, b, c = (x.astype(WIDE) for x in np.moveaxis(surface.corners, 1, 0))
    o, d = origins.astype(WIDE)[:, None], directions.astype(WIDE)[:, None]
    p = np.cross(d, c - a)
    det = np.sum((b - a) * p, axis=-1)
    s = o - a
    u = np.sum(s * p, axis=-1) / det
    q = np.cross(s, b - a)
    v = np.sum(d * q, axis=-1) / det
    t = np.sum((c - a) * q, axis=-1) / det
    return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0), t, np.inf)


def rays(count, seed, spread=0.8):
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins *= 3.0 / np.linalg.norm(origins, axis=1)[:, None]
    directions = rng.uniform(-spread, spread, (count, 3)) - origins
    return origins, directions / np.linalg.norm(directions, axis=1)[:, None]


def in_digits(precision, *arrays):
    """Inputs as the kernel gets them, so that both sides see the same rays."""
    return [a.astype(precision_types(precision).dtype).astype(float) for a in arrays]


@pytest.mark.parametrize("row", range(len(SURFACES)))
def test_it_finds_what_a_search_over_all_triangles_finds(precision, row) -> None:
    origins, directions = in_digits(precision, *rays(400, seed=row))
    found = probed(precision, row, origins, directions)
    expected = crossings(list(SURFACES.values())[row], origins, directions).min(axis=1)
    hits = np.isfinite(expected)
    # A ray may be judged otherwise at an outline by rounding only: none of these is that near.
    np.testing.assert_array_equal(found.face >= 0, hits)
    assert hits.sum() > 200
    # t = (a − o)·n / (d·n): some ten roundings of coordinates up to 4, over the cosine.
    eps = np.finfo(precision_types(precision).dtype).eps
    surface = list(SURFACES.values())[row]
    nearest = crossings(surface, origins, directions).argmin(axis=1)[hits]
    cosine = np.abs(np.sum(surface.facet_normals[nearest] * directions[hits], axis=1))
    error = np.abs(found.t[hits] - expected[hits].astype(float))
    assert (error < 100 * eps / cosine**2).all()


@pytest.mark.parametrize("row", range(len(SURFACES)))
def test_no_ray_slips_between_triangles(precision, row) -> None:
    # From inside, straight at corners and at points of edges: always out somewhere.
    surface = list(SURFACES.values())[row]
    corners = surface.corners.reshape(-1, 3)
    ends = np.roll(surface.corners, -1, axis=1).reshape(-1, 3)
    rng = np.random.default_rng(3)
    targets = np.vstack([corners, corners + rng.uniform(size=(len(corners), 1)) * (ends - corners)])
    origins = np.tile([0.01, -0.02, 0.03], (len(targets), 1))
    directions = targets - origins
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    found = probed(precision, row, origins, directions)
    assert (found.face >= 0).all()
    np.testing.assert_allclose(
        found.t, np.linalg.norm(targets - origins, axis=1), rtol=0,
        atol=1e4 * np.finfo(precision_types(precision).dtype).eps,
    )  # fmt: skip


@pytest.mark.parametrize("row", [0, 1])
def test_a_ray_that_has_left_a_closed_surface_alternates(precision, row) -> None:
    # Straight on through all of it: in, out, in, out … as often as the search says.
    surface = list(SURFACES.values())[row]
    origins, directions = in_digits(precision, *rays(200, seed=5, spread=0.9))
    expected = np.isfinite(crossings(surface, origins, directions)).sum(axis=1)
    leaving, count = np.full(len(origins), -1), np.zeros(len(origins), dtype=int)
    here = origins
    for step in range(20):
        found = probed(precision, row, here, directions, leaving)
        alive = (found.face >= 0) & ((leaving >= 0) | (step == 0))
        count += alive
        outward = np.sum(found.normal * directions, axis=1)
        assert ((outward > 0.0) == (step % 2 == 1))[alive].all()
        here = here + directions * np.maximum(found.t, 0.0)[:, None]
        leaving = np.where(alive, found.face, -1)
        here = np.where(alive[:, None], here, 100.0)
    np.testing.assert_array_equal(count, expected)


def test_a_smooth_normal_is_linear_between_corners_and_shows_its_face(precision) -> None:
    surface = SURFACES[2.0]
    rng = np.random.default_rng(4)
    weights = rng.dirichlet((1.0, 1.0, 1.0), len(surface.triangles))
    points = np.einsum("mi,mij->mj", weights, surface.corners)
    smooth = np.einsum("mi,mij->mj", weights, surface.corner_normals)
    smooth /= np.linalg.norm(smooth, axis=1)[:, None]
    directions = -surface.facet_normals
    found = probed(precision, 2, points - 0.01 * directions, directions)
    on_it = np.abs(found.t - 0.01) < 1e-4
    assert on_it.sum() > 0.9 * len(points)
    shows = np.sum(smooth * surface.facet_normals, axis=1) > 0.0
    expected = np.where(shows[:, None], smooth, surface.facet_normals)
    # Barycentric coordinates lose what the distance of 0.01 costs of the digits.
    eps = np.finfo(precision_types(precision).dtype).eps
    np.testing.assert_allclose(found.normal[on_it], expected[on_it], atol=2000 * eps)


@pytest.mark.parametrize("row", range(len(SURFACES)))
def test_heights_tell_inside_outside_and_on_it(precision, row) -> None:
    surface = list(SURFACES.values())[row]
    rng = np.random.default_rng(6)
    anywhere = in_digits(precision, rng.uniform(-1.5, 1.5, (300, 3)))[0]
    any_way = np.tile([[0.1, 0.7, 0.7071]], (300, 1))
    inside = np.isfinite(crossings(surface, anywhere, any_way)).sum(axis=1) % 2 == 1
    heights = probed(precision, row, anywhere, any_way, tolerance=1e-5).height
    assert 30 < inside.sum() < 250
    np.testing.assert_array_equal(heights, np.where(inside, -np.inf, np.inf))
    # On triangles, on edges and on corners, and off them by less and by more than the tolerance.
    weights = np.vstack([rng.dirichlet((1.0, 1.0, 1.0), 30), [[0.4, 0.6, 0.0], [1.0, 0.0, 0.0]]])
    which = rng.integers(len(surface.triangles), size=len(weights))
    points = np.einsum("mi,mij->mj", weights, surface.corners[which])
    off = surface.facet_normals[which]
    for distance, expected in ((0.0, 0.0), (0.5e-5, 0.0), (-0.5e-5, 0.0), (2e-5, np.inf)):
        found = probed(precision, row, points + distance * off, off, tolerance=1e-5).height
        if expected == 0.0:
            assert (found == 0.0).all()
        else:
            assert (found[:30] == expected).mean() > 0.9  # in a fold another facet is as near


def test_on_an_edge_a_ray_that_goes_in_comes_out_and_one_that_leaves_is_gone(precision) -> None:
    # Starts on the edges of a box, off them by some roundings either way, as vertices are. A ray
    # into the half spaces of both faces is in the box and has to come out of it next, even if it
    # started a hair before the other face. A box is convex: outward there is nothing.
    surface = SURFACES[1.0]
    eps = np.finfo(precision_types(precision).dtype).eps
    rng = np.random.default_rng(7)
    faces, sides = (one.ravel() for one in np.indices((12, 3)))
    across = surface.facet_normals[surface.neighbours[faces, sides]]
    start = surface.corners[faces, sides]
    end = surface.corners[faces, (sides + 1) % 3]
    starts = start + rng.uniform(0.2, 0.8, (36, 1)) * (end - start)
    starts = np.vstack([starts + k * eps * across for k in (-4.0, -1.0, 0.0, 1.0, 4.0)])
    normals = np.tile(surface.facet_normals[faces], (5, 1))
    directions = rng.normal(size=starts.shape)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    # Which row of the tree is which triangle: asked of a ray straight down onto its middle.
    middles = surface.corners.mean(axis=1)
    rows = probed(precision, 1, middles + surface.facet_normals, -surface.facet_normals).face
    found = probed(precision, 1, starts, directions, np.tile(rows[faces], 5))
    outward = np.sum(directions * normals, axis=1) > 0.0
    inward = ~outward & (np.sum(directions * np.tile(across, (5, 1)), axis=1) < 0.0)
    assert (found.face[outward] == -1).all()
    assert (found.face[inward] >= 0).all()
    assert (np.sum(found.normal * directions, axis=1)[inward] > 0.0).all()
