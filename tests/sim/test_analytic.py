import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import analytic
from spectra import glass

REFERENCES = json.loads((Path(__file__).parents[1] / "references.json").read_text(encoding="utf-8"))
BK7 = REFERENCES["N-BK7"]
LINES_NM: dict[str, float] = REFERENCES["lines_nm"]
N_D = glass("N-BK7").n_d

FloatArray = npt.NDArray[np.float64]


def printed(value: float, decimals: int) -> Any:
    """Equal to the digits printed: within half a unit of the last."""
    return pytest.approx(value, abs=0.5 * 10.0**-decimals)


# Snell


def test_snell_holds_on_both_sides() -> None:
    theta_i = np.deg2rad(np.linspace(-90.0, 90.0, 37))
    theta_t, is_total = analytic.snell_angle(theta_i, 1.0, 1.5)
    np.testing.assert_allclose(np.sin(theta_i), 1.5 * np.sin(theta_t), rtol=0, atol=4e-16)
    assert not is_total.any()


def test_refraction_is_reversible() -> None:
    theta_i = np.deg2rad(np.linspace(-80.0, 80.0, 33))
    theta_t = analytic.snell_angle(theta_i, 1.0, 2.4).theta_t
    # dθ_i = η cosθ_t / cosθ_i dθ_t: 14 times the rounding at 80°.
    np.testing.assert_allclose(
        analytic.snell_angle(theta_t, 2.4, 1.0).theta_t, theta_i, rtol=0, atol=1e-14
    )


def test_total_reflection_is_said_and_not_nan() -> None:
    theta_t, is_total = analytic.snell_angle(np.deg2rad([30.0, 60.0, -60.0, 90.0]), 1.5, 1.0)
    assert is_total.tolist() == [False, True, True, True]
    assert theta_t[1:].tolist() == [math.pi / 2, -math.pi / 2, math.pi / 2]


def test_the_boundary_of_total_reflection_is_total() -> None:
    # sin 30° · 2 is 1 but for rounding below; a half, exactly, is above.
    assert analytic.snell_angle(math.asin(0.5) + 1e-15, 2.0, 1.0).is_total


def test_grazing_light_enters_a_denser_medium_and_an_equal_one() -> None:
    assert not analytic.snell_angle(math.pi / 2, 1.0, 1.5).is_total
    theta_t, is_total = analytic.snell_angle(math.pi / 2, 1.5, 1.5)
    assert not is_total
    assert theta_t == math.pi / 2


def test_critical_and_brewster_angle_of_bk7() -> None:
    assert np.rad2deg(analytic.critical_angle(N_D, 1.0)) == printed(BK7["critical_angle_d_deg"], 7)
    assert np.rad2deg(analytic.brewster_angle(1.0, N_D)) == printed(BK7["brewster_d_deg"], 7)


def test_there_is_no_critical_angle_into_a_denser_medium() -> None:
    angles = analytic.critical_angle(1.0, np.array([0.5, 1.0, 1.5]))
    assert angles[:2] == pytest.approx([math.pi / 6, math.pi / 2], rel=1e-15)
    assert math.isnan(angles[2])


# Fresnel


@pytest.mark.parametrize("degrees", ["45", "60", "80"])
def test_reflectance_is_the_published_one(degrees: str) -> None:
    expected = REFERENCES["fresnel_n_1.5"][degrees]
    r_s, r_p = analytic.fresnel_reflectance(math.cos(math.radians(float(degrees))), 1.0, 1.5)
    assert r_s == printed(expected["Rs"], 9)
    assert r_p == printed(expected["Rp"], 9)


def test_reflectance_at_normal_incidence() -> None:
    r_s, r_p = analytic.fresnel_reflectance(1.0, 1.0, N_D)
    assert r_s == printed(BK7["normal_reflectance_d"], 9)
    assert r_p == pytest.approx(r_s, rel=1e-15)


def textbook(cos_i: FloatArray, eta_i: float, eta_t: float) -> tuple[FloatArray, FloatArray]:
    """Born & Wolf 1999, §1.5.2, eq. 21, as printed, squared."""
    cos_t = np.sqrt(1.0 - (eta_i / eta_t) ** 2 * (1.0 - cos_i**2))
    r_s = (eta_i * cos_i - eta_t * cos_t) / (eta_i * cos_i + eta_t * cos_t)
    r_p = (eta_t * cos_i - eta_i * cos_t) / (eta_t * cos_i + eta_i * cos_t)
    return r_s**2, r_p**2


