"""The slope that theory expects of bins, and the dimensions that it goes by."""

import numpy as np
import pytest
from scipy.stats import qmc

import scenes
from sim.study.expected_slope import expected_slope, sampled_dimensions
from sim.study.statistics import fit_power_law

FILM = scenes.Film(width=4, height=4)
PLACE = (0.0, 1.0, 0.0)
DOWN = (0.0, -1.0, 0.0)


@pytest.mark.parametrize("dimensions", [2, 3, 5])
def test_scrambled_points_err_as_theory_says(dimensions):
    # Half of the cube, cut by a plane askew to all axes, so that each of them counts. Exactly
    # half by symmetry: the plane goes through the middle.
    normal = np.sqrt(np.arange(2.0, 2.0 + dimensions))
    sizes, errors = [], []
    for power in range(7, 14):
        for replicate in range(64):
            points = qmc.Sobol(dimensions, rng=replicate).random_base2(power)
            inside = (points - 0.5) @ normal < 0.0
            sizes.append(2.0**power)
            errors.append(abs(inside.mean() - 0.5))
    squares = np.square(errors).reshape(-1, 64).mean(axis=1)
    law = fit_power_law(sizes[::64], np.sqrt(squares))
    # Each mean of 64 squares is good to √(2/64) = 18 %, half of it as an error; over ln 64 and 7
    # points the slope is good to 0.09 / (0.69 √28) = 0.025.
    assert law.slope.value == pytest.approx(expected_slope(dimensions), abs=3 * 0.025)


def make_scene(lamp, medium="SF11"):
    ball = scenes.SceneObject(
        name="ball", shape=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.1),
        material=scenes.Dielectric(medium=medium),
    )
    return scenes.Scene(objects=(ball,), emitters=(lamp,), film=FILM)


def lamp(kind, *, spectrum="D65", **fields):
    return kind(name="lamp", flux=1.0, spectrum=spectrum, position=PLACE, **fields)


ROUND = {"direction": DOWN, "profile": scenes.RoundProfile(radius=0.01)}
LASER = {"type": "laser", "wavelength_nm": 550.0}


@pytest.mark.parametrize(
    ("source", "medium", "dimensions"),
    [
        # direction + place + wavelength
        (lamp(scenes.Point), "SF11", 2 + 0 + 1),
        (lamp(scenes.Spot, direction=DOWN, half_angle_deg=10.0), "SF11", 2 + 0 + 1),
        (lamp(scenes.SphereLamp, radius=0.1), "SF11", 2 + 2 + 1),
        (lamp(scenes.RectangleLamp, size=(0.1, 0.1), normal=DOWN), "SF11", 2 + 2 + 1),
        (lamp(scenes.Beam, **ROUND), "SF11", 0 + 2 + 1),
        (lamp(scenes.Beam, **ROUND, divergence_deg=0.1), "SF11", 2 + 2 + 1),
        (lamp(scenes.Point, spectrum=LASER), "SF11", 2),
        (lamp(scenes.Point, spectrum="mercury"), "SF11", 2),
        (lamp(scenes.Point), scenes.ConstantMedium(eta=1.5), 2),
    ],
)
def test_dimensions_are_what_the_landing_depends_on(source, medium, dimensions):
    assert sampled_dimensions(make_scene(source, medium), "lamp") == dimensions
