"""Single rays through prisms: Snell's law twice, for every glass and almost every angle."""

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
from spectra import glass, glasses

REFERENCES = json.loads((Path(__file__).parents[1] / "references.json").read_text(encoding="utf-8"))
BK7 = REFERENCES["N-BK7"]
LINES_NM = REFERENCES["lines_nm"]

APEXES_DEG = (1e-3, 0.1, 1.0, 10.0, 30.0, 45.0, 60.0, 70.0)
WAVELENGTHS_NM = np.linspace(400.0, 700.0, 13)
BASE = 0.02
TOLERANCE_RAD = math.radians(1e-7)
THROUGH = ("refract", "refract", "escape")
EPS = float(np.finfo(np.float64).eps)


def printed(value, decimals):
    """Equal to the digits printed: within half a unit of the last."""
    return pytest.approx(value, abs=0.5 * 10.0**-decimals)


def prism_scene(medium, apex_deg, *, base=BASE):
    """A prism about the origin, apex up; a slender one is cut off four bases high."""
    full_height = 0.5 * base / math.tan(math.radians(0.5 * apex_deg))
    shape = scenes.Prism(
        position=(0.0, 0.0, 0.0), apex_deg=apex_deg, base=base, length=base,
        height=min(full_height, 4.0 * base),
    )  # fmt: skip
    material = scenes.Dielectric(medium=medium)
    return scenes.Scene(objects=[scenes.SceneObject(name="prism", shape=shape, material=material)])


def rays_onto_left_face(scene, theta_i):
    """Origins and directions of rays that meet the left face half way up at angles θᵢ, (n, 3).

    A positive angle comes from the base's side of the normal, so that −90° runs down along the
    face from the apex and +90° up along it from the base.
    """
    shape = scene.objects[0].shape
    half_apex = math.radians(0.5 * shape.apex_deg)
    x = -0.5 * shape.base + 0.5 * shape.section_height * math.tan(half_apex)
    theta_i = np.asarray(theta_i)
    # The inward normal, (cos, −sin) of half the apex angle, turned by θᵢ.
    turn = theta_i - half_apex
    directions = np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=-1)
    return np.array([x, 0.0, 0.0]) - 0.1 * shape.base * directions, directions


def signed_deviation(path):
    """Deviation toward the base, which lies to the right of a ray that goes from left to right."""
    first, last = path.directions[0], path.directions[-1]
    return -math.atan2(first[0] * last[1] - first[1] * last[0], float(np.dot(first, last)))


def incidences(apex, eta, count):
    """Angles between grazing incidence and grazing exit; none where no ray passes.

    A ray leaves along the second face if it meets it at the critical angle: with θₜ = A − θ_c,
    sinθᵢ = η sin(A − θ_c).
    """
    sin_least = eta * math.sin(apex - math.asin(1.0 / eta))
    if sin_least >= 1.0:
        return np.empty(0)
    least, most = math.asin(max(sin_least, -1.0)), 0.5 * math.pi
    from_the_ends = np.radians([1e-8, 1e-5, 1e-2])
    between = least + (most - least) * np.linspace(0.02, 0.98, count)
    return np.concatenate([least + from_the_ends, between, most - from_the_ends])


def closed_form(apex, theta_i, eta):
    """δ = θᵢ − A + arcsin(sin A √(η² − sin²θᵢ) − cos A sinθᵢ), in extended precision.

    Also the sine in the brackets, sinθₑ (Hecht 2017, Optics, §5.5.1, eq. 5.53).
    """
    a, t, n = np.longdouble(apex), theta_i.astype(np.longdouble), eta.astype(np.longdouble)
    sin_theta_e = np.sin(a) * np.sqrt(n * n - np.sin(t) ** 2) - np.cos(a) * np.sin(t)
    return t - a + np.arcsin(sin_theta_e), sin_theta_e


