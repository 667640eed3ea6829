import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spectra import EmissionSpectrum, SpectraError

LAMP = EmissionSpectrum(
    name="lamp",
    wavelength_nm=np.array([400.0, 450.0, 470.0, 600.0, 700.0]),
    density=np.array([0.0, 2.0, 5.0, 1.0, 3.0]),
    line_wavelength_nm=np.array([435.8, 546.1, 700.0]),
    line_flux=np.array([10.0, 20.0, 30.0]),
)
LINES_ONLY = EmissionSpectrum(
    name="lines", line_wavelength_nm=np.array([500.0]), line_flux=np.array([2.0])
)
# Trapezoids by hand, and the lines.
CONTINUOUS = 0.5 * (50 * 2 + 20 * 7 + 130 * 6 + 100 * 4)


def test_total_is_the_density_and_the_lines() -> None:
    assert LAMP.total == CONTINUOUS + 60.0
    assert LINES_ONLY.total == 2.0


def test_support_reaches_from_first_to_last_knot_or_line() -> None:
    assert LAMP.support_nm == (400.0, 700.0)
    assert LINES_ONLY.support_nm == (500.0, 500.0)


def test_density_is_linear_and_zero_outside_and_ignores_lines() -> None:
    at = np.array([[399.0, 400.0, 425.0], [460.0, 700.0, 701.0]])
    assert LAMP.density_at(at).tolist() == [[0.0, 0.0, 1.0], [3.5, 3.0, 0.0]]
    assert LAMP.density_at(546.1) == pytest.approx(5.0 - 4.0 * 76.1 / 130.0, rel=1e-15)
    assert type(LAMP.density_at(425.0)) is float
    assert LINES_ONLY.density_at(500.0) == 0.0


def test_a_band_holds_its_exact_integral() -> None:
    # Against a midpoint rule, exact for straight lines: its cells of 1/8 nm have every knot and
    # edge on a border.
    edges = np.array([390.0, 430.0, 444.0, 480.0, 555.0, 699.0])
    cell = 0.125
    middles = np.arange(390.0 + cell / 2, 699.0, cell)
    dense = np.histogram(middles, bins=edges, weights=LAMP.density_at(middles) * cell)[0]
    lines = [0.0, 10.0, 0.0, 20.0, 0.0]
    np.testing.assert_allclose(LAMP.band_flux(edges), dense + lines, rtol=1e-13)


def test_a_line_on_an_edge_belongs_to_the_band_above() -> None:
    assert LINES_ONLY.band_flux([490.0, 500.0, 510.0]).tolist() == [0.0, 2.0]


def test_a_line_on_the_last_edge_belongs_to_the_last_band() -> None:
    assert LINES_ONLY.band_flux([480.0, 490.0, 500.0]).tolist() == [0.0, 2.0]


def test_lines_outside_the_bands_are_not_counted() -> None:
    assert LINES_ONLY.band_flux([400.0, 450.0]).tolist() == [0.0]


@settings(deadline=None)
@given(st.lists(st.floats(401.0, 699.0), max_size=20, unique=True))
def test_bands_that_cover_the_support_add_up_to_the_total(inner: list[float]) -> None:
    edges = np.array([400.0, *sorted(inner), 700.0])
    # A few roundings of the whole at most, whatever the number of bands.
    assert LAMP.band_flux(edges).sum() == pytest.approx(LAMP.total, rel=1e-14)


def test_restricting_cuts_exactly_and_rescales_nothing() -> None:
    part = LAMP.restricted(425.0, 535.0)
    assert part.support_nm == (425.0, 535.0)
    assert part.wavelength_nm.tolist() == [425.0, 450.0, 470.0, 535.0]
    assert part.density.tolist() == [1.0, 2.0, 5.0, 3.0]
    assert part.line_wavelength_nm.tolist() == [435.8]
    assert part.total == pytest.approx(float(LAMP.band_flux([425.0, 535.0])[0]), rel=1e-15)
    assert part.name == LAMP.name


def test_restricting_to_more_than_there_is_changes_nothing() -> None:
    same = LAMP.restricted(100.0, 1000.0)
    for attribute in ("wavelength_nm", "density", "line_wavelength_nm", "line_flux"):
        np.testing.assert_array_equal(getattr(same, attribute), getattr(LAMP, attribute))


def test_restricting_keeps_lines_on_both_ends() -> None:
    assert LAMP.restricted(435.8, 546.1).line_flux.tolist() == [10.0, 20.0]


def test_restricting_to_one_wavelength_leaves_its_line() -> None:
    line = LAMP.restricted(546.1, 546.1)
    assert line.total == 20.0
    assert line.wavelength_nm.shape == (0,)


@pytest.mark.parametrize(("low", "high"), [(701.0, 800.0), (300.0, 400.0), (500.0, 500.0)])
def test_restricting_to_nothing_is_an_error(low: float, high: float) -> None:
    with pytest.raises(SpectraError, match="lamp: no light between"):
        LAMP.restricted(low, high)


@pytest.mark.parametrize(("low", "high"), [(600.0, 500.0), (float("nan"), 500.0)])
def test_an_interval_is_an_interval(low: float, high: float) -> None:
    with pytest.raises(SpectraError, match="low <= high"):
        LAMP.restricted(low, high)


@pytest.mark.parametrize(
    ("wavelengths", "values", "problem"),
    [
        ([400.0, 500.0], [1.0], "same length"),
        ([[400.0, 500.0]], [[1.0, 1.0]], "one list"),
        ([400.0], [1.0], "2 or more"),
        ([500.0, 400.0], [1.0, 1.0], "strictly increasing"),
        ([400.0, 400.0], [1.0, 1.0], "strictly increasing"),
        ([0.0, 400.0], [1.0, 1.0], "above 0"),
        ([400.0, np.inf], [1.0, 1.0], "finite"),
        ([400.0, 500.0], [1.0, -1.0], "0 or more"),
        ([400.0, 500.0], [1.0, np.nan], "finite"),
        ([400.0, 500.0], [0.0, 0.0], "total flux 0"),
        ([], [], "total flux 0"),
    ],
)
def test_what_is_no_spectrum_is_refused(
    wavelengths: list[float], values: list[float], problem: str
) -> None:
    with pytest.raises(SpectraError, match=f"mine.*{problem}"):
        EmissionSpectrum("mine", np.array(wavelengths), np.array(values))


def test_lines_must_increase() -> None:
    with pytest.raises(SpectraError, match="line_wavelength_nm must be"):
        EmissionSpectrum(
            "mine", line_wavelength_nm=np.array([2.0, 1.0]), line_flux=np.array([1.0, 1.0])
        )


def test_arrays_are_copied_and_frozen() -> None:
    density = np.array([1.0, 2.0])
    mine = EmissionSpectrum("mine", np.array([400.0, 500.0]), density)
    density[0] = 9.0
    assert mine.density.tolist() == [1.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        mine.density[0] = 9.0


def test_a_spectrum_survives_the_way_between_processes() -> None:
    copy = pickle.loads(pickle.dumps(LAMP))
    assert copy.total == LAMP.total
    assert copy.name == LAMP.name
