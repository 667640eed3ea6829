"""What `trace_ray` takes and tells: branches, events, ends, and refusals."""

import math

import numpy as np
import pytest

import scenes
import sim
from sim.errors import SettingsError
from sim.ray_path import RayPath
from sim.single_ray import trace_compiled_rays
from spectra import WavelengthOutOfRange

ORIGIN = (0.0, 0.0, 0.0)
RIGHT = (1.0, 0.0, 0.0)


def scene_of(*objects, **fields):
    return scenes.Scene(
        objects=[
            scenes.SceneObject(name=name, shape=shape, material=material)
            for name, shape, material in objects
        ],
        **fields,
    )


GLASS = scenes.Dielectric(medium="N-BK7")
BALL = scene_of(("ball", scenes.Sphere(position=ORIGIN, radius=1.0), GLASS))
WALLED = scene_of(
    ("ball", scenes.Sphere(position=ORIGIN, radius=1.0), GLASS),
    (
        "wall",
        scenes.Rectangle(position=(3.0, 0.0, 0.0), size=(9.0, 9.0), normal=(-1.0, 0.0, 0.0)),
        scenes.Lambertian(reflectance=0.5),
    ),
    (
        "trap",
        scenes.Disk(position=(-3.0, 0.0, 0.0), radius=2.0, normal=RIGHT),
        scenes.Absorber(),
    ),
)


def test_a_path_tells_its_vertices_from_start_to_end():
    path = sim.trace_ray(WALLED, (-2.0, 0.5, 0.0), RIGHT, 550.0)
    assert path.events == ("refract", "refract", "deposit")
    assert path.objects == ("ball", "ball", "wall")
    assert path.points.shape == (4, 3)
    assert path.directions.shape == (3, 3)
    assert path.points[0].tolist() == [-2.0, 0.5, 0.0]
    assert path.points[-1][0] == pytest.approx(3.0, abs=1e-15)
    segments = np.diff(path.points, axis=0)
    along = segments / np.linalg.norm(segments, axis=1, keepdims=True)
    np.testing.assert_allclose(along, path.directions, rtol=0, atol=1e-15)
    assert path.reflectances[-1] == 0.0
    assert np.all(path.reflectances[:2] > 0.04)
    assert path.wavelength_nm == 550.0


def test_an_absorber_ends_the_path():
    path = sim.trace_ray(WALLED, (-2.0, 0.5, 0.0), (-1.0, 0.0, 0.0), 550.0)
    assert path.events == ("absorb",)
    assert path.objects == ("trap",)
    assert path.deviation == 0.0
    assert path.transmittance == 1.0


def test_a_ray_that_escapes_ends_outside_the_scene():
    path = sim.trace_ray(BALL, (-2.0, 0.5, 0.0), RIGHT, 550.0)
    assert path.events[-1] == "escape"
    assert path.objects[-1] == ""
    assert np.linalg.norm(path.points[-1]) == pytest.approx(2.0)
    away = sim.trace_ray(BALL, (50.0, 0.0, 0.0), RIGHT, 550.0)
    assert away.events == ("escape",)
    assert away.points[-1][0] > 50.0


@pytest.mark.parametrize(
    ("branches", "events"),
    [
        ((), ("refract", "refract", "escape")),
        (("reflect",), ("reflect", "escape")),
        (("refract", "reflect"), ("refract", "reflect", "refract", "escape")),
        (("refract", "reflect", "refract"), ("refract", "reflect", "refract", "escape")),
        (["refract", "refract"], ("refract", "refract", "escape")),
        (("refract",) + 3 * ("reflect",), ("refract",) + 3 * ("reflect",) + ("refract", "escape")),
        (("reflect",) * 9, ("reflect", "escape")),  # more than there are boundaries
    ],
)
def test_branches_are_followed_boundary_by_boundary(branches, events):
    path = sim.trace_ray(BALL, (-2.0, 0.5, 0.0), RIGHT, 550.0, branches=branches)
    assert path.events == events
    shares = [1.0 - r if event == "refract" else r
              for event, r in zip(path.events[:-1], path.reflectances, strict=False)]  # fmt: skip
    assert path.transmittance == pytest.approx(math.prod(shares), rel=1e-15)


