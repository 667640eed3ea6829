"""The scene as the device sees it: places in the local frame, and indices of its media."""

import functools
import math

import numpy as np
import pytest
import warp as wp

import scenes
from sim.device import start_device
from sim.scene_data import bounding_radius, compile_scene, find_origin
from sim.transport import make_transport
from spectra import air_index, glass

ORIGIN = (0.0, 0.0, 0.0)
BLACK = scenes.Absorber()


@pytest.fixture(autouse=True)
def _device():
    start_device("cpu")


def scene_of(*objects, **fields):
    return scenes.Scene(
        objects=[
            scenes.SceneObject(name=f"object {i}", shape=shape, material=material)
            for i, (shape, material) in enumerate(objects)
        ],
        **fields,
    )


def ball(x, medium):
    return scenes.Sphere(position=(x, 0.0, 0.0), radius=0.5), scenes.Dielectric(medium=medium)


# The local frame


def test_the_origin_is_the_middle_of_the_finite_objects():
    scene = scene_of(
        (scenes.Sphere(position=(10.0, 0.0, 0.0), radius=1.0), BLACK),
        (scenes.Box(position=(20.0, 4.0, 0.0), size=(2.0, 2.0, 2.0)), BLACK),
        (scenes.Plane(position=(1e6, 1e6, 1e6), normal=(0.0, 1.0, 0.0)), BLACK),
    )
    # From 9 to 20 + √3 along x, from −1 to 4 + √3 along y, −√3 to √3 along z.
    root = np.sqrt(3.0)
    np.testing.assert_allclose(find_origin(scene), [(29 + root) / 2, (3 + root) / 2, 0.0])


def test_without_finite_objects_the_origin_is_the_worlds():
    plane = scenes.Plane(position=(5.0, 5.0, 5.0), normal=(0.0, 1.0, 0.0))
    assert find_origin(scene_of((plane, BLACK))).tolist() == [0.0, 0.0, 0.0]
    assert find_origin(scene_of()).tolist() == [0.0, 0.0, 0.0]


def test_positions_are_told_in_the_local_frame():
    compiled = compile_scene(scene_of((scenes.Sphere(position=(3e8, 1.0, 2.0), radius=1.0), BLACK)))
    assert compiled.origin.tolist() == [3e8, 1.0, 2.0]
    assert compiled.to_local((3e8, 1.0, 2.5)).tolist() == [0.0, 0.0, 0.5]
    assert compiled.to_local(np.zeros((4, 3))).shape == (4, 3)
    assert compiled.data.spheres.numpy()["centre"].tolist() == [[0.0, 0.0, 0.0]]


def test_a_scene_far_away_keeps_its_digits_in_single_precision():
    offset = 1e6
    scene = scene_of(
        (scenes.Sphere(position=(offset, 0.0, 0.0), radius=1e-3), BLACK),
        (scenes.Sphere(position=(offset + 0.01, 0.0, 0.0), radius=1e-3), BLACK),
    )
    x = compile_scene(scene, precision="float32").data.spheres.numpy()["centre"][:, 0]
    # The world's coordinates round by 1.2e-10 in float64, the local ones by their own 1e-10.
    assert x[1] - x[0] == pytest.approx(0.01, abs=1e-9)


# Shapes


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_every_shape_has_a_row_and_every_object_a_body(precision):
    scene = scene_of(
        (scenes.Rectangle(position=ORIGIN, size=(2.0, 4.0), normal=(0.0, 0.0, 1.0)), BLACK),
        ball(0.0, "F2"),
        (scenes.Disk(position=ORIGIN, normal=(1.0, 0.0, 0.0), radius=3.0), BLACK),
        (scenes.Box(position=ORIGIN, size=(1.0, 2.0, 3.0)), scenes.Lambertian(reflectance=0.5)),
        (scenes.Plane(position=ORIGIN, normal=(0.0, 1.0, 0.0)), BLACK),
        (scenes.Prism(position=ORIGIN, apex_deg=60.0, base=1.0, length=1.0), BLACK),
    )
    data = compile_scene(scene, precision=precision).data
    assert data.flats.numpy()["prim"].tolist() == [0, 2, 4]
    assert data.spheres.numpy()["prim"].tolist() == [1]
    assert data.polyhedra.numpy()["prim"].tolist() == [3, 5]
    assert (data.flat_count, data.sphere_count, data.polyhedron_count, data.lens_count) == (
        3, 1, 2, 0,
    )  # fmt: skip
    assert data.polyhedra.numpy()["first"].tolist() == [0, 6]
    assert data.polyhedra.numpy()["count"].tolist() == [6, 5]
    assert len(data.planes.numpy()) == 11
    # Dielectric 0, Lambertian 1, absorber 2.
    assert data.bodies.numpy()["material"].tolist() == [2, 0, 2, 1, 2, 2]


