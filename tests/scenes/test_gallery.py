"""The gallery's scenes: they load, they can be rendered, and their comments tell the truth."""

import math

import numpy as np
import numpy.typing as npt
import pytest

import scenes
from scenes import Beam, Lens, Prism, Rectangle, Scene, Sphere, SphereLamp
from spectra import glass

FloatArray = npt.NDArray[np.float64]


@pytest.mark.parametrize("name", scenes.gallery())
def test_it_loads_and_can_be_rendered(name: str) -> None:
    scene = scenes.load(name)
    scene.require_renderable()
    assert scene.title
    assert scene.description


@pytest.mark.parametrize("name", scenes.gallery())
def test_writing_and_reading_it_gives_the_same_scene(name: str) -> None:
    scene = scenes.load(name)
    assert scenes.loads(scene.to_toml()).model_dump() == scene.model_dump()


def test_the_prism_stands_at_minimum_deviation_for_550_nm() -> None:
    prism, screen, slit = prism_bench()
    # Minimum deviation (Born & Wolf 1999, §4.7.2): sin i = n sin(A/2), δ = 2i - A.
    half_apex = math.radians(prism.apex_deg / 2.0)
    incidence = math.asin(glass("SF11").eta(550.0) * math.sin(half_apex))
    deviation = 2.0 * (incidence - half_apex)
    # The prism's turn is written to 1e-6 degrees.
    assert prism.rotation_deg[1] == pytest.approx(math.degrees(deviation) / 2.0, abs=1e-6)
    normals, _ = prism.faces()
    assert any(
        math.acos(-normal @ np.array(slit.direction)) == pytest.approx(incidence, abs=1e-7)
        for normal in normals
    )
    leaving = np.array([math.cos(deviation), 0.0, -math.sin(deviation)])
    # Normals of the screen are written to 1e-6, its place to 1 µm.
    np.testing.assert_allclose(screen.normal, -leaving, atol=2e-6)
    along = np.array([math.cos(deviation / 2.0), 0.0, -math.sin(deviation / 2.0)])
    centre = np.array([0.0, slit.position[1], 0.0])
    exit_point = centre + 0.015 * along
    distance = (np.array(screen.position) - exit_point) @ leaving
    assert distance == pytest.approx(0.4, abs=2e-6)
    enters = centre - 0.015 * along
    assert slit.position[2] == pytest.approx(enters[2], abs=1e-6)


def prism_bench() -> tuple[Prism, Rectangle, Beam]:
    scene = scenes.load("prism")
    prism, screen, slit = scene.objects[0].shape, scene.objects[1].shape, scene.emitters[0]
    assert isinstance(prism, Prism)
    assert isinstance(screen, Rectangle)
    assert isinstance(slit, Beam)
    return prism, screen, slit


def test_the_lens_forms_its_image_where_it_says() -> None:
    lens, floor, lamp = lens_bench()
    n, t = glass("N-BK7").n_d, lens.thickness
    c1, c2 = lens.first.curvature, lens.second.curvature
    # Lensmaker's equation (Hecht 2017, §6.1): 1/f = (n - 1)(c1 - c2 + (n - 1) t c1 c2 / n); the
    # second principal plane lies f (n - 1) t c1 / n before the second vertex, and the first, by
    # symmetry, as far behind the first.
    focal_length = 1.0 / ((n - 1.0) * (c1 - c2 + (n - 1.0) * t * c1 * c2 / n))
    inside = focal_length * (n - 1.0) * t * c1 / n
    assert c2 == -c1
    # The scene file states lengths to 0.01 mm.
    assert focal_length == pytest.approx(60.45e-3, abs=5e-6)
    assert inside == pytest.approx(4.81e-3, abs=5e-6)
    centre, axis = np.array(lens.position), np.array(lens.axis)
    to_lamp = np.array(lamp.position) - centre
    np.testing.assert_allclose(np.cross(to_lamp, axis), 0.0, atol=1e-12)
    distance = -to_lamp @ axis
    assert distance == pytest.approx(494.97e-3, abs=5e-6)
    # Gauss: 1/s + 1/s' = 1/f, from the principal planes.
    before = distance - 0.5 * t + inside
    behind = 1.0 / (1.0 / focal_length - 1.0 / before)
    assert before == pytest.approx(492.78e-3, abs=5e-6)
    assert behind == pytest.approx(68.91e-3, abs=5e-6)
    image = behind - inside + 0.5 * t
    assert image == pytest.approx(71.10e-3, abs=5e-6)
    to_floor = (floor.position[1] - centre[1]) / axis[1]
    assert to_floor == pytest.approx(67.88e-3, abs=5e-6)
    assert rim_crossing(lens, distance, n) < to_floor < image


def lens_bench() -> tuple[Lens, Rectangle, SphereLamp]:
    scene = scenes.load("lens")
    lens, floor, lamp = shape_of(scene, "lens"), shape_of(scene, "floor"), scene.emitters[0]
    assert isinstance(lens, Lens)
    assert isinstance(floor, Rectangle)
    assert isinstance(lamp, SphereLamp)
    return lens, floor, lamp


