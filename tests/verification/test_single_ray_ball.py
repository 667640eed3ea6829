"""Single rays through balls: the ball lens, and the rainbows of a drop."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import scenes
from sim import trace_ray
from sim.device import start_device
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays
from spectra import glass, glasses

REFERENCES = json.loads((Path(__file__).parents[1] / "references.json").read_text(encoding="utf-8"))
D_NM = REFERENCES["lines_nm"]["d"]
EPS = float(np.finfo(np.float64).eps)


def printed(value, decimals):
    """Equal to the digits printed: within half a unit of the last."""
    return pytest.approx(value, abs=0.5 * 10.0**-decimals)


def ball(medium, radius=1.0):
    shape = scenes.Sphere(position=(0.0, 0.0, 0.0), radius=radius)
    material = scenes.Dielectric(medium=medium)
    return scenes.Scene(objects=[scenes.SceneObject(name="ball", shape=shape, material=material)])


def through(scene, misses, wavelength_nm=D_NM, branches=()):
    """Paths of rays along x that would pass the centre of a unit ball at these distances."""
    start_device("cpu")
    misses = np.atleast_1d(misses)
    origins = np.column_stack([np.full(len(misses), -2.0), misses, np.zeros(len(misses))])
    ways = np.tile([1.0, 0.0, 0.0], (len(misses), 1))
    return trace_compiled_rays(
        compile_scene(scene), origins, ways, np.full(len(misses), wavelength_nm),
        max_interactions=8, branches=branches,
    )  # fmt: skip


def test_focus_of_a_ball_lens():
    expected = REFERENCES["N-BK7"]["ball_lens_diameter_10mm"]
    height = 1e-8  # third-order aberration is of relative size (h/R)² = 4e-12
    path = trace_ray(ball("N-BK7", 0.005), (-0.02, height, 0.0), (1.0, 0.0, 0.0), D_NM)
    slope = path.directions[-1][1] / path.directions[-1][0]
    effective = -height / slope
    back = path.points[2][0] - path.points[2][1] / slope - 0.005
    assert 1000.0 * effective == printed(expected["EFL_mm"], 8)
    assert 1000.0 * back == printed(expected["BFL_mm"], 8)


@pytest.mark.parametrize("name", glasses())
def test_a_ball_deviates_by_twice_the_refraction(name):
    # δ = 2 (θᵢ − θₜ), with sinθᵢ the distance from the centre over the radius.
    misses = np.concatenate([np.linspace(-0.99, 0.99, 45), [1e-9, 1.0 - 1e-6]])
    for wavelength_nm in (400.0, 550.0, 700.0):
        paths = through(ball(name), misses, wavelength_nm)
        eta = glass(name).eta(wavelength_nm)
        theta_i, theta_t = np.arcsin(misses), np.arcsin(misses / eta)
        assert {path.events for path in paths} == {("refract", "refract", "escape")}
        deviations = np.array([path.deviation for path in paths])
        # The point of entry rounds by ε along the ray and so the normal there by ε/cosθᵢ.
        error = np.abs(deviations - np.abs(2.0 * (theta_i - theta_t)))
        assert np.all(error <= 16.0 * EPS / np.cos(theta_i))
        assert np.degrees(error.max()) < 1e-7


@pytest.mark.parametrize(
    ("reflections", "bow_deg"),
    [
        (1, REFERENCES["rainbow_primary_water_d_deg"]["value"]),
        # The secondary bow, from D = 2π + 2θᵢ − 6θₜ, least at cos²θᵢ = (η² − 1)/8, seen at D − π.
        (2, None),
    ],
)
def test_rainbows_of_a_drop(reflections, bow_deg):
    # Descartes: the bow stands where the deviation D = kπ + 2θᵢ − 2 (k + 1) θₜ is least, which is
    # at cos²θᵢ = (η² − 1)/(k (k + 2)) (Born & Wolf 1999, §4.7, and its reference to Airy).
    k, eta = reflections, glass("water").n_d
    theta_i = math.acos(math.sqrt((eta * eta - 1.0) / (k * (k + 2.0))))
    theta_t = math.asin(math.sin(theta_i) / eta)
    least = k * math.pi + 2.0 * theta_i - 2.0 * (k + 1) * theta_t
    branches = ("refract", *("reflect",) * k)
    misses = math.sin(theta_i) + np.linspace(-1e-2, 1e-2, 2001)
    paths = through(ball("water"), misses, branches=branches)
    assert {path.events for path in paths} == {(*branches, "refract", "escape")}
    turned = np.array([path.deviation for path in paths])
    # The path tells the angle between first and last direction, 0 to π.
    deviations = turned if k == 1 else 2.0 * math.pi - turned
    assert deviations.min() == pytest.approx(least, abs=16.0 * EPS)
    assert 980 < np.argmin(deviations) < 1020
    if bow_deg is not None:
        assert math.degrees(math.pi - deviations.min()) == printed(bow_deg, 6)
    else:
        assert 50.0 < math.degrees(deviations.min() - math.pi) < 51.5


def test_the_rainbow_is_red_outside():
    def bow(wavelength_nm):
        paths = through(
            ball("water"), np.linspace(0.8, 0.9, 401), wavelength_nm, ("refract", "reflect")
        )
        return math.degrees(math.pi - min(path.deviation for path in paths))

    # 42.4° and 40.5°, the numbers of the textbooks for red and violet.
    assert bow(700.0) == pytest.approx(42.4, abs=0.15)
    assert bow(400.0) == pytest.approx(40.6, abs=0.15)


def test_a_ball_of_the_medium_around_it_is_not_there():
    scene = scenes.Scene(objects=ball("water").objects, ambient="water")
    for path in through(scene, [0.0, 0.5, 0.999]):
        assert path.events == ("pass", "pass", "escape")
        assert path.deviation == 0.0
        assert path.transmittance == 1.0


@pytest.mark.parametrize(("ambient", "name"), [("water", "N-BK7"), ("SF11", "CaF2")])
def test_the_relative_index_counts(ambient, name):
    # Both brought to vacuum: N-BK7, SF11 and CaF2 are measured in air, water in vacuum.
    from spectra import air_index

    def absolute(medium):
        factor = air_index(550.0) if medium.relative_to == "air" else 1.0
        return medium.eta(550.0) * factor

    eta = absolute(glass(name)) / absolute(glass(ambient))
    scene = scenes.Scene(objects=ball(name).objects, ambient=ambient)
    miss = 0.5
    (path,) = through(scene, miss, 550.0)
    expected = 2.0 * (math.asin(miss) - math.asin(miss / eta))
    assert path.deviation == pytest.approx(abs(expected), abs=16.0 * EPS)