@pytest.mark.parametrize(("eta_i", "eta_t"), [(1.0, 1.5), (1.5, 1.0), (1.33, 2.4), (1.0, 1.01)])
def test_the_rewritten_formula_is_the_textbooks(eta_i: float, eta_t: float) -> None:
    least = math.sqrt(max(0.0, 1.0 - (eta_t / eta_i) ** 2))
    cos_i = np.linspace(least + 1e-3, 1.0, 101)
    ours = analytic.fresnel_reflectance(cos_i, eta_i, eta_t)
    theirs = textbook(cos_i, eta_i, eta_t)
    # Theirs rounds each amplitude by some 1e-16, and more where cos θ_t cancels at 1e-3.
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=2e-13)


@pytest.mark.parametrize("cos_i", [0.0, 1e-300, 1e-9, 0.5, 1.0])
def test_equal_indices_reflect_nothing(cos_i: float) -> None:
    r_s, r_p = analytic.fresnel_reflectance(cos_i, 1.5, 1.5)
    assert (float(r_s), float(r_p)) == (0.0, 0.0)


@pytest.mark.parametrize(("eta_i", "eta_t"), [(1.0, 1.5), (1.5, 1.0), (1.0, 1.0 + 1e-12), (1, 4)])
def test_grazing_light_is_reflected_whole(eta_i: float, eta_t: float) -> None:
    r_s, r_p = analytic.fresnel_reflectance(0.0, eta_i, eta_t)
    assert (float(r_s), float(r_p)) == (1.0, 1.0)


def test_nearly_equal_indices_keep_their_digits() -> None:
    # At normal incidence R = (δ / (2 + δ))²; the textbook's numerator has one digit left here.
    delta = 2.0**-50
    r_s, r_p = analytic.fresnel_reflectance(1.0, 1.0, 1.0 + delta)
    assert r_s == pytest.approx((delta / 2.0) ** 2, rel=1e-14)
    assert r_p == pytest.approx((delta / 2.0) ** 2, rel=1e-14)


def test_brewster_light_loses_its_p_part() -> None:
    theta_b = analytic.brewster_angle(1.0, 1.5)
    assert analytic.fresnel_reflectance(np.cos(theta_b), 1.0, 1.5)[1] < 1e-31


def test_beyond_the_critical_angle_all_is_reflected() -> None:
    theta_c = analytic.critical_angle(1.5, 1.0)
    beyond = np.cos(theta_c + np.array([1e-8, 0.1, 0.5]))
    for share in analytic.fresnel_reflectance(beyond, 1.5, 1.0):
        assert share.tolist() == [1.0, 1.0, 1.0]


@settings(deadline=None)
@given(st.floats(0.0, 1.0), st.floats(1.0, 4.0), st.floats(1.0, 4.0))
def test_reflectance_is_a_share_and_p_never_above_s(
    cos_i: float, eta_i: float, eta_t: float
) -> None:
    r_s, r_p = analytic.fresnel_reflectance(cos_i, eta_i, eta_t)
    rounding = 8 * np.finfo(np.float64).eps
    assert 0.0 <= r_p <= r_s + rounding
    assert r_s <= 1.0 + rounding


@settings(deadline=None)
@given(st.floats(0.01, 1.5), st.floats(1.01, 4.0))
def test_both_sides_of_an_interface_reflect_alike(theta_i: float, eta: float) -> None:
    # Stokes's relations (Hecht 2017, §4.10): r' = -r along the reversed path.
    theta_t = analytic.snell_angle(theta_i, 1.0, eta).theta_t
    outside = analytic.fresnel_reflectance(math.cos(theta_i), 1.0, eta)
    inside = analytic.fresnel_reflectance(np.cos(theta_t), eta, 1.0)
    # At θ_i = 1.5 the inner angle is within 0.3% of critical, and its rounding counts η²/cos²θ_i.
    np.testing.assert_allclose(inside, outside, rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("eta_i", "eta_t", "key"),
    [(1.0, 1.5, "diffuse_average_external"), (1.5, 1.0, "diffuse_average_internal")],
)
def test_diffuse_reflectance(eta_i: float, eta_t: float, key: str) -> None:
    # Average over a Lambertian hemisphere, ∫ R d(sin²θ); in s = sin²θ the integrand has square-root
    # ends, at grazing and at the critical angle, so each part is a Gauss-Legendre rule in a
    # variable t with s = a + (b - a)(3t² - 2t³), flat at both.
    nodes, weights = np.polynomial.legendre.leggauss(200)
    t = 0.5 * (nodes + 1.0)
    critical = min(1.0, (eta_t / eta_i) ** 2)
    average = 1.0 - critical  # All of what is beyond the critical angle.
    sin2 = critical * t * t * (3.0 - 2.0 * t)
    d_sin2 = critical * 6.0 * t * (1.0 - t) * 0.5 * weights
    r_s, r_p = analytic.fresnel_reflectance(np.sqrt(1.0 - sin2), eta_i, eta_t)
    average += float(np.sum(0.5 * (r_s + r_p) * d_sin2))
    assert average == printed(REFERENCES["fresnel_n_1.5"][key], 9)


