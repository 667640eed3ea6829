"""Heights in kernels: the host's (`scenes.shapes.depth`), with the nearest face and its normal."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

import scenes
from scenes.shapes.depth import height_above
from sim.device import start_device
from sim.features import Features
from sim.scene_data import compile_scene
from sim.scene_structs import make_scene_structs
from sim.surroundings import make_height_function

RANDOM = np.random.default_rng(8)
AXIS = (2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0)
TURNED = {"rotation_deg": (10.0, 20.0, 30.0)}


def lens(position, r1, r2, thickness, aperture):
    first, second = (
        scenes.LensSurface(curvature=0.0) if r == 0.0 else scenes.LensSurface(radius=r, conic=-0.5)
        for r in (r1, r2)
    )
    return scenes.Lens(
        position=position, axis=AXIS, thickness=thickness, aperture=aperture,
        first=first, second=second,
    )  # fmt: skip


SOLIDS = (
    scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.6),
    scenes.Box(position=(3.0, 0.0, 0.0), size=(1.0, 0.6, 0.8), **TURNED),
    scenes.Prism(position=(6.0, 0.0, 0.0), apex_deg=50, base=1, length=1, **TURNED),
    lens((9.0, 0.0, 0.0), 0.8, -0.9, 0.6, 1.0),
    lens((12.0, 0.0, 0.0), -1.0, 1.0, 0.1, 1.0),
    lens((15.0, 0.0, 0.0), 0.0, -0.5, 1.5, 0.9),
)
RECTANGLE = scenes.Rectangle(position=(18.0, 0.0, 0.0), size=(1.0, 0.5), normal=AXIS)
DISK = scenes.Disk(position=(21.0, 0.0, 0.0), radius=0.5, normal=AXIS)
SHAPES = (*SOLIDS, RECTANGLE, DISK)


@functools.cache
def make_probe(precision):
    structs = make_scene_structs(precision)
    real, vec3, scene_type = structs.real, structs.vec3, structs.Scene
    height_above_object = make_height_function(precision, Features())

    @wp.kernel(module=f"tests_height_{precision}", enable_backward=False)
    def probe(
        scene: scene_type, prim: int, points: wp.array(dtype=vec3),
        out_height: wp.array(dtype=real), out_face: wp.array(dtype=int),
        out_normal: wp.array(dtype=vec3),
    ):  # fmt: skip
        i = wp.tid()
        height, face, normal = height_above_object(scene, prim, points[i])
        out_height[i] = height
        out_face[i] = face
        out_normal[i] = normal

    return probe


@pytest.fixture(scope="module", params=["float64", "float32"])
def bench(request):
    device = start_device("cpu")
    wall = scenes.Lambertian(reflectance=0.5)
    scene = scenes.Scene(objects=[scenes.SceneObject(shape=one, material=wall) for one in SHAPES])
    compiled = compile_scene(scene, precision=request.param)
    structs = make_scene_structs(request.param)

    def measure(prim, points):
        n = len(points)
        kinds = (structs.real, int, structs.vec3)
        outs = [wp.zeros(n, dtype=kind, device=device) for kind in kinds]
        local = wp.array(compiled.to_local(points), dtype=structs.vec3, device=device)
        inputs = [compiled.data, prim, local]
        wp.launch(make_probe(request.param), dim=n, inputs=inputs, outputs=outs, device=device)
        height, face, normal = (one.numpy() for one in outs)
        return height.astype(np.float64), face, normal.astype(np.float64)

    return SimpleNamespace(
        measure=measure, compiled=compiled, eps=float(np.finfo(request.param).eps)
    )


def points_about(shape, count=3000):
    return np.array(shape.position) + RANDOM.uniform(-1.0, 1.0, (count, 3))


@pytest.mark.parametrize("prim", range(len(SOLIDS)))
def test_heights_above_solids_are_the_hosts(bench, prim):
    points = points_about(SOLIDS[prim])
    heights, _, normals = bench.measure(prim, points)
    # Coordinates of up to 21 m, of which single precision keeps 2⁻²⁴; at a cap's steep edge the
    # slope enlarges that some tens of times.
    np.testing.assert_allclose(heights, height_above(SOLIDS[prim], points), atol=400 * bench.eps)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=8 * bench.eps)
    assert np.any(heights < 0.0) and np.any(heights > 0.0)


@pytest.mark.parametrize("prim", range(len(SOLIDS)))
def test_next_to_a_face_it_is_the_way_along_the_normal(bench, prim):
    # From inside, outward by the depth, again and again, leads onto the nearest face.
    points = points_about(SOLIDS[prim])
    heights, _, _ = bench.measure(prim, points)
    points = points[heights < 0.0]
    for _ in range(30):
        heights, faces, normals = bench.measure(prim, points)
        points = points - heights[:, None] * normals
    heights, faces, normals = bench.measure(prim, points)
    landed = np.abs(heights) < 400 * bench.eps
    assert landed.mean() > 0.9
    step = 1e-6 if bench.eps < 1e-10 else 1e-3
    for sign in (1.0, -1.0):
        moved, there, _ = bench.measure(prim, points[landed] + sign * step * normals[landed])
        same = there == faces[landed]
        assert same.mean() > 0.95  # all but those at edges
        # Curvatures are up to 2.5 per metre, and more where a cap is steep: the error is half that
        # times step².
        error = np.abs(moved[same] - sign * step)
        assert np.quantile(error, 0.99) < 10.0 * step**2 + 800 * bench.eps


def test_no_plane_of_points_deep_inside_a_lens_is_near_a_face(bench):
    # At the height of a cap's centre of curvature its own normal lies flat, whatever the depth:
    # a ball lens is deep in its middle.
    prim = 5
    axis = np.array(AXIS)
    middle = np.array(SOLIDS[prim].position) + (0.75 - 0.5) * axis
    side = np.cross(axis, [0.0, 0.0, 1.0])
    points = np.array([middle + x * side for x in np.linspace(-0.2, 0.2, 9)])
    heights, _, _ = bench.measure(prim, points)
    assert np.all(heights < -0.15)


@pytest.mark.parametrize("prim", [6, 7])
def test_heights_above_flats_have_no_sign_and_end_at_their_limits(bench, prim):
    shape = SHAPES[prim]
    frame = np.stack(shape.frame()) if prim == 6 else None
    normal = np.array(AXIS)
    if frame is None:
        u = np.cross(normal, [0.0, 0.0, 1.0])
        u /= np.linalg.norm(u)
        frame = np.stack([u, np.cross(normal, u), normal])
    offsets = RANDOM.uniform(-0.7, 0.7, (2000, 3))
    heights, faces, normals = bench.measure(prim, np.array(shape.position) + offsets @ frame)
    u, v = np.abs(offsets[:, 0]), np.abs(offsets[:, 1])
    over = (u <= 0.5) & (v <= 0.25) if prim == 6 else np.hypot(u, v) <= 0.5
    clear = np.abs(np.hypot(u, v) - 0.5) > 1e-4 if prim == 7 else (
        (np.abs(u - 0.5) > 1e-4) & (np.abs(v - 0.25) > 1e-4)
    )  # fmt: skip
    np.testing.assert_array_equal(np.isfinite(heights)[clear], over[clear])
    np.testing.assert_allclose(
        heights[over & clear], np.abs(offsets[over & clear, 2]), atol=100 * bench.eps
    )
    np.testing.assert_allclose(normals, np.broadcast_to(normal, normals.shape), atol=4 * bench.eps)
    assert not faces.any()
