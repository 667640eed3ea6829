import math
import pickle

import numpy as np
import pytest

from spectra import Absorption, SpectraError, WavelengthOutOfRange
from spectra.absorption import MAX_ALPHA_PER_M

EPS = np.finfo(np.float64).eps


def test_a_constant_is_known_everywhere() -> None:
    absorption = Absorption((3.0,))
    assert absorption.is_constant
    assert absorption.wavelength_range_nm == (0.0, math.inf)
    assert absorption.coefficient(1e6) == 3.0
    np.testing.assert_array_equal(absorption.coefficient(np.array([[1.0, 500.0]])), [[3.0, 3.0]])
    assert absorption.knots_nm.shape == absorption.alpha_per_m.shape == (1,)


def test_a_table_is_linear_between_its_knots_and_nothing_beyond() -> None:
    absorption = Absorption((1.0, 3.0, 0.0), (400.0, 500.0, 700.0))
    assert not absorption.is_constant
    found = absorption.coefficient(np.array([400.0, 425.0, 500.0, 600.0, 700.0]))
    np.testing.assert_allclose(found, [1.0, 1.5, 3.0, 1.5, 0.0], rtol=4 * EPS)
    for outside in (399.9, 700.1, math.nan):
        with pytest.raises(WavelengthOutOfRange, match="no absorption coefficient at"):
            absorption.coefficient(outside)


def test_napierian_and_decadic_coefficients_say_the_same() -> None:
    # 10^(-a d) = exp(-α d) with α = a ln 10: an absorbance a d of 1 leaves a tenth.
    decadic = Absorption.from_decadic((50.0,))
    assert decadic.transmittance(550.0, 0.02) == pytest.approx(0.1, rel=4 * EPS)
    assert decadic.coefficient(550.0) == pytest.approx(50.0 * math.log(10.0), rel=2 * EPS)


def test_an_internal_transmittance_is_met_at_its_thickness_and_squared_at_twice_that() -> None:
    transmittance, wavelengths = (0.5, 0.992, 1.0), (400.0, 500.0, 600.0)
    absorption = Absorption.from_internal_transmittance(
        transmittance, wavelengths, thickness_m=0.025
    )
    at = np.array(wavelengths)
    # exp(-α d) with α = -ln τ / d: rounding of the exponent x is x · ε, here below ε.
    np.testing.assert_allclose(absorption.transmittance(at, 0.025), transmittance, rtol=4 * EPS)
    np.testing.assert_allclose(
        absorption.transmittance(at, 0.05), np.square(transmittance), rtol=8 * EPS
    )
    assert absorption.coefficient(600.0) == 0.0
    assert math.copysign(1.0, absorption.napierian_per_m[-1]) == 1.0


def test_between_two_entries_it_is_the_logarithm_of_transmittance_that_is_linear() -> None:
    absorption = Absorption.from_internal_transmittance(
        (0.5, 0.9), (400.0, 500.0), thickness_m=0.01
    )
    expected = math.sqrt(0.5 * 0.9)
    assert absorption.transmittance(450.0, 0.01) == pytest.approx(expected, rel=4 * EPS)


def test_an_extinction_coefficient_is_divided_by_the_wavelength() -> None:
    # α = 4πk/λ (Born & Wolf 1999, §14.1): k = 1e-6 at 500 nm is 8π per metre.
    absorption = Absorption.from_extinction((1e-6, 1e-6), (250.0, 1000.0))
    wavelength_nm = np.linspace(250.0, 1000.0, 3001)
    expected = 4.0 * math.pi * 1e-6 / (wavelength_nm * 1e-9)
    # The chord over a step h = λ/250 of 1/λ lies above it by (h/λ)²/4 = 4e-6 at most.
    error = absorption.coefficient(wavelength_nm) / expected - 1.0
    assert np.all(error > -8 * EPS)
    assert 1e-6 < error.max() < 4e-6
    assert not absorption.is_constant


