import numpy as np
import numpy.typing as npt
import pytest

from spectra import (
    VISIBLE_RANGE_NM,
    SpectraError,
    UnknownSpectrum,
    blackbody,
    cie_illuminant,
    laser,
    line_spectrum,
    spectrum,
    spectrum_names,
    table,
)
from spectra.units import BOLTZMANN_J_K, M_PER_NM, PLANCK_J_S, SPEED_OF_LIGHT_M_S


def planck(wavelength_nm: npt.NDArray[np.float64], kelvin: float) -> npt.NDArray[np.float64]:
    """2 h c² / λ⁵ / (exp(h c / λ k T) - 1), as the textbook has it."""
    metres = wavelength_nm * M_PER_NM
    x = PLANCK_J_S * SPEED_OF_LIGHT_M_S / (metres * BOLTZMANN_J_K * kelvin)
    return 2.0 * PLANCK_J_S * SPEED_OF_LIGHT_M_S**2 / metres**5 / np.expm1(x)


@pytest.mark.parametrize("kelvin", [1000.0, 2856.0, 6504.0, 100_000.0])
def test_a_blackbody_follows_planck(kelvin: float) -> None:
    source = blackbody(kelvin)
    expected = planck(source.wavelength_nm, kelvin)
    np.testing.assert_allclose(source.density, expected / expected.max(), rtol=1e-12)
    assert source.support_nm == VISIBLE_RANGE_NM
    assert np.allclose(np.diff(source.wavelength_nm), 1.0, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("kelvin", "brightest_nm"), [(1.0, 830.0), (1e12, 360.0)])
def test_extreme_temperatures_neither_overflow_nor_vanish(
    kelvin: float, brightest_nm: float
) -> None:
    source = blackbody(kelvin)
    assert source.wavelength_nm[np.argmax(source.density)] == brightest_nm
    assert source.density.max() == 1.0


def test_a_blackbody_peaks_where_wien_says() -> None:
    # λ_max T = 2.897771955e-3 m K (CODATA 2018): 579.55 nm at 5000 K, to the knots' 1 nm.
    source = blackbody(5000.0)
    assert source.wavelength_nm[np.argmax(source.density)] == pytest.approx(579.55, abs=1.0)


def test_a_blackbody_over_a_range_of_your_own() -> None:
    source = blackbody(3000.0, (1000.0, 2000.5))
    assert source.support_nm == (1000.0, 2000.5)


@pytest.mark.parametrize("kelvin", [0.0, -1.0, float("nan"), float("inf")])
def test_temperatures_are_positive(kelvin: float) -> None:
    with pytest.raises(SpectraError, match="allowed: above 0"):
        blackbody(kelvin)


def test_a_blackbody_needs_a_range() -> None:
    with pytest.raises(SpectraError, match="low < high"):
        blackbody(3000.0, (700.0, 400.0))


def test_d65_has_its_published_values_at_its_own_steps() -> None:
    # CIE 15:2018, table 1: relative power of D65, every 5 nm, 100 at 560 nm.
    d65 = cie_illuminant("D65")
    assert d65.support_nm == (360.0, 780.0)
    assert np.all(np.diff(d65.wavelength_nm) == 5.0)
    assert d65.density_at(560.0) == 100.0
    assert d65.density_at(460.0) == 117.812
    assert d65.density_at(700.0) == 71.6091


def test_illuminant_a_is_its_own_definition() -> None:
    # CIE 15:2018, §4.1.1: 100 (560/λ)⁵ (exp(1.435e7/(2848·560)) - 1)/(exp(1.435e7/(2848 λ)) - 1),
    # printed with 6 digits.
    a = cie_illuminant("A")
    wavelength = a.wavelength_nm
    c2 = 1.435e7 / 2848.0
    defined = 100.0 * (560.0 / wavelength) ** 5 * np.expm1(c2 / 560.0) / np.expm1(c2 / wavelength)
    np.testing.assert_allclose(a.density, defined, rtol=1e-5)


def test_illuminant_e_is_equal_energy() -> None:
    e = cie_illuminant("E")
    assert set(e.density) == {100.0}
    assert e.support_nm == VISIBLE_RANGE_NM


def test_sodium_is_its_doublet() -> None:
    sodium = line_spectrum("sodium")
    assert sodium.line_wavelength_nm.tolist() == [588.995, 589.5924]
    # The statistical weights of the upper levels, 2 P 3/2 and 2 P 1/2: 4 to 2.
    assert sodium.line_flux[0] / sodium.line_flux[1] == 2.0


@pytest.mark.parametrize("resolve", [spectrum, cie_illuminant, line_spectrum])
def test_unknown_names_list_the_nearest(resolve: object) -> None:
    assert callable(resolve)
    with pytest.raises(UnknownSpectrum, match="unknown spectrum 'nosuch"):
        resolve("nosuch")
    with pytest.raises(UnknownSpectrum, match="nearest: D65"):
        spectrum("d65")
    with pytest.raises(UnknownSpectrum, match="nearest: sodium"):
        spectrum("Sodium")


def test_every_name_resolves_and_gives_visible_light() -> None:
    names = spectrum_names()
    assert {"A", "D50", "D65", "E", "FL1", "sodium", "mercury", "helium-neon"} <= set(names)
    assert len(names) == len(set(names))
    low, high = VISIBLE_RANGE_NM
    for name in names:
        source = spectrum(name)
        assert source.name == name
        assert source.total > 0.0
        assert low <= source.support_nm[0] <= source.support_nm[1] <= high


def test_a_laser_without_width_is_one_line() -> None:
    line = laser(532.0)
    assert line.support_nm == (532.0, 532.0)
    assert line.total == 1.0


@pytest.mark.parametrize("width_nm", [1e-6, 0.1, 10.0, 80.0])
def test_a_laser_has_its_width(width_nm: float) -> None:
    source = laser(532.0, width_nm)
    # FWHM of a Gaussian: half the peak at half the width; straight lines between knots err by
    # h²/8 f'' < 5e-4 of it, and a knot near 532 nm is rounded to 1e-13 nm.
    slack = 5e-4 + 1e-12 / width_nm
    half = source.density_at(np.array([532.0 - width_nm / 2, 532.0, 532.0 + width_nm / 2]))
    np.testing.assert_allclose(half, [0.5, 1.0, 0.5], rtol=0, atol=slack)
    # ∫ exp(-z²/2) dz = √(2π) standard deviations; the cut tails hold 6e-7 of it, and the
    # trapezoidal rule is exponentially accurate for a Gaussian.
    deviation = width_nm / np.sqrt(8.0 * np.log(2.0))
    assert source.total == pytest.approx(np.sqrt(2.0 * np.pi) * deviation, rel=1e-6 + slack * 1e-3)


@pytest.mark.parametrize("width_nm", [-1.0, 1e-12, 300.0, float("nan")])
def test_a_laser_refuses_widths_it_cannot_have(width_nm: float) -> None:
    with pytest.raises(SpectraError, match="0 for a single line"):
        laser(532.0, width_nm)


@pytest.mark.parametrize("wavelength_nm", [0.0, -532.0, float("nan"), float("inf")])
def test_a_laser_has_a_wavelength(wavelength_nm: float) -> None:
    with pytest.raises(SpectraError, match="above 0"):
        laser(wavelength_nm)


def test_a_table_is_what_it_says() -> None:
    mine = table([400, 500, 700], [0, 2, 1])
    assert mine.density_at(450.0) == 1.0
    assert mine.total == 100.0 + 300.0
    with pytest.raises(SpectraError, match="same length"):
        table([400, 500], [1])
