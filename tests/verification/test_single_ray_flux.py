"""Single rays at plates: what is reflected, what is let through, and where it goes."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import scenes
from sim import analytic, trace_ray
from sim.device import start_device
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays
from spectra import glass

REFERENCES = json.loads((Path(__file__).parents[1] / "references.json").read_text(encoding="utf-8"))
BK7 = REFERENCES["N-BK7"]
D_NM = REFERENCES["lines_nm"]["d"]
EPS = float(np.finfo(np.float64).eps)


def printed(value, decimals):
    """Equal to the digits printed: within half a unit of the last."""
    return pytest.approx(value, abs=0.5 * 10.0**-decimals)


def plate(medium):
    """10 mm thick, between y = −5 mm and 5 mm; wide enough for every angle here."""
    shape = scenes.Box(position=(0.0, 0.0, 0.0), size=(4.0, 0.01, 4.0))
    material = scenes.Dielectric(medium=medium)
    return scenes.Scene(objects=[scenes.SceneObject(name="plate", shape=shape, material=material)])


BK7_PLATE = plate("N-BK7")
PLATE_1_5 = plate(scenes.ConstantMedium(eta=1.5))


def downward(theta_i):
    """Direction that meets a horizontal face at an angle to its normal."""
    return np.array([math.sin(theta_i), -math.cos(theta_i), 0.0])


def onto_plate(scene, theta_i, **options):
    """From outside, to the middle of the upper face."""
    way = downward(theta_i)
    return trace_ray(scene, np.array([0.0, 0.005, 0.0]) - 0.01 * way, way, D_NM, **options)


def from_inside(scene, theta_i, **options):
    return trace_ray(scene, (0.0, 0.0, 0.0), downward(theta_i), D_NM, **options)


def test_lateral_shift_of_a_plate():
    path = onto_plate(BK7_PLATE, math.radians(45.0))
    assert path.events == ("refract", "refract", "escape")
    to_the_side = np.array([math.cos(math.radians(45.0)), math.sin(math.radians(45.0)), 0.0])
    millimetres = -1000.0 * float((path.points[2] - path.points[0]) @ to_the_side)
    assert millimetres == printed(BK7["plate_10mm_45deg_lateral_shift_mm"], 8)
    assert path.deviation < 8.0 * EPS


def test_the_critical_angle_is_where_refraction_ends():
    degrees = BK7["critical_angle_d_deg"]
    below, beyond = (from_inside(BK7_PLATE, math.radians(degrees + s)) for s in (-1e-7, 1e-7))
    assert below.events[0] == "refract"
    assert beyond.events[0] == "total internal reflection"
    # The refracted ray runs along the face: cosθₜ = √(2 tanθ_c δ) for a step δ below.
    assert 0.0 < -below.directions[1][1] < math.sqrt(4.0 * math.radians(1e-7))
    assert below.reflectances[0] > 0.999
    assert beyond.reflectances[0] == 1.0


def test_brewster_light_parts_at_a_right_angle():
    theta_b = math.radians(BK7["brewster_d_deg"])
    refracted = onto_plate(BK7_PLATE, theta_b).directions[1]
    reflected = onto_plate(BK7_PLATE, theta_b, branches=("reflect",)).directions[1]
    # Half a unit of the angle's last digit turns the two by less than twice that.
    assert math.degrees(float(refracted @ reflected)) == pytest.approx(0.0, abs=1e-7)
    # R_p is 0, and R_s = ((η² − 1)/(η² + 1))² (Born & Wolf 1999, §1.5.3): half of it is told. Half
    # a unit of the angle is 1e-9 rad, and R_s has a slope below 1.
    eta2 = glass("N-BK7").n_d ** 2
    expected = 0.5 * ((eta2 - 1.0) / (eta2 + 1.0)) ** 2
    assert onto_plate(BK7_PLATE, theta_b).reflectances[0] == pytest.approx(expected, abs=1e-9)


def test_reflectance_at_normal_incidence():
    path = onto_plate(BK7_PLATE, 0.0)
    assert path.reflectances[0] == printed(BK7["normal_reflectance_d"], 9)
    assert path.reflectances[0] == pytest.approx(path.reflectances[1], rel=8.0 * EPS)


@pytest.mark.parametrize("degrees", ["45", "60", "80"])
def test_published_reflectances(degrees):
    expected = REFERENCES["fresnel_n_1.5"][degrees]
    path = onto_plate(PLATE_1_5, math.radians(float(degrees)))
    # The mean of two numbers that are printed to nine decimals.
    assert path.reflectances[0] == printed(0.5 * (expected["Rs"] + expected["Rp"]), 9)


def test_reflectances_along_the_path_are_fresnels():
    angles = np.radians(np.linspace(0.0, 89.9, 400))
    start_device("cpu")
    ways = np.array([downward(angle) for angle in angles])
    origins = np.array([0.0, 0.005, 0.0]) - 0.01 * ways
    compiled = compile_scene(BK7_PLATE)
    paths = trace_compiled_rays(compiled, origins, ways, np.full(400, D_NM), max_interactions=4)
    r_s, r_p = analytic.fresnel_reflectance(np.cos(angles), 1.0, glass("N-BK7").n_d)
    # Both faces of a plate reflect alike, but what enters is more p than s: 1 − R of either.
    entered = 2.0 - r_s - r_p
    second = ((1.0 - r_s) * r_s + (1.0 - r_p) * r_p) / entered
    for face, expected in enumerate((0.5 * (r_s + r_p), second)):
        ours = np.array([path.reflectances[face] for path in paths])
        # The angle at which the ray leaves rounds by ε/cosθ, and R has a slope of up to some 10.
        error = np.abs(ours - expected)
        assert np.all(error <= 32.0 * EPS / np.cos(angles))


@pytest.mark.parametrize(
    ("trace", "key"),
    [(onto_plate, "diffuse_average_external"), (from_inside, "diffuse_average_internal")],
)
def test_reflectance_of_diffuse_light(trace, key):
    # ∫ R d(sin²θ) by Gauss–Legendre; the ends are square roots at grazing and critical angles,
    # which s = a + (b − a)(3t² − 2t³) flattens.
    nodes, weights = np.polynomial.legendre.leggauss(60)
    t = 0.5 * (nodes + 1.0)
    critical = 1.0 if trace is onto_plate else 1.0 / 1.5**2
    sin2 = critical * t * t * (3.0 - 2.0 * t)
    d_sin2 = critical * 6.0 * t * (1.0 - t) * 0.5 * weights
    reflectances = [trace(PLATE_1_5, math.asin(math.sqrt(s))).reflectances[0] for s in sin2]
    average = float(np.dot(reflectances, d_sin2)) + 1.0 - critical
    assert average == printed(REFERENCES["fresnel_n_1.5"][key], 9)


def test_all_internal_reflections_of_a_slab_add_up():
    # Straight on, s and p are alike: T = Σ (1 − R)² R²ᵏ, and R + T = 1.
    transmitted = reflected = 0.0
    for k in range(7):
        inside = ("reflect",) * (2 * k)
        out = onto_plate(PLATE_1_5, 0.0, branches=("refract", *inside))
        back = onto_plate(PLATE_1_5, 0.0, branches=("refract", "reflect", *inside))
        assert out.directions[-1][1] == -1.0
        assert back.directions[-1][1] == 1.0
        transmitted += out.transmittance
        reflected += back.transmittance
    reflected += onto_plate(PLATE_1_5, 0.0, branches=("reflect",)).transmittance
    # What is left after seven round trips is 0.04¹⁴.
    expected = REFERENCES["slab_n_1.5_all_internal_reflections"]["alpha_d_0"]["T"]
    assert transmitted == printed(expected, 9)
    assert transmitted + reflected == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 56.0, 75.0, 89.0])
def test_the_branches_of_a_split_share_the_light(degrees):
    # Every path of up to three boundaries, and what is left inside after them.
    theta_i = math.radians(degrees)
    shares = [onto_plate(BK7_PLATE, theta_i, branches=("reflect",)).transmittance]
    shares += [
        onto_plate(BK7_PLATE, theta_i, branches=("refract", *("reflect",) * k)).transmittance
        for k in range(3)
    ]
    trapped = onto_plate(
        BK7_PLATE, theta_i, branches=("refract", *("reflect",) * 3), max_interactions=4
    )
    assert trapped.events[-1] == "limit"
    left_inside = float(np.prod(trapped.reflectances[1:])) * (1.0 - trapped.reflectances[0])
    assert sum(shares) + left_inside == pytest.approx(1.0, abs=16.0 * EPS)