@pytest.mark.parametrize("name", glasses())
def test_deviations_are_the_closed_forms(name):
    medium = glass(name)
    start_device("cpu")
    passed = 0
    for apex_deg in APEXES_DEG:
        apex = math.radians(apex_deg)
        scene = prism_scene(name, apex_deg)
        pairs = [
            (theta_i, wavelength_nm)
            for wavelength_nm in WAVELENGTHS_NM
            for theta_i in incidences(apex, medium.eta(wavelength_nm), 15)
        ]
        if not pairs:
            continue
        theta_i, wavelength_nm = np.array(pairs).T
        eta = medium.eta(wavelength_nm)
        origins, directions = rays_onto_left_face(scene, theta_i)
        paths = trace_compiled_rays(
            compile_scene(scene), origins, directions, wavelength_nm, max_interactions=4
        )
        assert {path.events for path in paths} == {THROUGH}
        traced = np.array([signed_deviation(path) for path in paths])
        expected, sin_theta_e = closed_form(apex, theta_i, eta)
        error = np.abs(traced - expected).astype(np.float64)
        assert error.max() < TOLERANCE_RAD
        # Directions, normals and the index round by ε; η sin(A − θₜ), of size 1, by a few; and the
        # exit angle by that over its cosine.
        cos_theta_e = np.sqrt((1.0 - sin_theta_e) * (1.0 + sin_theta_e)).astype(np.float64)
        assert np.all(error <= 8.0 * EPS * (1.0 + eta / cos_theta_e))
        # The library's own closed form, which rounds alike, and the unsigned angle of the path.
        library = analytic.prism_deviation(apex, theta_i, eta)
        np.testing.assert_allclose(traced, library, rtol=0, atol=TOLERANCE_RAD)
        unsigned = np.array([path.deviation for path in paths])
        np.testing.assert_allclose(unsigned, np.abs(traced), rtol=0, atol=2.0 * EPS)
        passed += len(paths)
    assert passed > 1000


def test_where_no_ray_passes_it_is_reflected_totally():
    # Diamond, 60°: any ray that enters meets the second face beyond its critical angle.
    medium, apex = glass("diamond"), math.radians(60.0)
    assert len(incidences(apex, medium.eta(550.0), 5)) == 0
    scene = prism_scene("diamond", 60.0)
    for theta_i in np.radians([-20.0, 0.0, 50.0, 89.0]):
        origins, directions = rays_onto_left_face(scene, [theta_i])
        path = trace_ray(scene, origins[0], directions[0], 550.0)
        assert path.events[:2] == ("refract", "total internal reflection")
        assert np.isnan(analytic.prism_deviation(apex, theta_i, medium.eta(550.0)))


def test_single_precision_is_good_to_an_arc_second():
    # Each of some ten operations rounds by ε = 1.2e-7 rad or 0.025″.
    scene = prism_scene("N-BK7", 60.0)
    theta_i = np.radians(np.linspace(35.0, 80.0, 46))
    origins, directions = rays_onto_left_face(scene, theta_i)
    wavelength_nm = np.full(46, 550.0)
    compiled = compile_scene(scene, precision="float32")
    paths = trace_compiled_rays(compiled, origins, directions, wavelength_nm, max_interactions=4)
    expected = analytic.prism_deviation(math.radians(60.0), theta_i, glass("N-BK7").eta(550.0))
    error = np.degrees(np.array([path.deviation for path in paths]) - expected) * 3600.0
    assert np.abs(error).max() < 1.0


# The published numbers

PRISM = prism_scene("N-BK7", 60.0)
THETA_I_D = math.radians(BK7["prism_60_fixed_incidence_deg"])


def traced_at(theta_i, wavelength_nm):
    origins, directions = rays_onto_left_face(PRISM, [theta_i])
    path = trace_ray(PRISM, origins[0], directions[0], wavelength_nm)
    assert path.events == THROUGH
    return path


@pytest.mark.parametrize("line", LINES_NM)
def test_minimum_deviation_of_bk7(line):
    # The least of many rays about the symmetric one, which is where the parabola bottoms.
    expected = BK7["prism_60_minimum_deviation_deg"][line]
    centre = math.asin(glass("N-BK7").eta(LINES_NM[line]) * 0.5)  # sinθᵢ = η sin(A/2)
    theta_i = centre + np.linspace(-1e-3, 1e-3, 201)
    origins, directions = rays_onto_left_face(PRISM, theta_i)
    paths = trace_compiled_rays(
        compile_scene(PRISM), origins, directions, np.full(201, LINES_NM[line]), max_interactions=4
    )
    deviations = np.array([path.deviation for path in paths])
    assert np.argmin(deviations) in range(98, 103)  # flat to the last digit at the bottom
    assert math.degrees(deviations.min()) == printed(expected, 7)
    # The ray inside is parallel to the base.
    assert abs(paths[100].directions[1][1]) < 4.0 * EPS


def test_incidence_at_minimum_deviation_of_bk7():
    path = traced_at(THETA_I_D, LINES_NM["d"])
    # Half a unit of the incidence's last digit turns the ray inside by cosθᵢ/(η cosθₜ) of it.
    assert math.degrees(path.directions[1][1]) == printed(0.0, 7)


