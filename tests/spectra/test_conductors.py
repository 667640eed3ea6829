import math
import pickle

import numpy as np
import pytest

from spectra import (
    Conductor,
    SpectraError,
    UnknownConductor,
    WavelengthOutOfRange,
    conductor,
    conductors,
)


@pytest.mark.parametrize("name", conductors())
def test_the_tables_cover_the_visible_and_name_their_source(name: str) -> None:
    metal = conductor(name)
    low, high = metal.wavelength_range_nm
    assert low < 360.0
    assert high > 830.0
    assert metal.name == name
    assert "(19" in metal.source
    assert metal == pickle.loads(pickle.dumps(metal))


@pytest.mark.parametrize(
    ("name", "electronvolt", "eta", "k"),
    [
        # Johnson & Christy (1972), table I, by photon energy.
        ("copper", 2.26, 1.02, 2.577), ("copper", 1.88, 0.22, 3.747),
        ("silver", 2.26, 0.06, 3.586), ("silver", 3.74, 0.17, 0.829),
        ("gold", 2.26, 0.43, 2.455), ("gold", 2.50, 1.04, 1.833), ("gold", 0.64, 0.92, 13.78),
        # Rakić (1995), table 2, by photon energy.
        ("aluminium", 2.40, 0.8734, 6.2418), ("aluminium", 1.56, 2.7675, 8.3866),
    ],
)  # fmt: skip
def test_published_entries(name: str, electronvolt: float, eta: float, k: float) -> None:
    metal = conductor(name)
    # λ = hc/E, 1239.84 eV nm; the printed wavelengths are rounded to 4 or 5 digits.
    wavelength_nm = 1239.84193 / electronvolt
    nearest = metal.knots_nm[np.argmin(np.abs(metal.knots_nm - wavelength_nm))]
    assert nearest == pytest.approx(wavelength_nm, rel=5e-4)
    assert metal.eta(float(nearest)) == eta
    assert metal.k(float(nearest)) == k


def test_the_entries_of_johnson_and_christy_are_at_their_photon_energies() -> None:
    # 49 energies from 0.64 to 6.60 eV, printed to 0.01 eV, in steps of 0.12 or 0.13 eV.
    energies = 1239.84193 / conductor("gold").knots_nm
    assert len(energies) == 49
    np.testing.assert_allclose(energies, np.round(energies, 2), rtol=5e-4)
    steps = np.round(-np.diff(np.round(energies, 2)), 2)
    assert set(steps) == {0.12, 0.13}


def test_between_entries_it_is_linear() -> None:
    metal = Conductor("x", (400.0, 500.0), (1.0, 2.0), (3.0, 5.0), "made up")
    assert metal.eta(425.0) == 1.25
    np.testing.assert_array_equal(metal.k(np.array([[400.0, 450.0]])), [[3.0, 4.0]])


@pytest.mark.parametrize("wavelength_nm", [399.0, 501.0, math.nan, 0.45])
def test_outside_it_is_an_error(wavelength_nm: float) -> None:
    metal = Conductor("x", (400.0, 500.0), (1.0, 2.0), (3.0, 5.0), "made up")
    for ask in (metal.eta, metal.k):
        with pytest.raises(WavelengthOutOfRange, match="400 to 500 nm"):
            ask(wavelength_nm)


def test_a_metal_that_is_not_there() -> None:
    with pytest.raises(UnknownConductor, match="unknown metal 'aluminum'; nearest: aluminium"):
        conductor("aluminum")


@pytest.mark.parametrize(
    ("wavelength_nm", "eta", "k", "message"),
    [
        ((400.0,), (1.0,), (1.0,), "2 or more"),
        ((400.0, 500.0), (1.0,), (1.0, 1.0), "as many of each"),
        ((400.0, 500.0), (1.0, 1.0), (1.0,), "as many of each"),
        ((500.0, 400.0), (1.0, 1.0), (1.0, 1.0), "strictly increasing"),
        ((0.0, 400.0), (1.0, 1.0), (1.0, 1.0), "above 0"),
        ((400.0, 500.0), (1.0, 0.0), (1.0, 1.0), "eta above 0"),
        ((400.0, 500.0), (1.0, 1.0), (1.0, -0.1), "k 0 or more"),
        ((400.0, 500.0), (1.0, 1.0), (1.0, math.nan), "finite"),
    ],
)
def test_tables_that_are_no_metal(
    wavelength_nm: tuple[float, ...], eta: tuple[float, ...], k: tuple[float, ...], message: str
) -> None:
    with pytest.raises(SpectraError, match=message):
        Conductor("x", wavelength_nm, eta, k, "made up")
