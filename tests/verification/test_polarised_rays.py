"""Single rays of polarised light, against closed forms: plates, rhombs, prisms, drops, sheets."""

import math

import numpy as np
import pytest

import scenes
from sim import analytic, trace_ray
from sim.analytic_polarisation import (
    boundary_matrices,
    degree_of_polarisation,
    fresnel_amplitudes,
    retarding_incidences,
)
from sim.errors import SettingsError
from sim.features import plan_features
from sim.settings import RenderSettings
from spectra import glass

EPS = float(np.finfo(np.float64).eps)
GLASS = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
BREWSTER = math.atan(1.5)
OF_S = scenes.Polarisation(up=(0.0, 0.0, 1.0))
OF_P = scenes.Polarisation(up=(0.0, 0.0, 1.0), angle_deg=90.0)
DIAGONAL = scenes.Polarisation(up=(0.0, 0.0, 1.0), angle_deg=45.0)


def scene_of(*pairs):
    return scenes.Scene(
        objects=[scenes.SceneObject(shape=shape, material=material) for shape, material in pairs]
    )


def plates(count, turns):
    """`count` plates across the x axis, one behind the other, each turned by `turns` [degrees]."""
    size = (0.001, 0.5, 0.5)
    return scene_of(*(
        (scenes.Box(position=(0.1 * k, 0.0, 0.0), size=size, rotation_deg=turns[k]), GLASS)
        for k in range(count)
    ))  # fmt: skip