@pytest.mark.parametrize("line", ["F", "C"])
def test_deviation_of_bk7_at_fixed_incidence(line):
    path = traced_at(math.asin(glass("N-BK7").n_d * 0.5), LINES_NM[line])
    expected = BK7["prism_60_deviation_at_fixed_incidence_deg"][line]
    assert math.degrees(path.deviation) == printed(expected, 7)


def test_dispersion_of_the_bk7_prism():
    # Central difference over 0.1 nm: the third derivative leaves 1e-7″, rounding 1e-9″.
    theta_i, half_nm = math.asin(glass("N-BK7").n_d * 0.5), 0.05
    longer, shorter = (
        traced_at(theta_i, LINES_NM["d"] + step).deviation for step in (half_nm, -half_nm)
    )
    arcsec_per_nm = math.degrees(longer - shorter) * 3600.0 / (2.0 * half_nm)
    assert arcsec_per_nm == printed(BK7["dispersion_at_d_arcsec_per_nm"], 6)


@pytest.mark.parametrize("line", ["F", "C"])
def test_spectrum_on_a_screen(line):
    # A prism of ten nanometres, so that all colours leave it at one point, and a screen 1000 mm
    # away across the d ray.
    prism = prism_scene("N-BK7", 60.0, base=1e-8)
    theta_i = math.asin(glass("N-BK7").n_d * 0.5)
    origins, directions = rays_onto_left_face(prism, [theta_i])
    d_ray = trace_ray(prism, origins[0], directions[0], LINES_NM["d"])
    onward, leaves = d_ray.directions[-1], d_ray.points[-2]
    screen = scenes.SceneObject(
        name="screen",
        shape=scenes.Rectangle(
            position=tuple((leaves + onward).tolist()), normal=tuple((-onward).tolist()),
            size=(0.1, 0.1),
        ),
        material=scenes.Lambertian(reflectance=0.8),
    )  # fmt: skip
    scene = scenes.Scene(objects=[*prism.objects, screen])
    path = trace_ray(scene, origins[0], directions[0], LINES_NM[line])
    assert path.events == ("refract", "refract", "deposit")
    assert path.objects == ("prism", "prism", "screen")
    # Blue lands nearer to the base, red further from it.
    toward_base = np.array([onward[1], -onward[0], 0.0])
    millimetres = 1000.0 * float((path.points[-1] - leaves) @ toward_base)
    expected = BK7["screen_1000mm_perpendicular_to_d_ray_mm"][line]
    assert millimetres == printed(expected, 6)


def test_a_right_angled_prism_turns_light_back():
    # Two total reflections at 45° in the legs of a 45-90-45 prism; N-BK7 reflects beyond 41.2°.
    scene = prism_scene("N-BK7", 90.0)
    bottom = -0.25 * BASE - 0.01
    path = trace_ray(scene, (0.2 * BASE, bottom, 0.0), (0.0, 1.0, 0.0), 587.5618)
    assert path.events == (
        "refract", "total internal reflection", "total internal reflection", "refract", "escape",
    )  # fmt: skip
    assert path.deviation == pytest.approx(math.pi, abs=8.0 * EPS)
    assert path.points[-2][0] == pytest.approx(-0.2 * BASE, abs=1e-17)
    # Whatever the tilt in the section's plane, two mirrors at a right angle turn by 180°.
    tilted = trace_ray(scene, (0.15 * BASE, bottom, 0.0), (0.05, 1.0, 0.0), 587.5618)
    assert tilted.deviation == pytest.approx(math.pi, abs=8.0 * EPS)


def test_a_right_angled_prism_turns_light_by_90_degrees():
    # In through one leg, total reflection at the base, out through the other.
    scene = prism_scene("N-BK7", 90.0)
    start = (-0.25 * BASE - 0.01, 0.01, 0.0)
    path = trace_ray(scene, start, (1.0, -1.0, 0.0), 587.5618)
    assert path.events == ("refract", "total internal reflection", "refract", "escape")
    assert path.deviation == pytest.approx(0.5 * math.pi, abs=8.0 * EPS)
    # Both faces are met straight on: all that is lost is ((η − 1)/(η + 1))², twice.
    lost = BK7["normal_reflectance_d"]
    assert path.transmittance == pytest.approx((1.0 - lost) ** 2, abs=1e-9)
