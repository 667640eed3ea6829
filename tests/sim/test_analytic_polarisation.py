"""Closed forms of polarised light against printed numbers, identities and other derivations."""

import math

import numpy as np
import pytest

from sim import analytic
from sim.analytic_polarisation import (
    boundary_matrices,
    degree_of_polarisation,
    fresnel_amplitudes,
    plate_stack_transmittance,
    polariser_matrix,
    retarding_incidences,
    rotation_matrix,
    total_reflection_retardance,
)

EPS = float(np.finfo(np.float64).eps)
GOLD = 0.37 + 2.82j  # of any metal's kind; what it is called does not matter here
COSINES = np.linspace(0.0, 1.0, 201)


def degrees(whole: int, minutes: float) -> float:
    return whole + minutes / 60.0


def test_the_rhomb_of_fresnel() -> None:
    # Born & Wolf 1999, §1.5.4: n = 1.51 retards by 45° at 48°37' and at 54°37'.
    lesser, greater = np.degrees(retarding_incidences(math.pi / 4, 1.51))
    assert lesser == pytest.approx(degrees(48, 37), abs=0.5 / 60)
    assert greater == pytest.approx(degrees(54, 37), abs=0.5 / 60)
    # … and by 45°56' at most, at 51°20'.
    at_most = np.degrees(total_reflection_retardance(np.radians(degrees(51, 20)), 1.51, 1.0))
    assert at_most == pytest.approx(degrees(45, 56), abs=0.5 / 60)
    for step in (-0.5, 0.5):
        theta = np.radians(degrees(51, 20) + step)
        assert np.degrees(total_reflection_retardance(theta, 1.51, 1.0)) < at_most


def test_angles_that_retard_are_those_and_there_may_be_none() -> None:
    for eta in (1.5, 1.8, 2.4):
        for theta in retarding_incidences(0.6, eta):
            found = total_reflection_retardance(theta, eta, 1.0)
            assert found == pytest.approx(0.6, rel=64.0 * EPS)
    assert np.isnan(retarding_incidences(math.radians(46.0), 1.51)).all()
    assert np.isnan(total_reflection_retardance(0.5, 1.5, 1.0))  # below the critical angle


def test_total_reflection_retards_as_its_matrix_says() -> None:
    theta = np.radians(np.linspace(42.0, 89.0, 48))
    delta = total_reflection_retardance(theta, 1.5, 1.0)
    matrix = boundary_matrices(np.cos(theta), 1.5, 1.0).reflection
    # ∂δ/∂θ is about 1/√(sin²θ − n²), at most 20 here, and θ → cosθ → θ loses some ε.
    for place, expected in (((2, 2), np.cos(delta)), ((3, 2), np.sin(delta))):
        np.testing.assert_allclose(matrix[:, *place], expected, rtol=0, atol=100.0 * EPS)
    np.testing.assert_allclose(matrix[:, 0, 0], 1.0, rtol=0, atol=8.0 * EPS)
    np.testing.assert_allclose(matrix[:, 0, 1], 0.0, rtol=0, atol=8.0 * EPS)


@pytest.mark.parametrize("eta", [1.0 / 2.4, 0.999, 1.0, 1.0 + 1e-9, 1.5, 2.4])
def test_amplitudes_squared_are_the_reflectances(eta: float) -> None:
    r_s, r_p = fresnel_amplitudes(COSINES, 1.0, eta)
    of_s, of_p = analytic.fresnel_reflectance(COSINES, 1.0, eta)
    np.testing.assert_allclose(np.abs(r_s) ** 2, of_s, rtol=64.0 * EPS, atol=1e-30)
    np.testing.assert_allclose(np.abs(r_p) ** 2, of_p, rtol=64.0 * EPS, atol=1e-30)


def test_signs_at_normal_incidence() -> None:
    # Born & Wolf 1999, §1.5.2 eq. 24: r_p = (n − 1)/(n + 1) = −r_s, p turning with the ray.
    r_s, r_p = fresnel_amplitudes(1.0, 1.0, 1.5)
    assert r_s == pytest.approx(-0.2, abs=4.0 * EPS)
    assert r_p == pytest.approx(0.2, abs=4.0 * EPS)