def along_x(scene, **options):
    return trace_ray(scene, (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 550.0, **options)


TILT = (0.0, 0.0, math.degrees(BREWSTER))
TEN_PLATES = plates(10, [TILT] * 10)


def test_ten_brewster_plates():
    # R_p = 0 and R_s = ((n² − 1)/(n² + 1))² at each of twenty surfaces (Born & Wolf, §1.5.3).
    r_s = (1.25 / 3.25) ** 2
    of_s = (1.0 - r_s) ** 20
    tolerance = 20 * 16.0 * EPS
    path = along_x(TEN_PLATES)
    assert path.events == ("refract",) * 20 + ("escape",)
    assert path.transmittance == pytest.approx(0.5 * (1.0 + of_s), abs=tolerance)
    assert along_x(TEN_PLATES, polarisation=OF_S).transmittance == pytest.approx(of_s, rel=1e-13)
    assert along_x(TEN_PLATES, polarisation=OF_P).transmittance == pytest.approx(1.0, abs=tolerance)
    # What is left is p: along the frame's s is zero but of_s.
    degree = degree_of_polarisation(path.stokes[-1])
    assert degree == pytest.approx((1.0 - of_s) / (1.0 + of_s), abs=tolerance)
    # Averages at each surface would be wrong by more than a half: this is what Stokes is for.
    averages = (1.0 - 0.5 * r_s) ** 20
    assert averages < 0.45 * path.transmittance


def test_crossed_brewster_plates_let_half_of_each_other_through():
    # The second plate's planes of incidence are across the first one's: s there is p here, so
    # that either polarisation is weakened once, T = T_s² exactly, and none is left polarised.
    crossed = plates(2, [TILT, (0.0, math.degrees(BREWSTER), 0.0)])
    t_s = (1.0 - (1.25 / 3.25) ** 2) ** 2
    path = along_x(crossed)
    assert path.transmittance == pytest.approx(t_s, abs=64.0 * EPS)
    assert path.polarisations[-1] == pytest.approx(np.zeros(3), abs=64.0 * EPS)
    parallel = along_x(plates(2, [TILT, TILT]))
    assert parallel.transmittance == pytest.approx(0.5 * (1.0 + t_s * t_s), abs=64.0 * EPS)


def rhomb(eta):
    """A parallelogram in x–y whose faces totally reflect at the greater angle for 45°."""
    theta = float(retarding_incidences(math.pi / 4, eta)[1])
    # Light along +x meets the lower and upper faces, which run at the angle θ to the normal of x.
    slope = np.array([math.sin(theta), math.cos(theta)])  # along the two reflecting faces
    width = 0.02
    length = 2.0 * width * math.tan(theta)
    across = np.array([0.0, width])
    corners = [0.0 * slope, across, across + length * slope, length * slope]
    centre = np.mean(corners, axis=0)
    vertices = [
        (float(x), float(y), z) for x, y in np.array(corners) - centre for z in (-0.02, 0.02)
    ]
    shape = scenes.Polyhedron(position=(0.0, 0.0, 0.0), vertices=vertices)
    material = scenes.Dielectric(medium=scenes.ConstantMedium(eta=eta))
    return scene_of((shape, material)), theta, float(-centre[1])


def through_rhomb(eta, polarisation):
    scene, theta, low = rhomb(eta)
    path = trace_ray(scene, (-1.0, low + 0.012, 0.0), (1.0, 0.0, 0.0), 550.0,
                     polarisation=polarisation)  # fmt: skip
    total = "total internal reflection"
    assert path.events == ("refract", total, total, "refract", "escape")
    for k in (1, 2):  # the angle of incidence is what it should be
        cosine = abs(float(np.dot(path.directions[k] - path.directions[k + 1], path.directions[k])))
        assert cosine == pytest.approx(2.0 * math.cos(theta) ** 2, abs=1e-12)
    return path


@pytest.mark.parametrize("eta", [1.51, 1.6, 2.0])
def test_fresnels_rhomb_makes_circular_light(eta):
    # Twice 45° of phase between s and p (Born & Wolf 1999, §1.5.4): linear light at 45° becomes
    # right-handed, light at −45° left-handed; s and p light stay what they are.
    path = through_rhomb(eta, DIAGONAL)
    np.testing.assert_allclose(path.polarisations[-1], [0.0, 0.0, 1.0], atol=1e-12)
    other = scenes.Polarisation(up=(0.0, 0.0, 1.0), angle_deg=-45.0)
    np.testing.assert_allclose(
        through_rhomb(eta, other).polarisations[-1], [0.0, 0.0, -1.0], atol=1e-12
    )
    for light in (OF_S, OF_P):
        assert abs(through_rhomb(eta, light).polarisations[-1][2]) < 1e-12


@pytest.mark.parametrize("medium", ["N-BK7", "SF11"])
def test_a_prism_lets_s_and_p_through_by_their_own(medium):
    eta = glass(medium).n_d
    wavelength_nm = 587.5618
    apex = math.radians(60.0)
    theta_i = float(analytic.prism_incidence_at_minimum_deviation(apex, eta))
    prism = scene_of((
        scenes.Prism(position=(0.0, 0.0, 0.0), apex_deg=60.0, base=0.05, length=0.05),
        scenes.Dielectric(medium=medium),
    ))  # fmt: skip
    # From the left face's middle back along the ray; the face's normal is 150° from +x.
    face = np.array([-0.0125, 0.0, 0.0])
    turn = math.radians(150.0) - theta_i + math.pi
    way = np.array([math.cos(turn), math.sin(turn), 0.0])
    inside = math.asin(math.sin(theta_i) / eta)
    of_s, of_p = (
        (1.0 - float(a)) * (1.0 - float(b))
        for a, b in zip(
            analytic.fresnel_reflectance(math.cos(theta_i), 1.0, eta),
            analytic.fresnel_reflectance(math.cos(inside), eta, 1.0),
            strict=True,
        )
    )
    natural = trace_ray(prism, face - 0.1 * way, way, wavelength_nm)
    assert natural.events == ("refract", "refract", "escape")
    assert natural.transmittance == pytest.approx(0.5 * (of_s + of_p), rel=1e-12)
    for light, expected in ((OF_S, of_s), (OF_P, of_p)):
        path = trace_ray(prism, face - 0.1 * way, way, wavelength_nm, polarisation=light)
        assert path.transmittance == pytest.approx(expected, rel=1e-12)
    # An average at each surface is off: by 0.33 % and 3.0 %.
    first = 1.0 - 0.5 * sum(analytic.fresnel_reflectance(math.cos(theta_i), 1.0, eta))
    off = float(first) ** 2 / natural.transmittance - 1.0
    assert off == pytest.approx({"N-BK7": -0.0033, "SF11": -0.030}[medium], rel=0.05)


@pytest.mark.parametrize("reflections", [1, 2])
def test_the_rainbow_is_polarised(reflections):
    # T_s R_s^k T_s against T_p R_p^k T_p at the least deviation, which is at
    # cos²θ_i = (n² − 1)/(k(k + 2)) (van de Hulst 1957, Light Scattering by Small Particles, §13.2):
    # 96 % of the primary bow and 90 % of the secondary one vibrate along it.
    n = 4.0 / 3.0
    drop = scene_of((
        scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.001),
        scenes.Dielectric(medium=scenes.ConstantMedium(eta=n)),
    ))  # fmt: skip
    cosine = math.sqrt((n * n - 1.0) / (reflections * (reflections + 2.0)))
    height = 0.001 * math.sqrt(1.0 - cosine * cosine)
    path = trace_ray(
        drop, (-0.01, height, 0.0), (1.0, 0.0, 0.0), 550.0,
        branches=["refract"] + ["reflect"] * reflections,
    )  # fmt: skip
    of_s, of_p = (
        float((1.0 - r) ** 2 * r**reflections)
        for r in analytic.fresnel_reflectance(cosine, 1.0, n)
    )
    # cosθ to some ε/cosθ, and R_p has a slope of some 3 on a value of some 0.004.
    assert path.transmittance == pytest.approx(0.5 * (of_s + of_p), rel=1e-11)
    degree = float(degree_of_polarisation(path.stokes[-1]))
    assert degree == pytest.approx((of_s - of_p) / (of_s + of_p), rel=1e-11)
    assert 0.5 * (1.0 + degree) == pytest.approx({1: 0.96, 2: 0.90}[reflections], abs=0.005)
    # It vibrates along z, across the plane of the bow.
    assert abs(path.frames[-1][2]) == pytest.approx(1.0, abs=1e-12)
    assert path.polarisations[-1][0] > 0.0


