"""What the comments of the gallery's scenes say of angles, shapes and materials."""

import math

import numpy as np
import pytest

import scenes
from scenes import Box, Dielectric, Lens, Polyhedron, Prism, Scene, Sphere
from spectra import glass

PAPER = ("paper-reflective", "paper-refractive", "paper-transparent", "paper-absorptive")


def shape_of(scene: Scene, name: str) -> object:
    return next(one.shape for one in scene.objects if one.name == name)


@pytest.mark.parametrize(("reflections", "red_deg", "blue_deg"), [(1, 42.3, 41.1), (2, 50.5, 52.6)])
def test_the_bows_are_at_descartes_angles(
    reflections: int, red_deg: float, blue_deg: float
) -> None:
    drop = shape_of(scenes.load("rainbow"), "drop")
    assert isinstance(drop, Sphere)
    for wavelength_nm, stated in ((650.0, red_deg), (450.0, blue_deg)):
        n, k = float(glass("water").eta(wavelength_nm)), reflections
        incidence = np.radians(np.linspace(0.0, 90.0, 90_001))
        inside = np.arcsin(np.sin(incidence) / n)
        deviation = 2.0 * (incidence - inside) + k * (math.pi - 2.0 * inside)
        least = deviation.min()
        closed = math.acos(math.sqrt((n * n - 1.0) / (k * (k + 2))))
        # The least deviation on a grid of 0.001°: the angle itself is known to half of that.
        assert math.degrees(incidence[deviation.argmin()]) == pytest.approx(
            math.degrees(closed), abs=6e-4
        )
        assert abs(180.0 - math.degrees(least)) == pytest.approx(stated, abs=0.051)


def test_the_brilliant_has_its_facets_and_lies_on_one() -> None:
    stone = shape_of(scenes.load("diamond"), "brilliant")
    assert isinstance(stone, Polyhedron)
    normals, _ = stone.local_faces()
    inclination = np.degrees(np.arccos(normals[:, 1]))
    girdle = np.abs(inclination - 90.0) < 1e-6
    assert girdle.sum() == 16
    assert len(normals) - girdle.sum() == 57
    assert np.sum(np.abs(inclination - 34.5) < 1e-5) == 8  # crown mains; corners to 1e-9 mm
    assert np.sum(np.abs(inclination - (180.0 - 40.75)) < 1e-5) == 8  # pavilion mains
    corners = stone.local_vertices()
    assert 2e3 * np.hypot(corners[:, 0], corners[:, 2]).max() == pytest.approx(6.5, abs=1e-6)
    turned, offsets = stone.faces()
    lowest = turned[np.argmin(turned[:, 1])]
    assert lowest == pytest.approx([0.0, -1.0, 0.0], abs=1e-9)
    above_table = stone.position[1] - offsets[np.argmin(turned[:, 1])]
    assert above_table == pytest.approx(0.02e-3, abs=1e-7)  # its place is written to 0.1 µm
    n = float(glass("diamond").eta(589.3))
    assert math.degrees(math.asin(1.0 / n)) == pytest.approx(24.4, abs=0.05)


def test_the_spectroscopes_prism_stands_at_minimum_deviation_for_the_green_line() -> None:
    scene = scenes.load("spectroscope")
    prism, camera_lens = shape_of(scene, "prism"), shape_of(scene, "camera lens")
    assert isinstance(prism, Prism)
    assert isinstance(camera_lens, Lens)
    n = float(glass("SF11").eta(546.0735))
    assert n == pytest.approx(1.791899, abs=1e-6)
    incidence = math.asin(0.5 * n)
    deviation = 2.0 * incidence - math.pi / 3.0
    assert math.degrees(incidence) == pytest.approx(63.630658, abs=1e-6)
    assert math.degrees(deviation) == pytest.approx(67.261315, abs=1e-6)
    assert prism.rotation_deg[1] == pytest.approx(math.degrees(deviation) / 2.0, abs=1e-6)
    leaving = (math.cos(deviation), 0.0, -math.sin(deviation))
    assert camera_lens.axis == pytest.approx(leaving, abs=1e-6)


