"""The gallery's scenes: they load, they can be rendered, and their comments tell the truth."""

import math

import numpy as np
import pytest

import scenes
from scenes import Beam, Lens, Prism, Rectangle, Scene, Sphere, SphereLamp
from spectra import glass


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


def test_the_lens_has_the_focal_length_it_says() -> None:
    lens = shape_of(scenes.load("lens"), "lens")
    assert isinstance(lens, Lens)
    n, t = glass("N-BK7").n_d, lens.thickness
    c1, c2 = lens.first.curvature, lens.second.curvature
    # Lensmaker's equation (Hecht 2017, §6.1): 1/f = (n - 1)(c1 - c2 + (n - 1) t c1 c2 / n).
    power = (n - 1.0) * (c1 - c2 + (n - 1.0) * t * c1 * c2 / n)
    assert 1.0 / power == pytest.approx(0.1004, abs=5e-5)


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
