import numpy as np
import pytest

from spectra import SpectraError
from spectra.piecewise import band_edges, integrate_bands, interpolate

KNOTS = np.array([400.0, 410.0, 430.0, 500.0])
VALUES = np.array([1.0, 3.0, 0.5, 2.0])


@pytest.mark.parametrize(
    "edges", [[], [400.0], [400.0, 400.0], [500.0, 400.0], [400.0, float("nan")], [[1.0, 2.0]]]
)
def test_edges_that_are_no_bands_are_refused(edges: list[float]) -> None:
    with pytest.raises(SpectraError, match="band edges"):
        band_edges(edges)


def test_infinite_edges_are_refused() -> None:
    with pytest.raises(SpectraError, match="finite"):
        band_edges([400.0, float("inf")])


def test_the_function_is_linear_between_knots_and_zero_outside() -> None:
    at = np.array([[399.9, 400.0, 405.0], [420.0, 500.0, 500.1]])
    # Means of neighbours half-way: (1 + 3) / 2 and (3 + 0.5) / 2.
    expected = [[0.0, 1.0, 2.0], [1.75, 2.0, 0.0]]
    np.testing.assert_array_equal(interpolate(at, KNOTS, VALUES), expected)


def test_columns_are_interpolated_each_by_itself() -> None:
    columns = np.column_stack([VALUES, 2.0 * VALUES])
    single = interpolate(np.array([405.0, 460.0]), KNOTS, VALUES)
    both = interpolate(np.array([405.0, 460.0]), KNOTS, columns)
    np.testing.assert_array_equal(both, np.column_stack([single, 2.0 * single]))


def test_bands_hold_the_exact_integral_of_each_piece() -> None:
    # Trapezoids by hand: 400-405 (1+2)/2*5; 405-420 has a knot at 410; 420-600 ends at 500.
    edges = np.array([300.0, 405.0, 420.0, 600.0])
    expected = [
        0.5 * 5 * (1 + 2),
        0.5 * 5 * (2 + 3) + 0.5 * 10 * (3 + 1.75),
        0.5 * 10 * (1.75 + 0.5) + 0.5 * 70 * (0.5 + 2),
    ]
    np.testing.assert_allclose(integrate_bands(edges, KNOTS, VALUES), expected, rtol=1e-15)


@pytest.mark.parametrize("edges", [[100.0, 200.0, 400.0], [500.0, 510.0]])
def test_bands_beside_the_knots_are_empty(edges: list[float]) -> None:
    assert not integrate_bands(np.array(edges), KNOTS, VALUES).any()


def test_a_narrow_band_keeps_its_digits() -> None:
    # A difference of running integrals (total 117.5) would err by about 1e-14, here 1e-5 relative.
    band = integrate_bands(np.array([405.0, 405.0 + 2.0**-30]), KNOTS, VALUES)
    # The integral of 2 + 0.2 t from 0 to h.
    h = 2.0**-30
    np.testing.assert_allclose(band, [2.0 * h + 0.1 * h * h], rtol=1e-15)