def test_a_gold_mirror_turns_linear_light_elliptic():
    table = scenes.MetalTable(wavelength_nm=(300.0, 900.0), n=(0.37, 0.37), k=(2.82, 2.82))
    metal = scenes.Metal(metal=table)
    mirror = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0))
    scene = scene_of((mirror, metal))
    theta = math.radians(70.0)
    way = np.array([math.sin(theta), -math.cos(theta), 0.0])
    path = trace_ray(scene, -0.1 * way, way, 550.0, polarisation=DIAGONAL)
    assert path.events == ("mirror", "escape")
    matrix = boundary_matrices(math.cos(theta), 1.0, 0.37 + 2.82j).reflection
    # The frame's s is +z, and `up` is it: U = 1 comes in.
    expected = matrix @ [1.0, 0.0, 1.0, 0.0]
    np.testing.assert_allclose(path.stokes[-1], expected, atol=32.0 * EPS)
    r_s, r_p = fresnel_amplitudes(math.cos(theta), 1.0, 0.37 + 2.82j)
    natural = trace_ray(scene, -0.1 * way, way, 550.0)
    mean = 0.5 * (abs(complex(r_s)) ** 2 + abs(complex(r_p)) ** 2)
    assert natural.transmittance == pytest.approx(mean, rel=16.0 * EPS)


def sheet(x, axis, tilt_deg=0.0):
    normal = (math.cos(math.radians(tilt_deg)), math.sin(math.radians(tilt_deg)), 0.0)
    disk = scenes.Disk(position=(x, 0.0, 0.0), normal=normal, radius=0.1)
    return disk, scenes.Polariser(axis=axis)


def test_malus():
    # cos² of the angle between the axes; natural light keeps a half (Hecht 2017, §8.2.1).
    for degrees in (0.0, 30.0, 45.0, 77.0, 90.0):
        angle = math.radians(degrees)
        axis = (0.0, math.cos(angle), math.sin(angle))
        path = along_x(scene_of(sheet(0.0, (0.0, 1.0, 0.0)), sheet(0.1, axis)))
        assert path.events == ("polarise", "polarise", "escape")
        assert path.transmittance == pytest.approx(0.5 * math.cos(angle) ** 2, abs=8.0 * EPS)
        np.testing.assert_array_equal(path.directions[0], path.directions[-1])


def test_a_third_polariser_between_crossed_ones_lets_light_through():
    y, z = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    crossed = along_x(scene_of(sheet(0.0, y), sheet(0.2, z)))
    assert crossed.transmittance == pytest.approx(0.0, abs=8.0 * EPS)
    three = along_x(scene_of(sheet(0.0, y), sheet(0.1, (0.0, 1.0, 1.0)), sheet(0.2, z)))
    assert three.transmittance == pytest.approx(0.125, abs=8.0 * EPS)


def test_a_tilted_polariser_absorbs_along_its_absorbing_axis_as_seen():
    # The axis along z, tilted about z by 50°: what is absorbed vibrates in the plane x–y, whatever
    # the tilt; tilted with the absorbing axis along z, likewise (Korger et al. 2013).
    for axis, passes in (((0.0, 0.0, 1.0), OF_S), ((-math.sin(1.0), math.cos(1.0), 0.0), OF_P)):
        scene = scene_of(sheet(0.0, axis, tilt_deg=math.degrees(1.0)))
        blocks = OF_P if passes is OF_S else OF_S
        for light, expected in ((passes, 1.0), (blocks, 0.0)):
            found = along_x(scene, polarisation=light).transmittance
            assert found == pytest.approx(expected, abs=8.0 * EPS)


def test_circular_light_keeps_a_half_at_any_polariser():
    circular = scenes.Polarisation(ellipticity_deg=45.0)
    for axis in ((0.0, 1.0, 0.0), (0.0, 0.3, 0.8)):
        path = along_x(scene_of(sheet(0.0, axis)), polarisation=circular)
        assert path.transmittance == pytest.approx(0.5, abs=8.0 * EPS)


def test_light_along_up_is_refused():
    with pytest.raises(SettingsError, match=r"polarisation\.up"):
        along_x(TEN_PLATES, polarisation=scenes.Polarisation(up=(1.0, 0.0, 0.0)))


def test_shares_of_s_and_p_cannot_follow_a_polariser():
    scene = scene_of(sheet(0.0, (0.0, 1.0, 0.0)))
    with pytest.raises(SettingsError, match="polarises in a plane of its own"):
        plan_features(scene, RenderSettings(polarisation="s-p").resolved(scene))


def test_a_polariser_in_a_medium_that_absorbs():
    # exp(−α d) on the way, and a half of the rest in the sheet.
    smoke = scenes.ConstantMedium(
        eta=1.2, absorption=scenes.NapierianAbsorption(coefficient=0.7)
    )
    item = scenes.SceneObject(
        shape=sheet(0.0, (0.0, 1.0, 0.0))[0], material=scenes.Polariser(axis=(0.0, 1.0, 0.0))
    )
    path = along_x(scenes.Scene(objects=[item], ambient=smoke))
    assert path.absorptances[0] == pytest.approx(1.0 - 0.5 * math.exp(-0.7), rel=8.0 * EPS)