def test_flat_shapes_have_right_handed_frames_and_their_own_limits():
    up = (0.0, 0.6, 0.8)
    scene = scene_of(
        (scenes.Rectangle(position=ORIGIN, size=(2.0, 4.0), normal=(1.0, 0.0, 0.0), up=up), BLACK),
        (scenes.Disk(position=ORIGIN, normal=(1.0, 2.0, 2.0), radius=3.0), BLACK),
        (scenes.Plane(position=ORIGIN, normal=(0.0, -1.0, 0.0)), BLACK),
    )
    flats = compile_scene(scene).data.flats.numpy()
    frames = flats["frame"]
    np.testing.assert_allclose(
        frames @ frames.transpose(0, 2, 1), np.broadcast_to(np.eye(3), (3, 3, 3)), atol=1e-15
    )
    np.testing.assert_allclose(np.linalg.det(frames), 1.0)
    np.testing.assert_allclose(frames[0, 1], up, atol=1e-15)
    np.testing.assert_allclose(frames[1, 2], np.array([1.0, 2.0, 2.0]) / 3.0)
    assert flats["half_u"].tolist() == [1.0, np.inf, np.inf]
    assert flats["half_v"].tolist() == [2.0, np.inf, np.inf]
    assert flats["radius2"].tolist() == [np.inf, 9.0, np.inf]


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_the_rim_of_a_lens_overlaps_its_caps(precision):
    lens = scenes.Lens(
        position=ORIGIN, thickness=0.2, aperture=1.0,
        first=scenes.LensSurface(radius=2.0), second=scenes.LensSurface(radius=-1.0, conic=-1.0),
    )  # fmt: skip
    compiled = compile_scene(scene_of((lens, scenes.Dielectric(medium="F2"))), precision=precision)
    (row,) = compiled.data.lenses.numpy()
    # Sags at ρ = 0.5: of the sphere 2 − √(4 − ¼), of the paraboloid −ρ²/2.
    low, high = -0.1 + 2.0 - np.sqrt(3.75), 0.1 - 0.125
    eps = float(np.finfo(precision).eps)
    assert low - 20 * eps <= row["rim_low"] < low
    assert high < row["rim_high"] <= high + 20 * eps
    assert 0.25 < row["rho2_limit"] <= 0.25 * (1.0 + 20 * eps)
    assert [row["curvature_front"], row["curvature_back"]] == [0.5, -1.0]
    assert [row["one_plus_conic_front"], row["one_plus_conic_back"]] == [1.0, 0.0]


# Media

CAUCHY = scenes.CauchyMedium(a=(1.5, 0.004), range_nm=(380.0, 750.0), relative_to="vacuum")
TABLE = scenes.TableMedium(wavelength_nm=(380.0, 500.0, 750.0), eta=(1.7, 1.66, 1.64))
CONSTANT = scenes.ConstantMedium(eta=1.4)
WAVELENGTHS_NM = np.linspace(400.0, 700.0, 31)


@functools.cache
def make_probe_indices(precision, features):
    transport = make_transport(precision, features)
    real, scene_type, media_indices = transport.real, transport.Scene, transport.media_indices

    @wp.kernel(module="unique", enable_backward=False)
    def probe_indices(
        scene: scene_type, wavelengths_nm: wp.array(dtype=real), out_eta: wp.array2d(dtype=real)
    ):
        i = wp.tid()
        indices = media_indices(scene, wavelengths_nm[i])
        for medium in range(out_eta.shape[1]):
            out_eta[i, medium] = indices[medium]

    return probe_indices


def device_indices(compiled):
    """(wavelengths, media), as float64."""
    real = compiled.structs.real
    eta = wp.zeros((WAVELENGTHS_NM.size, compiled.features.media_count), dtype=real, device="cpu")
    wavelengths_nm = wp.array(WAVELENGTHS_NM, dtype=real, device="cpu")
    wp.launch(
        make_probe_indices(compiled.precision, compiled.features), dim=WAVELENGTHS_NM.size,
        inputs=[compiled.data, wavelengths_nm], outputs=[eta], device="cpu",
    )  # fmt: skip
    return eta.numpy().astype(np.float64)


