import numpy as np
import pytest

from sim.errors import SettingsError
from sim.photons.energy import EnergyBooks
from sim.study.metrics import (
    centroid_error,
    ciede2000,
    energy_residual,
    relative_l2,
    tempered_error,
)
from spectra import xyz_to_linear_srgb


def test_relative_l2_is_the_norm_of_the_difference():
    # √((1² + 2²)/(3² + 4²)) = √5/5.
    assert relative_l2([[4.0], [2.0]], [[3.0], [4.0]]) == pytest.approx(np.sqrt(5.0) / 5.0)
    with pytest.raises(SettingsError, match="shape"):
        relative_l2(np.zeros(3), np.ones((3, 1)))
    with pytest.raises(SettingsError, match="reference: 'all zero'"):
        relative_l2(np.ones(3), np.zeros(3))


def test_the_tempered_error_weighs_a_pixel_by_itself_and_the_mean():
    # Reference 1 and 3, mean 2: √(((0.3/(1 + 2))² + (1/(3 + 2))²)/2) = √((0.01 + 0.04)/2).
    assert tempered_error([1.3, 2.0], [1.0, 3.0]) == pytest.approx(np.sqrt(0.025))
    with pytest.raises(SettingsError, match="reference: 'all zero'"):
        tempered_error(np.ones(3), np.zeros(3))


def grey(lightness):
    """Linear sRGB of CIE L* (CIE 015:2018, eq. 8.3): Y = ((L* + 16)/116)³, L* > 8."""
    return np.full((1, 1, 3), ((lightness + 16.0) / 116.0) ** 3)


def test_ciede2000_of_greys_is_the_lightness_step_over_its_weight():
    # CIE 142:2001: ΔE₀₀ = ΔL*/S_L, S_L = 1 + 0.015 (L̄ − 50)²/√(20 + (L̄ − 50)²), a* = b* = 0.
    middle, step = 60.0, 2.0
    weight = 1.0 + 0.015 * 100.0 / np.sqrt(120.0)
    found = ciede2000(grey(middle + 1.0), grey(middle - 1.0), exposure_stops=0.0)
    # sRGB's white is (1, 1, 1) to 4 digits.
    assert found.mean == pytest.approx(step / weight, rel=1e-3)
    assert found.p95 == found.mean


def test_both_pictures_are_exposed_alike_and_shown_in_gamut():
    # Darker by two stops and exposed by two; far above white, both are white.
    found = ciede2000(grey(61.0) / 4.0, grey(59.0) / 4.0, exposure_stops=2.0)
    assert found.mean == pytest.approx(ciede2000(grey(61.0), grey(59.0), exposure_stops=0.0).mean)
    assert ciede2000(grey(300.0), grey(400.0), exposure_stops=0.0).mean < 1e-6
    # 500 nm, which sRGB cannot show, is not the same clipped as desaturated.
    green = np.tile(xyz_to_linear_srgb([0.0049, 0.323, 0.272]), (1, 1, 1))
    one = ciede2000(green, grey(60.0), exposure_stops=0.0, gamut="clip").mean
    other = ciede2000(green, grey(60.0), exposure_stops=0.0).mean
    assert abs(one - other) > 1.0


def test_p95_leaves_the_worst_twentieth_out():
    reference = np.repeat(grey(50.0), 100, axis=0)
    estimate = reference.copy()
    estimate[:10] = grey(70.0)
    found = ciede2000(estimate, reference, exposure_stops=0.0)
    worst = ciede2000(grey(70.0), grey(50.0), exposure_stops=0.0).mean
    assert found.p95 == pytest.approx(worst)
    assert found.mean == pytest.approx(0.1 * worst)
    estimate[4:10] = grey(50.0)
    assert ciede2000(estimate, reference, exposure_stops=0.0).p95 == pytest.approx(0.0, abs=1e-9)


def test_centroids_are_compared_as_angles():
    # Bins 1 mm apart, 10 m away, straight ahead: a bin is 1e-4 rad or 20.626″.
    centres = np.zeros((1, 5, 3))
    centres[0, :, 0], centres[..., 2] = np.arange(5) * 1e-3 - 2e-3, 10.0
    reference, estimate = np.zeros((1, 5, 3)), np.zeros((1, 5, 3))
    reference[0, 2, :2] = 1.0  # in the middle
    estimate[0, 3, 0] = 7.0  # one bin aside
    estimate[0, [2, 3], 1] = 3.0, 1.0  # a quarter
    found = centroid_error(estimate, reference, centres, np.zeros(3))
    second = np.degrees(np.arctan([1e-4, 0.25e-4])) * 3600.0
    np.testing.assert_allclose(found, [*second, np.nan], rtol=1e-9)


def test_the_energy_residual_has_no_sign():
    books = EnergyBooks(emitted=2.0, deposited=1.0, absorbed=0.5, escaped=0.5, culled=0.1)
    assert energy_residual(books) == pytest.approx(0.05)
    assert energy_residual(EnergyBooks(0.0, 0.0, 0.0, 0.0, 0.0)) == 0.0