def test_total_reflection_leaves_no_choice():
    # The top is met at 53°, beyond the critical angle of 41°, and the side at 37°: the first entry
    # is passed over, and the second one counts.
    box = scene_of(("box", scenes.Box(position=ORIGIN, size=(2.0, 2.0, 2.0)), GLASS))
    start, way = (0.0, 0.9, 0.0), (0.8, 0.6, 0.0)
    for branches, second in [
        ((), "refract"),
        (("reflect",), "refract"),
        (("refract", "reflect"), "reflect"),
        (("reflect", "reflect"), "reflect"),
    ]:
        path = sim.trace_ray(box, start, way, 550.0, branches=branches, max_interactions=3)
        assert path.events[:2] == ("total internal reflection", second)
    steep = sim.trace_ray(box, (0.5, 0.5, 0.0), (0.7, 0.71, 0.0), 550.0, max_interactions=3)
    assert steep.events == ("total internal reflection", "total internal reflection", "limit")
    assert steep.transmittance == 1.0
    assert steep.reflectances.tolist() == [1.0, 1.0, 1.0]


def test_a_path_that_is_not_over_says_so():
    path = sim.trace_ray(BALL, (-2.0, 0.5, 0.0), RIGHT, 550.0, max_interactions=1)
    assert path.events == ("limit",)
    assert path.objects == ("ball",)
    assert path.points.shape == (2, 3)


@pytest.mark.parametrize("length", [1e-300, 1e-30, 7.0, 1e30, 1e300])
def test_a_direction_may_have_any_length(length):
    reference = sim.trace_ray(BALL, (-2.0, 0.3, 0.1), (1.0, 0.2, -0.1), 550.0)
    direction = length * np.array([1.0, 0.2, -0.1])
    path = sim.trace_ray(BALL, (-2.0, 0.3, 0.1), direction, 550.0)
    assert path.events == reference.events
    np.testing.assert_allclose(path.directions, reference.directions, rtol=0, atol=1e-15)


def test_an_empty_scene_lets_rays_go():
    path = sim.trace_ray(scenes.Scene(), ORIGIN, RIGHT, 550.0)
    assert path.events == ("escape",)
    assert path.points.tolist() == [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]


def test_single_precision_is_a_setting():
    double = sim.trace_ray(BALL, (-2.0, 0.5, 0.0), RIGHT, 550.0)
    single = sim.trace_ray(BALL, (-2.0, 0.5, 0.0), RIGHT, 550.0, precision="float32")
    error = abs(single.deviation - double.deviation)
    assert 0.0 < error < 1e-6
    assert single.points.dtype == np.float64


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("origin", {"origin": (0.0, 0.0)}),
        ("origin", {"origin": (0.0, 0.0, math.nan)}),
        ("direction", {"direction": (0.0, 0.0, 0.0)}),
        ("direction", {"direction": (math.inf, 0.0, 0.0)}),
        ("direction", {"direction": 1.0}),
        ("branches", {"branches": ("refract", "transmit")}),
        ("branches", {"branches": "reflect"}),
        ("max_interactions", {"max_interactions": 0}),
    ],
)
def test_what_is_wrong_is_said(field, arguments):
    call = {"origin": ORIGIN, "direction": RIGHT, "wavelength_nm": 550.0, **arguments}
    with pytest.raises(SettingsError) as caught:
        sim.trace_ray(BALL, **call)
    assert caught.value.field == field


def test_an_unknown_device_is_refused():
    with pytest.raises(sim.DeviceError, match="no device 'cuda:7' here"):
        sim.trace_ray(BALL, ORIGIN, RIGHT, 550.0, device="cuda:7")


@pytest.mark.parametrize("wavelength_nm", [0.55, 200.0, 3000.0, math.nan, -1.0])
def test_every_medium_must_have_an_index_at_the_wavelength(wavelength_nm):
    with pytest.raises(WavelengthOutOfRange, match="N-BK7"):
        sim.trace_ray(BALL, ORIGIN, RIGHT, wavelength_nm)


def test_the_ambient_medium_too():
    constant = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
    ball = ("ball", scenes.Sphere(position=ORIGIN, radius=1.0), constant)
    with pytest.raises(WavelengthOutOfRange, match="diamond"):
        sim.trace_ray(scene_of(ball, ambient="diamond"), (-2.0, 0.5, 0.0), RIGHT, 900.0)
    # Into vacuum through the index of air, which is published from 230 to 1690 nm.
    with pytest.raises(WavelengthOutOfRange, match="standard air"):
        sim.trace_ray(scene_of(ball, ambient="vacuum"), (-2.0, 0.5, 0.0), RIGHT, 200.0)
    assert sim.trace_ray(scene_of(ball), (-2.0, 0.5, 0.0), RIGHT, 200.0).events[0] == "refract"