def rim_crossing(lens: Lens, lamp_distance: float, n: float) -> float:
    """Where the ray that enters 24.8 mm from the axis crosses it, from the lens's middle [m].

    In the meridional plane, (along the axis, from the axis), by Snell's law in vector form (Born
    & Wolf 1999, §3.2.2).
    """
    radius, height = lens.first.radius, 24.8e-3
    assert radius is not None
    centres = (radius - 0.5 * lens.thickness, 0.5 * lens.thickness - radius)
    point = np.array([centres[0] - math.sqrt(radius**2 - height**2), height])
    arriving = unit(np.array([point[0] + lamp_distance, point[1]]))
    direction = refract(arriving, [centres[0], 0.0] - point, 1.0 / n)
    offset = point - [centres[1], 0.0]
    along = offset @ direction
    point = point + direction * (math.sqrt(along**2 - offset @ offset + radius**2) - along)
    direction = refract(direction, point - [centres[1], 0.0], n)
    crossing = point[0] - point[1] * direction[0] / direction[1]
    assert crossing == pytest.approx(49.7e-3, abs=1e-4)
    return float(crossing)


def unit(vector: FloatArray) -> FloatArray:
    return vector / np.linalg.norm(vector)


def refract(direction: FloatArray, ahead: FloatArray, eta: float) -> FloatArray:
    """Snell's law; `ahead` is along the normal, to the far side; `eta` is n before over behind."""
    normal = unit(ahead)
    tangential = eta * (direction - (direction @ normal) * normal)
    return tangential + math.sqrt(1.0 - tangential @ tangential) * normal


def test_the_ball_is_where_it_should_be() -> None:
    scene = scenes.load("ball")
    ball = shape_of(scene, "ball")
    floor = shape_of(scene, "floor")
    lamp = scene.emitters[0]
    assert isinstance(ball, Sphere)
    assert isinstance(floor, Rectangle)
    assert isinstance(lamp, SphereLamp)
    assert (ball.position, ball.radius) == ((0.0, 1.0, 0.0), 0.8)
    assert (floor.position, floor.size) == ((0.0, 0.0, 0.0), (8.0, 8.0))
    assert (lamp.position, lamp.radius) == ((-3.0, 4.0, 0.0), 0.15)
    assert scene.film.width == scene.film.height


def shape_of(scene: Scene, name: str) -> object:
    return next(one.shape for one in scene.objects if one.name == name)


def test_the_pane_is_seen_at_brewsters_angle() -> None:
    scene = scenes.load("brewster")
    camera = scene.camera
    assert camera is not None
    sight = unit(np.array([0.0, 0.030, 0.0]) - camera.position)  # to the middle of the pane's top
    # tan θ_B = n (Born & Wolf 1999, §1.5.3); positions are written to 1 µm, 1.2 m away.
    assert math.tan(math.acos(-sight[1])) == pytest.approx(1.5, abs=1e-5)
    for name, passes in (("left filter", np.cross(sight, [1.0, 0.0, 0.0])), ("right filter", None)):
        sheet = next(one for one in scene.objects if one.name == name)
        assert isinstance(sheet.shape, Rectangle)
        assert isinstance(sheet.material, scenes.Polariser)
        np.testing.assert_allclose(sheet.shape.normal, -sight, atol=2e-6)
        along = np.array(sheet.material.axis)
        expected = np.array([1.0, 0.0, 0.0]) if passes is None else passes
        assert abs(float(along @ expected)) == pytest.approx(1.0, abs=1e-9)
        distance = (np.array(sheet.shape.position) - camera.position) @ sight
        assert distance == pytest.approx(0.45, abs=2e-6)


def test_the_pools_crests_reach_the_floor_where_they_meet() -> None:
    water = shape_of(scenes.load("pool"), "water")
    assert isinstance(water, scenes.HeightField)
    assert water.waves is not None
    assert water.depth is not None
    # f = n/(n - 1) R with the curvature 1/R = 4π² A/P² of a crest, and the sum of them all.
    n = glass("water").eta(550.0)
    powers = [
        (n - 1.0) / n * 4.0 * math.pi**2 * wave.amplitude / wave.period**2 for wave in water.waves
    ]
    assert 1.0 / powers[0] == pytest.approx(8.2, abs=0.1)
    assert 1.0 / powers[-1] == pytest.approx(2.9, abs=0.1)
    assert 1.0 / sum(powers) < water.depth


def test_the_pools_colours_would_part_by_less_than_half_a_pixel() -> None:
    scene = scenes.load("pool")
    water = next(one for one in scene.objects if one.name == "water")
    assert isinstance(water.material, scenes.Dielectric)
    assert isinstance(water.shape, scenes.HeightField)
    sun = next(one for one in scene.emitters if isinstance(one, scenes.Sun))
    assert water.shape.depth is not None
    assert scene.camera is not None
    n = glass("water")
    assert water.material.resolved().eta(550.0) == pytest.approx(n.eta(550.0), abs=5e-6)
    incidence = math.acos(-sun.direction[1])
    assert math.degrees(incidence) == pytest.approx(30.0, abs=0.1)
    # Under calm water a ray comes d tan t from where it entered, sin i = n sin t (Snell).
    blue, red = (
        water.shape.depth * math.tan(math.asin(math.sin(incidence) / n.eta(wavelength_nm)))
        for wavelength_nm in (450.0, 650.0)
    )
    assert red - blue == pytest.approx(3.3e-3, abs=5e-5)
    # A pixel in the picture's middle, were there no water: that makes the floor seem nearer by
    # less than the depth's n-th part, a tenth of the way.
    distance = math.dist(scene.camera.position, scene.camera.look_at)
    pixel = 2.0 * distance * math.tan(0.5 * math.radians(scene.camera.fov_deg)) / scene.film.height
    assert red - blue < 0.5 * pixel