def five_media(ambient):
    media = ["N-BK7", "water", CAUCHY, TABLE, CONSTANT]
    return scene_of(*(ball(2.0 * i, medium) for i, medium in enumerate(media)), ambient=ambient)


AS_STATED = [
    glass("N-BK7").eta(WAVELENGTHS_NM),  # relative to air
    glass("water").eta(WAVELENGTHS_NM),  # relative to vacuum
    CAUCHY.resolved().eta(WAVELENGTHS_NM),  # relative to vacuum
    TABLE.resolved().eta(WAVELENGTHS_NM),  # relative to air
    CONSTANT.resolved().eta(WAVELENGTHS_NM),  # relative to air
]
AIR = air_index(WAVELENGTHS_NM)
IN_AIR = [1.0, 1.0 / AIR, 1.0 / AIR, 1.0, 1.0]
IN_VACUUM = [AIR, 1.0, 1.0, AIR, AIR]
DENSE = scenes.ConstantMedium(eta=1.2, relative_to="vacuum")


@pytest.mark.parametrize(
    ("ambient", "factors", "outside"),
    [
        ("reference", [1.0] * 5, 1.0),
        ("air", IN_AIR, 1.0),
        ("vacuum", IN_VACUUM, 1.0),
        ("CaF2", IN_AIR, glass("CaF2").eta(WAVELENGTHS_NM)),
        (DENSE, IN_VACUUM, 1.2),
    ],
    ids=["reference", "air", "vacuum", "CaF2", "described"],
)
def test_indices_are_brought_to_the_reference_of_the_ambient_medium(ambient, factors, outside):
    eta = device_indices(compile_scene(five_media(ambient)))
    expected = [outside, *(n * f for n, f in zip(AS_STATED, factors, strict=True))]
    # The device's rounding and NumPy's: some ulps of a number below 2.
    for medium, values in enumerate(expected):
        np.testing.assert_allclose(eta[:, medium], values, rtol=6 * np.finfo(np.float64).eps)


def test_indices_in_single_precision():
    eta = device_indices(compile_scene(five_media("air"), precision="float32"))
    expected = np.column_stack([n * f for n, f in zip(AS_STATED, IN_AIR, strict=True)])
    np.testing.assert_allclose(eta[:, 1:], expected, rtol=6 * np.finfo(np.float32).eps)


def test_a_medium_that_is_used_twice_is_kept_once():
    scene = scene_of(ball(0.0, "F2"), ball(2.0, "SF11"), ball(4.0, "F2"), ball(6.0, CONSTANT))
    compiled = compile_scene(scene)
    assert [medium.name for medium in compiled.media] == [
        "reference", "F2", "SF11", "medium described in the scene",
    ]  # fmt: skip
    assert compiled.data.bodies.numpy()["medium_inside"].tolist() == [1, 2, 1, 3]


@pytest.mark.parametrize(
    ("medium", "ambient", "disperses"),
    [
        ("F2", "reference", True),
        (CONSTANT, "reference", False),
        (CONSTANT, "air", False),
        (CONSTANT, "vacuum", True),  # n · n_air(λ)
        (CONSTANT, "water", True),
        (DENSE, "air", True),  # n / n_air(λ)
        (DENSE, "vacuum", False),
        (DENSE, scenes.ConstantMedium(eta=1.3, relative_to="vacuum"), False),
        (DENSE, scenes.ConstantMedium(eta=1.3, relative_to="air"), True),
    ],
)
def test_a_boundary_disperses_where_its_relative_index_depends_on_the_wavelength(
    medium, ambient, disperses
):
    compiled = compile_scene(scene_of(ball(0.0, medium), ambient=ambient))
    assert compiled.data.bodies.numpy()["dispersive"].tolist() == [int(disperses)]


def test_sensors_count_where_light_must_reach_them():
    place = scenes.Rectangle(position=(3000.0, 4.0, 0.0), size=(6.0, 8.0))
    sensor = scenes.RaySensor(shape=place)
    alone = compile_scene(scenes.Scene(sensors=(sensor,)))
    np.testing.assert_array_equal(alone.origin, place.position)
    assert alone.bounding_radius == pytest.approx(5.0)
    ball = scenes.SceneObject(
        shape=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=1.0), material=scenes.Absorber()
    )
    both = compile_scene(scenes.Scene(objects=(ball,), sensors=(sensor,)))
    np.testing.assert_array_equal(both.origin, 0.0)
    assert both.bounding_radius == pytest.approx(math.hypot(3000.0, 4.0) + 5.0)
    # What touches what is a matter of the objects alone.
    assert bounding_radius(both.scene, both.origin) == 1.0