# Slabs


def test_a_slab_without_absorption() -> None:
    expected = REFERENCES["slab_n_1.5_all_internal_reflections"]["alpha_d_0"]["T"]
    assert analytic.slab_transmittance(0.0, 1.5) == printed(expected, 9)


def test_a_slab_with_absorption() -> None:
    expected = REFERENCES["slab_n_1.5_all_internal_reflections"]["alpha_d_1"]
    split = analytic.slab_split(0.0, 1.5, optical_depth=1.0)
    assert split.transmitted == printed(expected["T"], 9)
    assert split.reflected == printed(expected["R"], 9)
    assert split.absorbed == printed(expected["A"], 9)


def test_a_slab_is_the_sum_of_its_internal_reflections() -> None:
    theta_i, eta, depth = math.radians(50.0), 1.7, 0.3
    theta_t = analytic.snell_angle(theta_i, 1.0, eta).theta_t
    crossing = math.exp(-depth / math.cos(float(theta_t)))
    transmitted = 0.0
    for face in analytic.fresnel_reflectance(math.cos(theta_i), 1.0, eta):
        share = 0.5 * (1.0 - float(face)) * crossing
        for _ in range(60):  # Each round trip keeps a few percent: all that counts.
            transmitted += share * (1.0 - float(face))
            share *= (float(face) * crossing) ** 2
    assert analytic.slab_transmittance(theta_i, eta, optical_depth=depth) == pytest.approx(
        transmitted, rel=1e-14
    )


@settings(deadline=None)
@given(st.floats(0.0, math.pi / 2), st.floats(0.5, 4.0), st.floats(0.0, 800.0))
def test_a_slab_loses_no_energy(theta_i: float, eta: float, depth: float) -> None:
    split = analytic.slab_split(theta_i, eta, optical_depth=depth)
    assert sum(split) == pytest.approx(1.0, abs=1e-12)
    assert min(split) >= 0.0


def test_a_perfect_mirror_and_an_invisible_slab() -> None:
    assert [float(share) for share in analytic.slab_split(1.2, 0.5)] == [1.0, 0.0, 0.0]
    assert [float(share) for share in analytic.slab_split(1.2, 1.0)] == [0.0, 1.0, 0.0]


# Prisms

APEX = math.radians(60.0)


@pytest.mark.parametrize("line", ["F", "d", "C"])
def test_minimum_deviation_of_bk7(line: str) -> None:
    eta = glass("N-BK7").eta(LINES_NM[line])
    expected = BK7["prism_60_minimum_deviation_deg"][line]
    assert np.rad2deg(analytic.prism_minimum_deviation(APEX, eta)) == printed(expected, 7)


@pytest.mark.parametrize("line", ["F", "C"])
def test_deviation_of_bk7_at_fixed_incidence(line: str) -> None:
    theta_i = analytic.prism_incidence_at_minimum_deviation(APEX, N_D)
    assert np.rad2deg(theta_i) == printed(BK7["prism_60_fixed_incidence_deg"], 7)
    deviation = analytic.prism_deviation(APEX, theta_i, glass("N-BK7").eta(LINES_NM[line]))
    expected = BK7["prism_60_deviation_at_fixed_incidence_deg"][line]
    assert np.rad2deg(deviation) == printed(expected, 7)


def test_dispersion_of_the_bk7_prism() -> None:
    # Central difference over ±0.5 nm: the third derivative leaves some 1e-5 arc-seconds.
    theta_i = analytic.prism_incidence_at_minimum_deviation(APEX, N_D)
    d = LINES_NM["d"]
    at = glass("N-BK7").eta(np.array([d - 0.5, d + 0.5]))
    longer_minus_shorter = float(np.diff(analytic.prism_deviation(APEX, theta_i, at))[0])
    arcsec_per_nm = math.degrees(longer_minus_shorter) * 3600.0
    assert arcsec_per_nm == pytest.approx(BK7["dispersion_at_d_arcsec_per_nm"], abs=1e-4)


