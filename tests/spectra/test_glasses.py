import math
from typing import Any

import numpy as np
import pytest

from spectra import (
    Cauchy,
    Medium,
    Sellmeier,
    SpectraError,
    Tabulated,
    UnknownGlass,
    WavelengthOutOfRange,
    glass,
    glasses,
)
from spectra.units import FRAUNHOFER_C_NM, FRAUNHOFER_D_NM, FRAUNHOFER_F_NM

# Printed by the sources or by refractiveindex.info from the same coefficients; the tolerance is
# half a unit of the last digit printed.
PUBLISHED = [
    ("N-BK7", "1.51680", "64.17", (300.0, 2500.0), "air"),
    ("SF11", "1.78472", "25.76", (390.0, 2500.0), "air"),
    ("N-SF11", "1.78472", "25.68", (370.0, 2500.0), "air"),
    ("F2", "1.62004", "36.37", (320.0, 2500.0), "air"),
    ("fused silica", "1.458464", "67.82", (210.0, 3710.0), "air"),
    ("CaF2", "1.433849", "95.00", (230.0, 9700.0), "air"),
    ("sapphire", "1.768172", "72.31", (200.0, 5000.0), "air"),
    ("diamond", "2.417486", "55.30", (226.0, 760.0), "air"),
    ("water", "1.333403", "55.76", (182.0, 1129.0), "vacuum"),
]


def agrees(value: float, printed: str) -> bool:
    decimals = len(printed.partition(".")[2])
    return abs(value - float(printed)) <= 0.5 * 10.0**-decimals


@pytest.mark.parametrize(("name", "n_d", "abbe", "range_nm", "relative_to"), PUBLISHED)
def test_published_index_and_abbe_number(
    name: str, n_d: str, abbe: str, range_nm: tuple[float, float], relative_to: str
) -> None:
    medium = glass(name)
    assert agrees(medium.n_d, n_d)
    assert agrees(medium.abbe_number, abbe)
    assert medium.wavelength_range_nm == range_nm
    assert medium.relative_to == relative_to
    assert medium.name == name
    assert medium.source
    assert medium.is_dispersive


def test_every_medium_is_held_to_its_published_values() -> None:
    assert set(glasses()) == {name for name, *_ in PUBLISHED}


def test_bk7_at_the_fraunhofer_lines(references: dict[str, Any]) -> None:
    published = references["N-BK7"]
    bk7 = glass("N-BK7")
    for line, wavelength_nm in references["lines_nm"].items():
        # 8 decimals are printed.
        assert bk7.eta(wavelength_nm) == pytest.approx(published["n"][line], abs=0.5e-8)
    assert bk7.abbe_number == pytest.approx(published["V_d"], abs=0.5e-6)


def test_the_fraunhofer_lines_are_the_published_ones(references: dict[str, Any]) -> None:
    assert references["lines_nm"] == {
        "F": FRAUNHOFER_F_NM,
        "d": FRAUNHOFER_D_NM,
        "C": FRAUNHOFER_C_NM,
    }


@pytest.mark.parametrize("name", glasses())
def test_dispersion_is_normal_over_the_whole_range(name: str) -> None:
    medium = glass(name)
    index = medium.eta(np.geomspace(*medium.wavelength_range_nm, 1001)[1:-1])
    assert np.all(np.diff(index) < 0.0)
    assert np.all(index > 1.0)


@pytest.mark.parametrize("name", glasses())
def test_the_ends_of_the_range_are_inside_and_nothing_beyond(name: str) -> None:
    medium = glass(name)
    low, high = medium.wavelength_range_nm
    assert medium.eta(np.array([low, high])).shape == (2,)
    for outside in (math.nextafter(low, 0.0), math.nextafter(high, math.inf), math.nan):
        with pytest.raises(WavelengthOutOfRange, match="no refractive index"):
            medium.eta(outside)


def test_an_array_names_its_first_wavelength_outside() -> None:
    with pytest.raises(WavelengthOutOfRange) as raised:
        glass("N-BK7").eta(np.array([[500.0, 299.0], [4000.0, 600.0]]))
    assert raised.value.wavelength_nm == 299.0
    assert raised.value.medium == "N-BK7"
    assert raised.value.range_nm == (300.0, 2500.0)


def test_micrometres_are_noticed() -> None:
    with pytest.raises(WavelengthOutOfRange, match=r"0\.5876 looks like micrometres.*587\.6"):
        glass("N-BK7").eta(0.5876)


@pytest.mark.parametrize("name", ["BK9", "n-bk7", "N-BK7 ", ""])
def test_names_are_exact(name: str) -> None:
    with pytest.raises(UnknownGlass, match="N-BK7"):
        glass(name)


def test_sf11_is_not_n_sf11() -> None:
    assert glass("SF11").dispersion != glass("N-SF11").dispersion


def test_a_medium_of_your_own() -> None:
    constant = Medium("stuff", Cauchy(a=(1.5,)), (0.0, math.inf), "made up", "air")
    assert constant.n_d == 1.5
    assert constant.abbe_number == math.inf
    assert not constant.is_dispersive


def test_abbe_number_needs_its_lines() -> None:
    infrared = Medium("stuff", Cauchy(a=(1.5, 0.01)), (800.0, 2000.0), "made up", "air")
    with pytest.raises(WavelengthOutOfRange):
        _ = infrared.n_d


@pytest.mark.parametrize("range_nm", [(700.0, 400.0), (-1.0, 700.0), (400.0, math.nan)])
def test_a_range_is_a_range(range_nm: tuple[float, float]) -> None:
    with pytest.raises(SpectraError, match="wavelength range"):
        Medium("stuff", Cauchy(a=(1.5,)), range_nm, "made up", "air")


def test_a_resonance_inside_the_range_is_found_when_the_medium_is_made() -> None:
    resonant = Sellmeier(b=(1.0,), c_um2=(0.25,))
    with pytest.raises(SpectraError, match="resonance at 500 nm"):
        Medium("stuff", resonant, (400.0, 700.0), "made up", "air")


def test_a_formula_that_fails_inside_the_range_is_found_when_the_medium_is_made() -> None:
    # n = 1 - 3.2 λ⁻² + 0.8 λ⁻⁴: above 0 at 0.4 and at 2 µm, below in between.
    with pytest.raises(SpectraError, match="no refractive index at"):
        Medium("stuff", Cauchy(a=(1.0, -3.2, 0.8)), (400.0, 2000.0), "made up", "air")


def test_a_dispersive_range_is_finite() -> None:
    with pytest.raises(SpectraError, match="a finite one"):
        Medium("stuff", Cauchy(a=(1.5, 0.01)), (400.0, math.inf), "made up", "air")


def test_a_table_shorter_than_the_range_is_found_when_the_medium_is_made() -> None:
    table = Tabulated(wavelength_nm=(400.0, 600.0), index=(1.6, 1.5))
    with pytest.raises(SpectraError, match="600"):
        Medium("stuff", table, (400.0, 700.0), "made up", "air")


def test_an_index_is_relative_to_air_or_vacuum() -> None:
    with pytest.raises(SpectraError, match="'water'"):
        Medium("stuff", Cauchy(a=(1.5,)), (400.0, 700.0), "made up", "water")  # type: ignore[arg-type]