def test_metal_at_normal_incidence() -> None:
    # R = ((n − 1)² + k²)/((n + 1)² + k²) (Born & Wolf 1999, §14.2 eq. 9).
    n, k = GOLD.real, GOLD.imag
    expected = ((n - 1.0) ** 2 + k * k) / ((n + 1.0) ** 2 + k * k)
    matrix = boundary_matrices(1.0, 1.0, GOLD).reflection
    assert matrix[0, 0] == pytest.approx(expected, rel=16.0 * EPS)
    # Handedness flips in a mirror, and so do the diagonals, seen from the other side.
    assert matrix[2, 2] == matrix[3, 3] == pytest.approx(-expected, rel=16.0 * EPS)


@pytest.mark.parametrize("eta", [1.0 / 1.5, 1.5, 2.4, GOLD])
def test_amplitudes_of_s_and_p_belong_together(eta: complex) -> None:
    # r_p/r_s = −cos(θ_i + θ_t)/cos(θ_i − θ_t), from tan and sin of eq. 21a: with the complex angle
    # of refraction, sinθ_t = sinθ_i/η, for metals and total reflection too.
    cosines = COSINES[1:-1]
    theta_i = np.arccos(cosines)
    theta_t = np.arcsin(np.sin(theta_i) / complex(eta))
    theta_t = np.where((eta * np.cos(theta_t)).imag < 0.0, np.conj(theta_t), theta_t)
    r_s, r_p = fresnel_amplitudes(cosines, 1.0, eta)
    expected = -np.cos(theta_i + theta_t) / np.cos(theta_i - theta_t)
    np.testing.assert_allclose(r_p / r_s, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("eta", [1.0 / 1.5, 1.0, 1.5, 2.4])
def test_no_light_is_lost_at_a_dielectric(eta: float) -> None:
    matrices = boundary_matrices(COSINES, 1.0, eta)
    total = matrices.reflection + matrices.transmission
    np.testing.assert_allclose(total[:, 0, 0], 1.0, rtol=0, atol=16.0 * EPS)
    np.testing.assert_allclose(total[:, 0, 1], 0.0, rtol=0, atol=16.0 * EPS)
    # det of the (U, V) block is that of (I, Q): pure light stays pure, M₂₂² + M₃₂² = R_s R_p.
    for matrix in matrices:
        pure = matrix[:, 0, 0] ** 2 - matrix[:, 0, 1] ** 2
        blocks = matrix[:, 2, 2] ** 2 + matrix[:, 3, 2] ** 2
        np.testing.assert_allclose(blocks, pure, rtol=0, atol=16.0 * EPS)


def test_equal_media_change_nothing() -> None:
    matrices = boundary_matrices(COSINES, 1.5, 1.5)
    assert not matrices.reflection.any()
    np.testing.assert_allclose(
        matrices.transmission, np.broadcast_to(np.eye(4), (len(COSINES), 4, 4)), atol=4.0 * EPS
    )


def test_malus() -> None:
    angles = np.linspace(0.0, math.pi, 37)
    through = polariser_matrix(angles) @ polariser_matrix(0.0) @ [1.0, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(through[:, 0], 0.5 * np.cos(angles) ** 2, atol=4.0 * EPS)
    np.testing.assert_allclose(degree_of_polarisation(through[::7]), 1.0, atol=1e-9)
    unpolarised = np.array([1.0, 0.0, 0.0, 0.0])
    assert (polariser_matrix(0.3) @ unpolarised)[0] == 0.5


def test_a_turned_polariser_is_one_in_a_turned_frame() -> None:
    for angle in (0.2, 1.1, 2.9):
        turned = rotation_matrix(-angle) @ polariser_matrix(0.0) @ rotation_matrix(angle)
        np.testing.assert_allclose(polariser_matrix(angle), turned, atol=4.0 * EPS)


@pytest.mark.parametrize("plates", [1, 2, 10])
def test_a_stack_of_plates_is_its_surfaces_one_by_one(plates: int) -> None:
    # Adding one surface (r, t) behind a stack (R, T): T' = T t/(1 − R r), R' = R + T² r/(1 − R r).
    theta = math.radians(50.0)
    found = plate_stack_transmittance(theta, 1.5, plates)
    for face, expected in zip(
        analytic.fresnel_reflectance(math.cos(theta), 1.0, 1.5), found, strict=True
    ):
        reflected, passed = 0.0, 1.0
        for _ in range(2 * plates):
            between = 1.0 - reflected * face
            reflected, passed = (
                reflected + passed * passed * face / between,
                passed * (1.0 - face) / between,
            )
        assert passed == pytest.approx(float(expected), rel=32.0 * EPS)