def test_the_spectroscopes_block_rises_through_the_lower_part_of_the_light() -> None:
    block = shape_of(scenes.load("spectroscope"), "block")
    assert isinstance(block, Box)
    corners = 1e3 * block.vertices_world()
    along = corners[:, [0, 2]] @ (0.386529, -0.922277)  # from the prism to the screen
    top = corners[:, 1] > corners[:, 1].mean()
    first, last = top & (along < along.mean()), top & (along > along.mean())
    assert corners[first, 1] == pytest.approx(12.8, abs=0.05)
    assert corners[last, 1] == pytest.approx(15.8, abs=0.05)
    # Behind the camera lens, whose last vertex is 77 from the prism, and before the screen, 314.6.
    assert (along.min() > 77.0, along.max() < 314.6) == (True, True)
    assert 0.0 < corners[:, 1].min() < 1.0


def test_the_papers_four_pictures_differ_in_the_solids_material_alone() -> None:
    first, *others = [scenes.load(name) for name in PAPER]
    solids = ("ball", "prism", "column")
    for scene in others:
        assert (scene.film, scene.camera, scene.render) == (first.film, first.camera, first.render)
        assert scene.emitters == first.emitters
        for one, other in zip(scene.objects, first.objects, strict=True):
            assert (one.name, one.shape) == (other.name, other.shape)
            assert (one.material == other.material) == (one.name not in solids)


def test_nothing_comes_through_the_dark_glass() -> None:
    ball = next(one for one in scenes.load("paper-refractive").objects if one.name == "ball")
    assert isinstance(ball.material, Dielectric)
    absorption = ball.material.resolved().absorption
    assert absorption is not None
    # Through a millimetre, exp(-20).
    assert float(absorption.coefficient(550.0)) * 1e-3 == pytest.approx(20.0)


def test_the_tumblers_priorities_say_what_fills_it() -> None:
    scene = scenes.load("glass-of-water")
    solids = {
        one.name: one.material.priority
        for one in scene.objects
        if isinstance(one.material, Dielectric)
    }
    assert solids["tumbler"] < solids["air inside"] < solids["water"]


def test_the_plates_stand_at_brewsters_angle_and_pass_what_they_say() -> None:
    scene = scenes.load("plates")
    plates = [one for one in scene.objects if one.name.startswith("plate ")]
    assert len(plates) == 10
    n = float(plates[0].material.resolved().eta(550.0))  # type: ignore[union-attr]
    incidence = math.atan(n)
    assert math.degrees(incidence) == pytest.approx(56.6333, abs=5e-5)
    for one in plates:
        assert isinstance(one.shape, Box)
        # The beams run along +x; a plate's normal is its local z, turned about y.
        assert 90.0 - one.shape.rotation_deg[1] == pytest.approx(math.degrees(incidence), abs=1e-5)
    faces, across = 20, ((n * n - 1.0) / (n * n + 1.0)) ** 2
    passed = (1.0 - across) / (1.0 + (faces - 1) * across)
    assert (across, passed) == pytest.approx((0.1560, 0.2129), abs=5e-5)
    assert 0.5 * (1.0 + passed) == pytest.approx(0.6064, abs=5e-5)
    assert (1.0 - 0.5 * across) ** faces == pytest.approx(0.1970, abs=5e-5)
    assert (-math.cos(2.0 * incidence), -math.sin(2.0 * incidence)) == pytest.approx(
        (0.395010, -0.918677), abs=1e-6
    )


@pytest.mark.parametrize(
    ("height", "stated_mm", "stated"),
    [(0.0, 16.0, 0.202), (12.5, 12.46, 0.288), (25.0, 0.83, 0.92)],
)
def test_the_smoky_lens_is_dark_where_it_is_thick(
    height: float, stated_mm: float, stated: float
) -> None:
    # exp(-α d), d = t - 2 (R - √(R² - h²)) along the axis of a biconvex lens (Beer and Lambert).
    scene = scenes.load("smoky-lens")
    lens = scene.objects[0]
    assert isinstance(lens.shape, Lens)
    assert isinstance(lens.material, Dielectric)
    absorption = lens.material.absorption
    assert isinstance(absorption, scenes.NapierianAbsorption)
    assert lens.shape.first.curvature == -lens.shape.second.curvature
    radius, h = 1.0 / lens.shape.first.curvature, height * 1e-3
    length = lens.shape.thickness - 2.0 * (radius - math.sqrt(radius**2 - h**2))
    assert 1e3 * length == pytest.approx(stated_mm, abs=0.0051)
    assert math.exp(-float(absorption.coefficient) * length) == pytest.approx(stated, abs=5.1e-4)
