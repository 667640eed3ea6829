import numpy as np
import pytest

from scenes import (
    CauchyMedium,
    ConstantMedium,
    Dielectric,
    SceneError,
    SellmeierMedium,
    TableMedium,
)
from spectra import glass

N_BK7 = SellmeierMedium(
    b=(1.03961212, 0.231792344, 1.01046945),
    c_um2=(0.00600069867, 0.0200179144, 103.560653),
    range_nm=(300.0, 2500.0),
)


def test_a_named_medium_is_the_catalogues() -> None:
    assert Dielectric(medium="SF11").resolved() is glass("SF11")


@pytest.mark.parametrize("name", ["air", "vacuum"])
def test_a_bubble_has_index_1_of_its_own_reference(name: str) -> None:
    medium = Dielectric(medium=name).resolved()
    assert medium.name == medium.relative_to == name
    assert medium.eta(550.0) == 1.0
    assert not medium.is_dispersive


def test_a_misspelt_medium_is_told_with_the_nearest() -> None:
    with pytest.raises(SceneError, match="medium: unknown glass 'vacum'; nearest: vacuum"):
        Dielectric(medium="vacum")


def test_an_inline_sellmeier_is_the_glass_of_the_same_coefficients() -> None:
    medium = Dielectric(medium=N_BK7).resolved()
    assert medium.n_d == glass("N-BK7").n_d
    assert medium.wavelength_range_nm == (300.0, 2500.0)
    assert medium.relative_to == "air"


def test_cauchys_formula_takes_micrometres() -> None:
    medium = CauchyMedium(a=(1.5, 0.004), range_nm=(300.0, 800.0)).resolved()
    # n = a0 + a1/λ² at λ = 0.5 µm: 1.5 + 0.004/0.25.
    assert medium.eta(500.0) == pytest.approx(1.516, abs=1e-15)


def test_a_table_goes_through_its_entries_and_is_valid_between_them() -> None:
    medium = TableMedium(wavelength_nm=(400.0, 550.0, 700.0), eta=(1.53, 1.52, 1.51)).resolved()
    np.testing.assert_allclose(medium.eta(np.array([400.0, 550.0, 700.0])), [1.53, 1.52, 1.51])
    assert medium.wavelength_range_nm == (400.0, 700.0)


def test_a_constant_index_has_no_dispersion() -> None:
    medium = ConstantMedium(eta=1.5, relative_to="vacuum").resolved()
    assert not medium.is_dispersive
    assert medium.eta(1000.0) == 1.5
    assert medium.relative_to == "vacuum"


@pytest.mark.parametrize(
    ("b", "c_um2", "range_nm", "message"),
    [
        ((1.0, 1.0), (0.01,), (400.0, 700.0), r"c_um2: must have as many numbers as b has \(2\)"),
        ((1.0,), (0.25,), (400.0, 700.0), "resonance at 500 nm"),
        ((1.0,), (0.01,), (700.0, 400.0), r"range_nm\[1\]: must have strictly increasing"),
        ((-3.0,), (0.01,), (400.0, 700.0), "no refractive index at"),
        ((1e300,), (0.01,), (400.0, 700.0), "must give an index of at most 100"),
        ((1.0,) * 5, (0.01,) * 5, (400.0, 700.0), "b: must be an array of at most 4 elements"),
    ],
)
def test_a_sellmeier_formula_without_an_index(
    b: tuple[float, ...], c_um2: tuple[float, ...], range_nm: tuple[float, float], message: str
) -> None:
    with pytest.raises(SceneError, match=message):
        SellmeierMedium(b=b, c_um2=c_um2, range_nm=range_nm)


def test_an_index_that_dips_below_zero_inside_its_range_only() -> None:
    # n = 20 - 2 · 5/λ² + 5/λ⁴ · ... : positive at both ends, negative in the middle.
    with pytest.raises(SceneError, match="no refractive index at"):
        CauchyMedium(a=(2.0, -2.0, 0.4), range_nm=(300.0, 2000.0))


@pytest.mark.parametrize(
    ("wavelength_nm", "eta", "message"),
    [
        ((400.0, 500.0), (1.5,) * 3, r"eta: must have as many numbers as wavelength_nm has \(2\)"),
        ((400.0, 400.0), (1.5, 1.5), r"wavelength_nm\[1\]: must have strictly increasing"),
        ((400.0,), (1.5,), "wavelength_nm: must be an array of at least 2"),
        ((400.0, 500.0), (1.5, 0.0), r"eta\[1\]: must be greater than 0"),
        ((400.0, 500.0), (1.5, 101.0), r"eta\[1\]: must be at most 100"),
    ],
)
def test_tables_without_an_index(
    wavelength_nm: tuple[float, ...], eta: tuple[float, ...], message: str
) -> None:
    with pytest.raises(SceneError, match=message):
        TableMedium(wavelength_nm=wavelength_nm, eta=eta)