def test_a_table_of_k_is_linear_in_k() -> None:
    absorption = Absorption.from_extinction((0.0, 2e-6, 1e-6), (400.0, 500.0, 900.0))
    at = np.array([400.0, 450.0, 500.0, 700.0, 900.0])
    k = np.array([0.0, 1e-6, 2e-6, 1.5e-6, 1e-6])
    # k = a + bλ makes α = 4π(a/λ + b), and only the first part bends: by 4e-6 of it at most, with
    # |a| = 8e-6 below 500 nm and 3.25e-6 above.
    slack = 4e-6 * 4.0 * math.pi * np.array([8e-6, 8e-6, 8e-6, 3.25e-6, 3.25e-6]) / (at * 1e-9)
    error = absorption.coefficient(at) - 4.0 * math.pi * k / (at * 1e-9)
    assert np.all(np.abs(error) <= slack)
    np.testing.assert_allclose(error[[0, 2, 4]], 0.0, atol=1e-13)
    np.testing.assert_array_equal(np.isin([400.0, 500.0, 900.0], absorption.knots_nm), True)


def test_what_nothing_passes_is_finite() -> None:
    assert Absorption((math.inf,)).coefficient(500.0) == MAX_ALPHA_PER_M
    assert np.isfinite(np.float32(MAX_ALPHA_PER_M))
    huge = Absorption.from_extinction((1e308, 1e308), (400.0, 700.0))
    assert huge.coefficient(500.0) == MAX_ALPHA_PER_M
    assert huge.transmittance(500.0, 1e-9) == 0.0


def test_equal_absorptions_are_equal_and_survive_pickling() -> None:
    one = Absorption.from_decadic((1.0, 2.0), (400.0, 500.0))
    assert one == Absorption.from_decadic([1.0, 2.0], [400.0, 500.0])
    assert hash(one) == hash(pickle.loads(pickle.dumps(one)))
    assert not one.is_transparent
    assert Absorption((0.0, 0.0), (400.0, 500.0)).is_transparent


def test_the_arrays_cannot_be_written_to() -> None:
    absorption = Absorption((1.0, 3.0), (400.0, 500.0))
    for values in (absorption.knots_nm, absorption.alpha_per_m):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0


@pytest.mark.parametrize(
    ("alpha", "wavelength_nm", "message"),
    [
        ((-1.0,), (), "coefficient -1 per metre; allowed: 0 or more"),
        ((math.nan,), (), "coefficient nan"),
        ((), (), "0 coefficients at 0 wavelengths"),
        ((1.0, 2.0), (), "2 coefficients at 0 wavelengths"),
        ((1.0,), (500.0,), "1 coefficients at 1 wavelengths"),
        ((1.0, 2.0), (500.0, 500.0), "strictly increasing"),
        ((1.0, 2.0), (0.0, 500.0), "above 0"),
        ((1.0, 2.0), (400.0, math.inf), "finite"),
    ],
)
def test_numbers_that_are_no_absorption(
    alpha: tuple[float, ...], wavelength_nm: tuple[float, ...], message: str
) -> None:
    with pytest.raises(SpectraError, match=message):
        Absorption(alpha, wavelength_nm)


@pytest.mark.parametrize("tau", [0.0, -0.1, 1.0001, math.nan])
def test_transmittances_that_fix_no_coefficient(tau: float) -> None:
    with pytest.raises(SpectraError, match="allowed: above 0, at most 1"):
        Absorption.from_internal_transmittance((tau,), thickness_m=0.01)


@pytest.mark.parametrize("thickness_m", [0.0, -0.01, math.inf, math.nan])
def test_thicknesses_that_are_none(thickness_m: float) -> None:
    with pytest.raises(SpectraError, match="thickness"):
        Absorption.from_internal_transmittance((0.5,), thickness_m=thickness_m)


@pytest.mark.parametrize(
    ("k", "wavelength_nm", "message"),
    [
        ((1e-6,), (500.0,), "2 or more"),
        ((1e-6, 1e-6), (500.0, 400.0), "strictly increasing"),
        ((1e-6, 1e-6), (0.0, 400.0), "above 0"),
        ((1e-6,), (400.0, 500.0), "1 extinction coefficients at 2 wavelengths"),
        ((1e-6, -1e-6), (400.0, 500.0), "coefficient -1e-06; allowed: 0 or more"),
        ((1e-6, math.nan), (400.0, 500.0), "coefficient nan"),
    ],
)
def test_extinction_coefficients_that_are_none(
    k: tuple[float, ...], wavelength_nm: tuple[float, ...], message: str
) -> None:
    with pytest.raises(SpectraError, match=message):
        Absorption.from_extinction(k, wavelength_nm)


@pytest.mark.parametrize("length_m", [-1.0, math.inf, math.nan])
def test_a_way_of_no_length(length_m: float) -> None:
    with pytest.raises(SpectraError, match="allowed: 0 or more, finite"):
        Absorption((1.0,)).transmittance(500.0, length_m)
