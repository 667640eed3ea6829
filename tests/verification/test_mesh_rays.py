"""Meshes against the shapes that they stand for: faceted ones exactly, smooth ones in the limit."""

import numpy as np
import pytest

import scenes
from scenes.shapes import Surface
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays

GLASS = scenes.Dielectric(medium="SF11")
WAVELENGTH_NM = 550.0
EPS = np.finfo(float).eps


def write_obj(path, surface, *, normals=False):
    """`surface` as an OBJ file, whose decimal numbers are the very ones."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in surface.vertices.tolist()]
    if normals:
        lines += [f"vn {x!r} {y!r} {z!r}" for x, y, z in surface.vertices.tolist()]
        lines += ["f " + " ".join(f"{v}//{v}" for v in face) for face in surface.triangles + 1]
    else:
        lines += [f"f {a} {b} {c}" for a, b, c in surface.triangles + 1]
    path.write_text("\n".join(lines))
    return str(path)


def cut(triangles, rounds, on_sphere=False):
    """Triangles (m, 3, 3), each cut into four as often as told; on the unit sphere if asked."""
    for _ in range(rounds):
        a, b, c = np.moveaxis(triangles, 1, 0)
        middles = [0.5 * (p + q) for p, q in ((a, b), (b, c), (c, a))]
        if on_sphere:
            middles = [m / np.linalg.norm(m, axis=1, keepdims=True) for m in middles]
        ab, bc, ca = middles
        parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    vertices, rows = np.unique(triangles.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    return Surface(vertices, rows.reshape(-1, 3))


def faceted(solid, rounds):
    """A convex solid's faces as triangles that bulge nowhere: fans about the corners' order."""
    corners = solid.local_vertices()
    triangles = []
    for normal, offset in zip(*solid.local_faces(), strict=True):
        on_face = corners[np.abs(corners @ normal - offset) < 1e-9 * np.abs(corners).max()]
        u = on_face[1] - on_face[0]
        v = np.cross(normal, u)
        middle = on_face.mean(axis=0)
        turn = np.arctan2((on_face - middle) @ v, (on_face - middle) @ u)
        ring = on_face[np.argsort(turn)]
        triangles += [np.stack([ring[0], ring[i], ring[i + 1]]) for i in range(1, len(ring) - 1)]
    return cut(np.array(triangles), rounds)


def octahedron():
    corners = np.eye(3)
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)])
    return np.array([corners * s if s.prod() > 0 else corners[::-1] * s for s in signs])


def traced(shape, origins, directions, *, material=GLASS, **options):
    scene = scenes.Scene(objects=(scenes.SceneObject(name="it", shape=shape, material=material),))
    wavelengths = np.full(len(origins), WAVELENGTH_NM)
    return trace_compiled_rays(compile_scene(scene), origins, directions, wavelengths, **options)


def rays_at(shape, count, seed):
    rng = np.random.default_rng(seed)
    centre, radius = shape.bounding_sphere()
    origins = rng.normal(size=(count, 3))
    origins *= 4.0 * radius / np.linalg.norm(origins, axis=1)[:, None]
    directions = rng.uniform(-0.5, 0.5, (count, 3)) * radius - origins
    return centre + origins, directions / np.linalg.norm(directions, axis=1)[:, None]


PLACE = {"position": (0.1, 0.2, -0.3), "rotation_deg": (20.0, -35.0, 10.0)}
SOLIDS = {
    "box": scenes.Box(size=(0.03125, 0.0625, 0.046875), **PLACE),
    "prism": scenes.Prism(apex_deg=60.0, base=0.0625, length=0.125, **PLACE),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_a_faceted_solid_is_the_polyhedron(tmp_path, name) -> None:
    solid = SOLIDS[name]
    mesh = scenes.Mesh(file=write_obj(tmp_path / "a.obj", faceted(solid, 3)), **PLACE)
    assert mesh.is_closed
    origins, directions = rays_at(solid, 300, seed=1)
    pairs = zip(traced(solid, origins, directions), traced(mesh, origins, directions), strict=True)
    worst, total = 0.0, 0
    for exact, other in pairs:
        assert exact.events == other.events
        total += "total internal reflection" in exact.events
        worst = max(worst, float(np.abs(exact.directions - other.directions).max()))
    assert total > 20
    # A facet's normal is the cross product of two sides of 1/8 of the edge: eight roundings of
    # coordinates up to the extent, over that side. Snell's law passes an error of the normal on
    # (η − 1)/cosθ_t times, for each of the few surfaces that a ray meets.
    assert worst < 8 * 8 * EPS * 100


def test_smooth_normals_approach_the_sphere_with_the_square_of_the_facets(tmp_path) -> None:
    # Position and interpolated normal of a facet of size h are both off by O(h²), so halving h
    # takes the error to a quarter. Flat facets have normals off by O(h): to a half.
    ball = scenes.Sphere(position=(0.0, 0.0, 0.0), radius=1.0)
    rng = np.random.default_rng(2)
    r, phi = 0.7 * np.sqrt(rng.uniform(size=400)), rng.uniform(0.0, 2.0 * np.pi, 400)
    origins = np.stack([r * np.cos(phi), r * np.sin(phi), np.full(400, -3.0)], axis=1)
    # A direction that is parallel to no plane of symmetry of the octahedron.
    turn = scenes.rotation_matrix((31.0, 17.0, 5.0))
    origins, directions = origins @ turn.T, np.tile(turn[:, 2], (400, 1))
    exact = traced(ball, origins, directions)

    def error(rounds, normals):
        surface = cut(octahedron(), rounds, on_sphere=True)
        file = write_obj(tmp_path / f"{rounds}{normals}.obj", surface, normals=True)
        mesh = scenes.Mesh(position=(0.0, 0.0, 0.0), file=file, normals=normals)
        found = traced(mesh, origins, directions)
        sines = [
            np.linalg.norm(np.cross(one.directions[-1], other.directions[-1]))
            for one, other in zip(found, exact, strict=True)
            if one.events == other.events
        ]
        assert len(sines) > 390
        return float(np.sqrt(np.mean(np.square(sines))))

    # The next order of the expansion, and 400 rays' scatter, leave some tenths of the rate.
    for normals, rate in (("file", 2.0), ("smooth", 2.0), ("flat", 1.0)):
        measured = np.log2(error(4, normals) / error(5, normals))
        assert measured == pytest.approx(rate, abs=0.35), normals


def test_a_mirror_of_smooth_triangles_sends_no_light_behind_itself(tmp_path) -> None:
    # On all of the disc, to grazing: there the smooth normal would reflect into the facet. Each ray
    # leaves after one reflection, as off the ball, and where it is not that near the limb (3 h,
    # h = π/32) in the ball's direction, to h²: twice the normal's h²/8, over the limb's cosine.
    h = np.pi / 32
    file = write_obj(tmp_path / "ball.obj", cut(octahedron(), 4, on_sphere=True), normals=True)
    mesh = scenes.Mesh(position=(0.0, 0.0, 0.0), file=file)
    ball = scenes.Sphere(position=(0.0, 0.0, 0.0), radius=1.0)
    rng = np.random.default_rng(5)
    # Half of the rays where it can happen: where −d·n is less than half that of the facet.
    r = np.sqrt(np.where(np.arange(600) < 300, rng.uniform(size=600), rng.uniform(0.99, 1.0, 600)))
    phi = rng.uniform(0.0, 2.0 * np.pi, 600)
    origins = np.stack([r * np.cos(phi), r * np.sin(phi), np.full(600, -3.0)], axis=1)
    turn = scenes.rotation_matrix((31.0, 17.0, 5.0))
    origins, directions = origins @ turn.T, np.tile(turn[:, 2], (600, 1))
    paths = [
        traced(one, origins, directions, material=scenes.Mirror(reflectance=1.0))
        for one in (mesh, ball)
    ]
    limb = 1.0 - r**2 < (3.0 * h) ** 2
    for near_limb, path, exact in zip(limb, *paths, strict=True):
        assert len(path.events) <= 2
        if not near_limb:
            assert path.events == exact.events
            off = np.linalg.norm(path.directions[-1] - exact.directions[-1])
            assert off < h**2 / abs(np.dot(exact.points[1], exact.directions[0]))
    assert 300 < limb.sum() < 400


def test_light_in_the_mesh_of_a_box_is_reflected_totally_as_in_the_box(tmp_path) -> None:
    # From inside, steeper than the critical angle: a long path that must not leak.
    solid = SOLIDS["box"]
    mesh = scenes.Mesh(file=write_obj(tmp_path / "a.obj", faceted(solid, 3)), **PLACE)
    rng = np.random.default_rng(3)
    directions = rng.normal(size=(100, 3))
    origins = np.tile(np.array(PLACE["position"]), (100, 1)) + 1e-3
    options = {"max_interactions": 40}
    same = 0
    for exact, other in zip(
        traced(solid, origins, directions, **options),
        traced(mesh, origins, directions, **options), strict=True,
    ):
        same += exact.events == other.events
    assert same == 100


def test_a_mesh_in_contact_with_glass_of_its_own_kind_is_not_there(tmp_path) -> None:
    # A cube's lower half a box, its upper half a mesh: across the seam light goes straight on.
    half = scenes.Box(position=(0.0, 0.5, 0.0), size=(2.0, 1.0, 2.0))
    file = write_obj(tmp_path / "half.obj", faceted(half, 2))
    halves = (
        scenes.Box(position=(0.0, -0.5, 0.0), size=(2.0, 1.0, 2.0)),
        scenes.Mesh(position=(0.0, 0.5, 0.0), file=file),
    )
    whole = scenes.Box(position=(0.0, 0.0, 0.0), size=(2.0, 2.0, 2.0))
    origins, directions = rays_at(whole, 200, seed=4)
    wavelengths = np.full(200, WAVELENGTH_NM)
    scene = scenes.Scene(objects=tuple(
        scenes.SceneObject(name=str(i), shape=one, material=GLASS) for i, one in enumerate(halves)
    ))  # fmt: skip
    found = trace_compiled_rays(compile_scene(scene), origins, directions, wavelengths)
    passes = 0
    for one, other in zip(found, traced(whole, origins, directions), strict=True):
        np.testing.assert_allclose(one.directions[-1], other.directions[-1], atol=1e-13)
        passes += len(one.events) > len(other.events)
    assert passes > 50