def test_many_rays_are_the_single_ones():
    rng = np.random.default_rng(1)
    origins = np.column_stack([np.full(20, -2.5), rng.uniform(-1.2, 1.2, (20, 2))])
    ways = np.tile(RIGHT, (20, 1))
    wavelengths_nm = rng.uniform(400.0, 700.0, 20)
    from sim.device import start_device
    from sim.scene_data import compile_scene

    start_device("cpu")
    paths = trace_compiled_rays(compile_scene(WALLED), origins, ways, wavelengths_nm)
    assert {path.events[0] for path in paths} == {"refract", "deposit"}
    for path, origin, wavelength_nm in zip(paths, origins, wavelengths_nm, strict=True):
        alone = sim.trace_ray(WALLED, origin, RIGHT, wavelength_nm)
        assert path.events == alone.events
        np.testing.assert_array_equal(path.points, alone.points)
        np.testing.assert_array_equal(path.reflectances, alone.reflectances)


def test_a_changed_scene_is_compiled_anew():
    moved = scene_of(("ball", scenes.Sphere(position=(0.0, 9.0, 0.0), radius=1.0), GLASS))
    assert sim.trace_ray(BALL, (-2.0, 0.5, 0.0), RIGHT, 550.0).events[0] == "refract"
    assert sim.trace_ray(moved, (-2.0, 0.5, 0.0), RIGHT, 550.0).events == ("escape",)
    assert sim.trace_ray(BALL, (-2.0, 0.5, 0.0), RIGHT, 550.0).events[0] == "refract"


def test_deviation_is_measured_without_loss():
    # By atan2: the arc cosine of a scalar product would read 0 for 1e-9 rad.
    path = RayPath(
        points=np.zeros((3, 3)), directions=np.array([[1.0, 0.0, 0.0], [1.0, 1e-9, 0.0]]),
        events=("refract", "escape"), objects=("ball", ""), reflectances=np.zeros(2),
        absorptances=np.zeros(2), polarisations=np.zeros((2, 3)), frames=np.zeros((2, 3)),
        normals=np.zeros((2, 3)),
        wavelength_nm=550.0,
    )  # fmt: skip
    assert path.deviation == pytest.approx(1e-9, rel=1e-15)


def test_mirrors_and_hidden_faces_have_names_of_their_own():
    grey = scenes.NapierianAbsorption(coefficient=2.0)
    glass_of = {"medium": scenes.ConstantMedium(eta=1.5), "absorption": grey}
    scene = scenes.Scene(objects=[
        scenes.SceneObject(
            name="outer", shape=scenes.Box(position=ORIGIN, size=(2.0, 2.0, 2.0)),
            material=scenes.Dielectric(priority=1, **glass_of),
        ),
        scenes.SceneObject(
            name="hidden", shape=scenes.Box(position=ORIGIN, size=(1.0, 1.0, 1.0)),
            material=scenes.Dielectric(medium="N-BK7"),
        ),
        scenes.SceneObject(
            name="wall", shape=scenes.Plane(position=(3.0, 0.0, 0.0), normal=(-1.0, 0.0, 0.0)),
            material=scenes.Mirror(reflectance=0.75),
        ),
    ])  # fmt: skip
    path = sim.trace_ray(scene, (-3.0, 0.0, 0.0), RIGHT, 550.0, max_interactions=9)
    through = ("refract", "pass", "pass", "refract")
    assert path.events == (*through, "mirror", *through[:3], "limit")
    assert path.objects[:5] == ("outer", "hidden", "hidden", "outer", "wall")
    # 1 − exp(−α d) on each way, and what the mirror keeps where it ends one.
    ways = 1.0 - np.exp(-2.0 * np.array([0.5, 1.0, 0.5]))
    expected = [0.0, *ways, 0.25, 0.0, *ways]
    np.testing.assert_allclose(path.absorptances, expected, rtol=1e-14, atol=1e-16)
    assert path.reflectances[4] == 1.0
    # A mirror and a hidden face take no entry that names a branch of theirs, but the mirror counts.
    back = sim.trace_ray(
        scene, (-3.0, 0.0, 0.0), RIGHT, 550.0, branches=("refract", "refract", "reflect", "reflect")
    )
    assert back.events[:6] == (*through, "mirror", "reflect")
    away = sim.trace_ray(scene, (-3.0, 0.0, 0.0), RIGHT, 550.0, branches=("reflect",))
    assert away.events == ("reflect", "escape")
    assert away.transmittance == pytest.approx(0.04, rel=1e-14)
