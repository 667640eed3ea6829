"""What must not change an angle: turning, mirroring, scaling and moving the bench, or time."""

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays

EPS = float(np.finfo(np.float64).eps)

PRISM = scenes.Prism(
    position=(0.0, 0.0, 0.0), apex_deg=40.0, base=1.0, length=1.5, rotation_deg=(5.0, 10.0, 180.0)
)
CENTRES = {"lens": np.array([-2.0, 0.0, 0.1]), "prism": np.zeros(3), "ball": np.array([2.0, 0, 0])}
LENS_AXIS = np.array([1.0, 0.1, -0.05]) / np.linalg.norm([1.0, 0.1, -0.05])


def bench(matrix=None, scale=1.0, shift=(0.0, 0.0, 0.0)):
    """A lens, a prism and a ball in a row, x → shift + scale · matrix x."""
    matrix = np.eye(3) if matrix is None else matrix
    shift = np.asarray(shift)

    def placed(point):
        return tuple((shift + scale * (matrix @ point)).tolist())

    corners = PRISM.vertices_world() @ matrix.T * scale
    shapes = [
        scenes.Lens(
            position=placed(CENTRES["lens"]), axis=tuple((matrix @ LENS_AXIS).tolist()),
            thickness=0.3 * scale, aperture=1.0 * scale,
            first=scenes.LensSurface(radius=1.5 * scale, conic=-0.7),
            second=scenes.LensSurface(radius=-2.5 * scale),
        ),
        scenes.Polyhedron(
            position=placed(CENTRES["prism"]), vertices=tuple(map(tuple, corners.tolist()))
        ),
        scenes.Sphere(position=placed(CENTRES["ball"]), radius=0.6 * scale),
    ]  # fmt: skip
    media = ("N-BK7", "F2", "water")
    return scenes.Scene(
        objects=[
            scenes.SceneObject(name=name, shape=shape, material=scenes.Dielectric(medium=medium))
            for name, shape, medium in zip(CENTRES, shapes, media, strict=True)
        ]
    )


def rays(count=300):
    """Origins left of the lens, aimed at it, so that most go on to the prism and the ball."""
    rng = np.random.default_rng(21)
    origins = np.column_stack([np.full(count, -4.0), rng.uniform(-0.5, 0.5, (count, 2))])
    aims = np.column_stack([np.full(count, -2.0), rng.uniform(-0.4, 0.4, (count, 2))])
    directions = aims - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def traced(scene, origins, directions):
    start_device("cpu")
    wavelengths_nm = np.linspace(420.0, 680.0, len(origins))
    return trace_compiled_rays(
        compile_scene(scene), origins, directions, wavelengths_nm, max_interactions=24
    )


@pytest.fixture(scope="module")
def reference():
    paths = traced(bench(), *rays())
    assert sum("prism" in path.objects for path in paths) > 200
    assert sum("ball" in path.objects for path in paths) > 30
    assert sum("total internal reflection" in path.events for path in paths) > 20
    return paths


def assert_same_angles(reference, paths, matrix, *, distance=0.0):
    """Same events at the same objects, and the same directions but for rounding.

    Six to ten surfaces, lengths of some units that round by ε (and by that of the distance to the
    origin), and exits at up to 80°, where an error is six times larger: 64 ε a unit.
    """
    for before, after in zip(reference, paths, strict=True):
        assert after.events == before.events
        assert after.objects == before.objects
        error = np.abs(after.directions - before.directions @ matrix.T).max()
        assert error <= 64.0 * EPS * (8.0 + distance)


def random_rotation(seed):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.linalg.det(q)


@pytest.mark.parametrize("seed", [1, 2])
def test_turned_with_its_rays_the_bench_is_the_same(reference, seed):
    turn = random_rotation(seed)
    origins, directions = rays()
    paths = traced(bench(turn), origins @ turn.T, directions @ turn.T)
    assert_same_angles(reference, paths, turn)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_in_a_mirror_the_bench_is_its_mirror_image(reference, axis):
    mirror = np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))
    origins, directions = rays()
    paths = traced(bench(mirror), origins @ mirror, directions @ mirror)
    assert_same_angles(reference, paths, mirror)


@pytest.mark.parametrize("scale", [1e-3, 2.0, 1e3, 1e6])
def test_at_any_size_the_angles_are_the_same(reference, scale):
    # A power of two changes not a digit of the lengths; others round each by ε.
    origins, directions = rays()
    paths = traced(bench(scale=scale), scale * origins, directions)
    assert_same_angles(reference, paths, np.eye(3))
    if scale == 2.0:
        for before, after in zip(reference, paths, strict=True):
            np.testing.assert_allclose(after.points[1:-1], 2.0 * before.points[1:-1], atol=1e-14)


@pytest.mark.parametrize("distance", [1.0, 1e3, 1e6])
def test_far_from_the_files_origin_the_angles_are_the_same(reference, distance):
    # The description's coordinates round by ε times the distance; the local frame adds nothing.
    shift = distance * np.array([0.6, -0.8, 0.3])
    origins, directions = rays()
    paths = traced(bench(shift=shift), origins + shift, directions)
    assert_same_angles(reference, paths, np.eye(3), distance=distance)


def test_the_path_of_light_is_its_path_back(reference):
    # Fermat and Helmholtz: sent back from its end, the ray takes the same way, and is split alike.
    ends = np.array([path.points[-1] for path in reference])
    back = np.array([-path.directions[-1] for path in reference])
    paths = traced(bench(), ends, back)
    for forth, reverse in zip(reference, paths, strict=True):
        vertices = len(forth.events) - 1
        assert reverse.events[:vertices] == forth.events[:-1][::-1]
        assert reverse.objects[:vertices] == forth.objects[:-1][::-1]
        # Rounding on the way forth and on the way back; see above.
        error = np.abs(reverse.directions[vertices] + forth.directions[0]).max()
        assert error <= 2.0 * 64.0 * EPS * 8.0
        assert reverse.transmittance == pytest.approx(forth.transmittance, abs=1e-12)