@pytest.mark.parametrize("line", ["F", "C"])
def test_spectrum_on_a_screen(line: str) -> None:
    # 1000 mm away, square to the d ray: x = 1000 tan(δ - δ_d).
    theta_i = analytic.prism_incidence_at_minimum_deviation(APEX, N_D)
    beside = analytic.prism_deviation(APEX, theta_i, glass("N-BK7").eta(LINES_NM[line]))
    turn = beside - analytic.prism_deviation(APEX, theta_i, N_D)
    expected = BK7["screen_1000mm_perpendicular_to_d_ray_mm"][line]
    assert 1000.0 * np.tan(turn) == printed(expected, 6)


@pytest.mark.parametrize("apex_deg", [1e-3, 10.0, 45.0, 60.0])
@pytest.mark.parametrize("eta", [1.3, 1.5168, 1.9])
def test_the_symmetric_path_deviates_least(apex_deg: float, eta: float) -> None:
    apex = math.radians(apex_deg)
    theta_i = float(analytic.prism_incidence_at_minimum_deviation(apex, eta))
    least = float(analytic.prism_minimum_deviation(apex, eta))
    assert analytic.prism_deviation(apex, theta_i, eta) == pytest.approx(least, abs=4e-16 / 0.1)
    beside = analytic.prism_deviation(apex, theta_i + np.array([-0.02, 0.02]), eta)
    # A flat minimum of a flat prism: rounding only.
    assert np.all(beside > least - 1e-15)
    # The path reversed: the ray leaves as it came.
    inside = analytic.snell_angle(theta_i, 1.0, eta).theta_t
    assert inside == pytest.approx(apex / 2.0, abs=1e-15)


def test_a_thin_prism_deviates_by_its_apex_times_eta_minus_1() -> None:
    # Born & Wolf 1999, §4.7.2, small angles: δ = (η - 1) A, to A³.
    apex = math.radians(1e-3)
    assert analytic.prism_deviation(apex, 0.0, 1.5) == pytest.approx(0.5 * apex, rel=1e-9)


def test_a_prism_in_a_denser_liquid_deviates_away_from_its_base() -> None:
    assert analytic.prism_deviation(APEX, 0.3, 1.0 / 1.2) < 0.0


def test_a_prism_of_nothing_deviates_nothing() -> None:
    angles = np.deg2rad([-20.0, 0.0, 80.0])
    np.testing.assert_allclose(analytic.prism_deviation(APEX, angles, 1.0), 0.0, atol=5e-16)


def test_no_ray_passes_where_total_reflection_stops_it() -> None:
    # 60° of index 1.5: the second face is met beyond 41.8° when the ray enters below 27.9°.
    deviation = analytic.prism_deviation(APEX, np.deg2rad([27.0, 29.0]), 1.5)
    assert np.isnan(deviation).tolist() == [True, False]
    # No path at all where η sin(A/2) >= 1, or into a thinner prism beyond its critical angle.
    assert math.isnan(analytic.prism_minimum_deviation(APEX, 2.4))
    assert math.isnan(analytic.prism_incidence_at_minimum_deviation(APEX, 2.0 + 1e-12))
    assert math.isnan(analytic.prism_deviation(APEX, 1.2, 0.8))


def test_a_ray_that_runs_away_from_the_second_face_is_none() -> None:
    assert math.isnan(analytic.prism_deviation(math.radians(100.0), 0.1, 1.01))


# Lenses and plates


def test_ball_lens_of_bk7() -> None:
    expected = BK7["ball_lens_diameter_10mm"]
    assert analytic.ball_lens_focal_length(N_D, 10.0) == printed(expected["EFL_mm"], 8)
    assert analytic.ball_lens_back_focal_length(N_D, 10.0) == printed(expected["BFL_mm"], 8)


def test_ball_lens_formula() -> None:
    # f = η D / (4 (η - 1)); at η = 2 the focus is on the rear surface.
    assert analytic.ball_lens_focal_length(1.5, 8.0) == pytest.approx(1.5 * 8.0 / 2.0, rel=1e-15)
    assert analytic.ball_lens_back_focal_length(2.0, 8.0) == pytest.approx(0.0, abs=1e-15)
    assert analytic.ball_lens_focal_length(1.0, 8.0) == math.inf


