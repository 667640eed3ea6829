import math

import numpy as np
import pytest

from spectra import UnknownAbsorption, absorbing_media, glass, published_absorption


@pytest.mark.parametrize("name", absorbing_media())
def test_they_belong_to_named_media_and_cover_what_a_film_records(name: str) -> None:
    absorption = published_absorption(name)
    low, high = absorption.wavelength_range_nm
    assert low <= 395.0
    assert high >= 705.0
    lowest, highest = glass(name).wavelength_range_nm
    assert low >= lowest or name == "water"
    assert not absorption.is_transparent
    assert absorption.source
    # A few wavelengths, so that the medium's own range is met where both are known.
    both = np.array([max(low, lowest), 550.0, min(high, highest)])
    assert np.all(absorption.coefficient(both) > 0.0)


@pytest.mark.parametrize(
    ("name", "wavelength_nm", "transmittance"),
    [
        # Schott's data sheets print the same glasses for 10 mm as well (2017-01-20): τ(10 mm).
        ("N-BK7", 400.0, 0.997), ("N-BK7", 350.0, 0.967), ("N-BK7", 546.0, 0.998),
        ("SF11", 400.0, 0.525), ("SF11", 546.0, 0.996), ("N-SF11", 400.0, 0.815),
        ("F2", 400.0, 0.994),
    ],
)  # fmt: skip
def test_glasses_transmit_what_the_other_column_of_the_data_sheet_prints(
    name: str, wavelength_nm: float, transmittance: float
) -> None:
    found = published_absorption(name).transmittance(wavelength_nm, 0.010)
    # Both columns are rounded to 0.001, that of 25 mm by 0.0005/τ(25 mm) in ln τ, 0.4 of which
    # counts for 10 mm.
    of_25_mm = found**2.5
    assert found == pytest.approx(transmittance, abs=0.0005 + 0.4 * found * 0.0005 / of_25_mm)


def test_water_is_clearest_in_the_blue() -> None:
    absorption = published_absorption("water")
    at = np.linspace(400.0, 700.0, 301)
    alpha = absorption.coefficient(at)
    assert 450.0 <= at[np.argmin(alpha)] <= 500.0
    # k = 9.35e-10 at 475 nm (Hale & Querry 1973, table I): α = 4πk/λ.
    expected = 4.0 * math.pi * 9.35e-10 / 475e-9
    assert absorption.coefficient(475.0) == pytest.approx(expected, rel=1e-12)
    assert absorption.coefficient(700.0) > 20.0 * expected


def test_what_is_not_published() -> None:
    with pytest.raises(UnknownAbsorption, match=r"'diamond' .* known: N-BK7, SF11"):
        published_absorption("diamond")
