import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spectra import Cauchy, Dispersion, Sellmeier, SpectraError, Tabulated, WavelengthOutOfRange
from spectra import air_index as ciddor_air_index

ULP = float(np.spacing(1.5))

TABLE = Tabulated(
    wavelength_nm=(400.0, 450.0, 500.0, 587.0, 700.0), index=(1.53, 1.525, 1.5214, 1.5168, 1.513)
)
ALL_KINDS = [
    Sellmeier(b=(1.04, 0.23), c_um2=(0.006, 0.02)),
    Cauchy(a=(1.5, 0.004)),
    TABLE,
]


@pytest.mark.parametrize("dispersion", ALL_KINDS)
def test_the_answer_has_the_kind_and_shape_of_the_question(dispersion: Dispersion) -> None:
    grid = np.linspace(400.0, 700.0, 6).reshape(2, 3)
    answer = dispersion.eta(grid)
    assert answer.shape == (2, 3)
    assert answer.dtype == np.float64
    assert type(dispersion.eta(450.0)) is float
    assert dispersion.eta(float(grid[1, 2])) == answer[1, 2]
    assert dispersion.eta(np.array([])).shape == (0,)


def test_sellmeier_is_its_formula() -> None:
    # n² - 1 = Σ B λ² / (λ² - C) at λ = 0.5 µm: 1·0.25/(0.25 - 0.01) + 0.5·0.25/(0.25 - 0.05).
    glass = Sellmeier(b=(1.0, 0.5), c_um2=(0.01, 0.05))
    expected = math.sqrt(1.0 + 0.25 / 0.24 + 0.125 / 0.20)
    assert glass.eta(500.0) == pytest.approx(expected, rel=4 * ULP)


def test_sellmeier_from_printed_roots_squares_them() -> None:
    assert Sellmeier.from_roots(b=(1.0,), c_um=(0.1,)) == Sellmeier(b=(1.0,), c_um2=(0.1 * 0.1,))
    resonances_nm = Sellmeier.from_roots(b=(1.0, 2.0), c_um=(9.0, 0.1)).resonances_nm
    assert resonances_nm == pytest.approx((100.0, 9000.0))


def test_cauchy_is_its_formula() -> None:
    # n = a0 + a1 λ⁻² + a2 λ⁻⁴ at λ = 0.5 µm, where λ⁻² = 4 exactly.
    assert Cauchy(a=(1.5, 0.01, 0.002)).eta(500.0) == pytest.approx(1.5 + 0.04 + 0.032, rel=2e-16)


def test_one_cauchy_term_is_a_constant() -> None:
    constant = Cauchy(a=(1.5,))
    assert not constant.is_dispersive
    assert constant.eta(np.array([1.0, 500.0, 1e6])).tolist() == [1.5, 1.5, 1.5]


@pytest.mark.parametrize(
    ("dispersion", "is_dispersive"),
    [
        (Cauchy(a=(1.5, 0.0)), False),
        (Cauchy(a=(1.5, 0.0, 1e-9)), True),
        (Sellmeier(b=(1.25,), c_um2=(0.0,)), False),
        (Sellmeier(b=(1.25,), c_um2=(0.01,)), True),
        (Tabulated(wavelength_nm=(400.0, 700.0), index=(1.5, 1.5)), False),
        (TABLE, True),
    ],
)
def test_dispersion_is_known_without_a_wavelength(
    dispersion: Dispersion, is_dispersive: bool
) -> None:
    assert dispersion.is_dispersive is is_dispersive


@pytest.mark.parametrize(
    ("dispersion", "wavelength_nm"),
    [
        (Sellmeier(b=(1.0,), c_um2=(0.25,)), 500.0),  # On the resonance.
        (Sellmeier(b=(1.0,), c_um2=(0.25,)), 400.0),  # n² = 1 + 0.16 / -0.09 < 0.
        (Sellmeier(b=(1.0,), c_um2=(0.01,)), -500.0),
        (Cauchy(a=(1.5,)), float("nan")),
        (Cauchy(a=(1.5,)), 0.0),
        (Cauchy(a=(1.5, 0.01)), 0.0),
        (Cauchy(a=(1.0, -0.3)), 500.0),
    ],
)
def test_no_index_is_an_error_and_never_a_number(
    dispersion: Dispersion, wavelength_nm: float
) -> None:
    with pytest.raises(SpectraError, match=f"no refractive index at {wavelength_nm:g} nm"):
        dispersion.eta(wavelength_nm)
    with pytest.raises(SpectraError, match=f"no refractive index at {wavelength_nm:g} nm"):
        dispersion.eta(np.array([650.0, wavelength_nm]))


@pytest.mark.parametrize("terms", [0, 5])
def test_formulas_have_one_to_four_terms(terms: int) -> None:
    with pytest.raises(SpectraError, match="1 to 4"):
        Cauchy(a=(1.0,) * terms)
    with pytest.raises(SpectraError, match="1 to 4"):
        Sellmeier(b=(1.0,) * terms, c_um2=(0.01,) * terms)