def traced_focus(eta: float, r1: float, r2: float, thickness: float) -> tuple[float, float]:
    """Back and effective focal length by paraxial ray tracing (Hecht 2017, §6.2).

    At a surface of curvature c, η_t u' = η_i u - y c (η_t - η_i); between them, y' = y + d u.
    """
    height, slope = 1.0, 0.0
    slope = -height * (eta - 1.0) / (r1 * eta)
    height += thickness * slope
    slope = eta * slope - height * (1.0 - eta) / r2
    return -height / slope, -1.0 / slope


@pytest.mark.parametrize(
    ("r1", "r2", "thickness"),
    [
        (0.05, -0.05, 0.005),  # Biconvex.
        (0.05, math.inf, 0.004),  # Plano-convex, and the other way round.
        (math.inf, -0.05, 0.004),
        (0.03, 0.08, 0.006),  # Meniscus.
        (-0.05, 0.07, 0.002),  # Biconcave.
        (0.5, -0.5, 0.5),  # A ball of 1 m.
    ],
)
def test_thick_lenses_focus_where_paraxial_rays_do(r1: float, r2: float, thickness: float) -> None:
    back, effective = traced_focus(1.5168, r1, r2, thickness)
    focal_length = analytic.lensmaker_focal_length(1.5168, r1, r2, thickness)
    assert focal_length == pytest.approx(effective, rel=1e-13)
    back_focal_length = analytic.lensmaker_back_focal_length(1.5168, r1, r2, thickness)
    assert back_focal_length == pytest.approx(back, rel=1e-13)


@pytest.mark.parametrize(("eta", "r1", "r2"), [(1.5, math.inf, math.inf), (1.0, 0.1, -0.1)])
def test_glass_without_power_has_its_focus_at_infinity(eta: float, r1: float, r2: float) -> None:
    assert analytic.lensmaker_focal_length(eta, r1, r2, 0.01) == math.inf
    assert analytic.lensmaker_back_focal_length(eta, r1, r2, 0.01) == math.inf


def test_plate_of_bk7() -> None:
    expected = BK7["plate_10mm_45deg_lateral_shift_mm"]
    assert analytic.plate_lateral_shift(math.radians(45.0), N_D, 10.0) == printed(expected, 8)


def test_plate_shift_is_its_geometry() -> None:
    # t sin(θ_i - θ_t) / cos θ_t, before Snell's law is put in.
    theta_i = np.deg2rad(np.linspace(0.0, 89.0, 20))
    theta_t = analytic.snell_angle(theta_i, 1.0, 1.7).theta_t
    expected = 3.0 * np.sin(theta_i - theta_t) / np.cos(theta_t)
    np.testing.assert_allclose(
        analytic.plate_lateral_shift(theta_i, 1.7, 3.0), expected, rtol=0, atol=4e-15
    )


# Angles


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-12, 1e-8, 0.3, math.pi / 2, 3.0, math.pi])
def test_angles_keep_their_digits(angle: float) -> None:
    a = np.array([1.0, 0.0, 0.0])
    b = 7.0 * np.array([math.cos(angle), math.sin(angle), 0.0])
    assert analytic.angle_between(a, b) == pytest.approx(angle, rel=4e-16, abs=0.0)


def test_angles_of_many_vectors() -> None:
    a = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
    b = np.array([0.0, 0.0, 3.0])
    assert analytic.angle_between(a, b).tolist() == [math.pi / 2, math.pi / 2]


def test_the_primary_rainbow() -> None:
    # Descartes: one internal reflection turns by D = π + 2 θ_i - 4 θ_t, least where
    # cos²θ_i = (η² - 1) / 3; the bow is seen at π - D from the antisolar point.
    eta = glass("water").n_d
    theta_i = math.acos(math.sqrt((eta * eta - 1.0) / 3.0))
    theta_t = analytic.snell_angle(theta_i, 1.0, eta).theta_t
    bow = np.rad2deg(4.0 * theta_t - 2.0 * theta_i)
    assert bow == printed(REFERENCES["rainbow_primary_water_d_deg"]["value"], 6)


def test_numbers_are_answered_with_scalars_and_arrays_with_arrays() -> None:
    assert np.ndim(analytic.prism_deviation(APEX, 0.9, 1.5)) == 0
    assert analytic.prism_deviation(APEX, np.zeros((2, 1)), np.ones(3)).shape == (2, 3)
    assert analytic.lensmaker_focal_length(np.array([1.5, 1.6]), 1.0, -1.0, 0.1).shape == (2,)