def test_sellmeier_needs_as_many_of_each() -> None:
    with pytest.raises(SpectraError, match="2 terms and c_um2 has 1"):
        Sellmeier(b=(1.0, 2.0), c_um2=(0.01,))


def test_coefficients_must_be_numbers() -> None:
    with pytest.raises(SpectraError, match="finite"):
        Sellmeier(b=(float("inf"),), c_um2=(0.01,))
    with pytest.raises(SpectraError, match="above 0"):
        Cauchy(a=(-1.5,))


@pytest.mark.parametrize(
    ("wavelength_nm", "index"),
    [
        ((400.0,), (1.5,)),
        ((400.0, 500.0), (1.5,)),
        ((500.0, 400.0), (1.5, 1.6)),
        ((400.0, 400.0), (1.5, 1.6)),
        ((0.0, 400.0), (1.5, 1.6)),
        ((400.0, 500.0), (1.5, 0.0)),
        ((400.0, float("nan")), (1.5, 1.6)),
    ],
)
def test_tables_that_are_no_index_are_refused(
    wavelength_nm: tuple[float, ...], index: tuple[float, ...]
) -> None:
    with pytest.raises(SpectraError, match="tab"):
        Tabulated(wavelength_nm=wavelength_nm, index=index)


def test_a_table_returns_its_samples_and_stays_between_them() -> None:
    assert TABLE.eta(TABLE.knots_nm).tolist() == pytest.approx(TABLE.index, rel=ULP)
    fine = TABLE.eta(np.linspace(400.0, 700.0, 3001))
    assert np.all(np.diff(fine) < 0.0)  # The samples fall, so must the interpolant.


def test_the_table_is_the_cubic_of_fritsch_and_carlson() -> None:
    # Independent of the coefficients: SciPy evaluates the same interpolant in its own basis.
    from scipy.interpolate import PchipInterpolator

    at = np.linspace(400.0, 700.0, 10_001)
    expected = PchipInterpolator(np.array(TABLE.wavelength_nm), np.array(TABLE.index))(at)
    np.testing.assert_allclose(TABLE.eta(at), expected, rtol=0, atol=2 * ULP)


def test_coefficients_are_what_a_device_needs_to_evaluate_the_table() -> None:
    assert TABLE.coefficients.shape == (len(TABLE.knots_nm) - 1, 4)
    at = np.linspace(400.0, 700.0, 1001)
    by_hand = []
    for wavelength in at:
        row = next(
            row
            for row in reversed(range(len(TABLE.knots_nm) - 1))
            if TABLE.knots_nm[row] <= wavelength
        )
        by_hand.append(np.polyval(TABLE.coefficients[row], wavelength - TABLE.knots_nm[row]))
    # Two orders of the same Horner scheme: rounding of one multiply-add at most.
    np.testing.assert_allclose(TABLE.eta(at), by_hand, rtol=0, atol=ULP)


def test_two_samples_are_a_straight_line() -> None:
    line = Tabulated(wavelength_nm=(400.0, 600.0), index=(1.5, 1.6))
    assert line.eta(450.0) == pytest.approx(1.525, rel=2 * ULP)


@pytest.mark.parametrize("wavelength_nm", [399.999, 700.001, float("nan")])
def test_a_table_is_not_extrapolated(wavelength_nm: float) -> None:
    with pytest.raises(WavelengthOutOfRange):
        TABLE.eta(wavelength_nm)


@settings(deadline=None)
@given(
    st.lists(st.floats(1.01, 3.0), min_size=2, max_size=12),
    st.floats(0.0, 1.0),
)
def test_a_table_never_overshoots(index: list[float], share: float) -> None:
    knots = 400.0 + 10.0 * np.arange(len(index))
    table = Tabulated(wavelength_nm=tuple(knots), index=tuple(index))
    at = float(knots[0] + share * (knots[-1] - knots[0]))
    row = min(int((at - 400.0) // 10.0), len(index) - 2)
    low, high = sorted(index[row : row + 2])
    # Horner's three multiply-adds round by a few ulps of the largest intermediate.
    slack = 16 * float(np.spacing(3.0))
    assert low - slack <= table.eta(at) <= high + slack


def test_standard_air_turns_vacuum_wavelengths_into_published_ones() -> None:
    # NIST, Handbook of Basic Atomic Spectroscopic Data: sodium D2 and D1 in vacuum and in air. Its
    # air holds some 120 ppm less CO2 (Peck and Reeder 1972), by Ciddor (1996), eq. 2, a factor
    # 1 - 0.534e-6 · 120 on n - 1: 1.8e-8.
    for vacuum_nm, air_nm in ((589.1583264, 588.9950954), (589.7558147, 589.5924237)):
        assert ciddor_air_index(vacuum_nm) == pytest.approx(vacuum_nm / air_nm, abs=2e-8)


def test_standard_air_falls_with_wavelength_and_knows_its_range() -> None:
    index = ciddor_air_index(np.linspace(230.0, 1690.0, 50))
    assert np.all(np.diff(index) < 0.0)
    with pytest.raises(WavelengthOutOfRange, match="standard air"):
        ciddor_air_index(0.55)
