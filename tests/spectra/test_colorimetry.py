"""Colours of light: published chromaticities and colour temperatures, and exact integrals."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from spectra import (
    SpectraError,
    blackbody,
    chromaticity,
    colour_temperature,
    laser,
    luminous_efficacy,
    observer,
    spectrum,
    table,
    tristimulus,
)


@pytest.mark.parametrize(
    ("name", "key"), [("D65", "D65_xy"), ("A", "A_xy"), ("3", "blackbody_2856K_xy")]
)
def test_chromaticities_are_the_published_ones(
    name: str, key: str, references: dict[str, Any]
) -> None:
    source = blackbody(2856.0) if name == "3" else spectrum(name)
    colours = references["colour_2_degree"]
    found = chromaticity(tristimulus(source))
    # The references sum over 1 nm samples where this integrates: both differ by as much again.
    assert found == pytest.approx(colours[key], abs=2.0 * colours["tolerance_xy"])


def test_equal_energy_is_integrated_exactly() -> None:
    # A density of 1 leaves the areas under x̄, ȳ, z̄, which the trapezoidal rule has exactly.
    cie = observer()
    expected = 683.0 * np.trapezoid(cie.cmf, cie.wavelength_nm, axis=0)
    np.testing.assert_allclose(tristimulus(table([300.0, 900.0], [1.0, 1.0])), expected, rtol=1e-14)


def test_a_ramp_is_integrated_exactly() -> None:
    # ∫ λ ȳ dλ over a piece of straight ȳ is h (λ₀ȳ₀ + λ₁ȳ₁)/3 + h (λ₀ȳ₁ + λ₁ȳ₀)/6.
    cie = observer()
    nm, y = cie.wavelength_nm, cie.cmf[:, 1]
    squares = nm[:-1] * y[:-1] + nm[1:] * y[1:]
    mixed = nm[:-1] * y[1:] + nm[1:] * y[:-1]
    expected = 683.0 * float(np.sum(np.diff(nm) * (squares / 3.0 + mixed / 6.0)))
    found = tristimulus(table([300.0, 900.0], [300.0, 900.0]))[1]
    assert found == pytest.approx(expected, rel=1e-13)


def test_a_line_is_the_observer_at_its_wavelength_and_light_adds_up() -> None:
    np.testing.assert_allclose(tristimulus(laser(555.0)), 683.0 * observer().cmf[555 - 360])
    assert luminous_efficacy(laser(555.0)) == pytest.approx(683.0)
    np.testing.assert_array_equal(tristimulus(laser(1500.0)), 0.0)
    both = spectrum("sodium")
    lines = zip(both.line_wavelength_nm, both.line_flux, strict=True)
    expected = sum(flux * tristimulus(laser(nm)) for nm, flux in lines)
    np.testing.assert_allclose(tristimulus(both), expected, rtol=1e-14)


@pytest.mark.parametrize("name", ["D65", "sodium"])
def test_a_filter_takes_its_share(name: str) -> None:
    source = spectrum(name)

    def grey(wavelength_nm: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.full_like(wavelength_nm, 0.25)

    np.testing.assert_allclose(
        tristimulus(source, share=grey), 0.25 * tristimulus(source), rtol=1e-14
    )


def test_a_coloured_filter_is_integrated_between_the_knots() -> None:
    # exp(-(λ - 560)/40 nm): Simpson's rule over 1 nm leaves h⁴/2880 · 40⁻⁴ = 1.4e-10 of it.
    source = table([300.0, 900.0], [1.0, 1.0])
    fine = np.linspace(360.0, 830.0, 470 * 64 + 1)
    cie = observer()
    integrand = np.interp(fine, cie.wavelength_nm, cie.cmf[:, 1]) * np.exp(-(fine - 560.0) / 40.0)
    found = tristimulus(source, share=lambda nm: np.exp(-(nm - 560.0) / 40.0))[1]
    # The trapezoidal rule of the check leaves h²/12 of the second derivative's integral: 1e-8.
    assert found == pytest.approx(683.0 * np.trapezoid(integrand, fine), rel=1e-7)


@pytest.mark.parametrize("kelvin", [1200.0, 2856.0, 6504.0, 25_000.0, 2e5])
def test_a_blackbody_has_its_own_temperature(kelvin: float) -> None:
    found = colour_temperature(tristimulus(blackbody(kelvin)))
    assert found is not None
    # The search ends at 1e-6 of the mired value.
    assert found.kelvin == pytest.approx(kelvin, rel=2e-6)
    assert abs(found.duv) < 1e-6


@pytest.mark.parametrize(
    ("name", "kelvin", "duv"),
    [
        # Temperatures as CIE 015:2018 prints them; Duv of daylight and of E,
        # by the formula of §9.5, are found in many places.
        ("A", 2856.0, 0.0), ("D50", 5003.0, 0.0032), ("D55", 5503.0, 0.0033),
        ("D65", 6504.0, 0.0032), ("D75", 7504.0, None), ("C", 6774.0, None),
        ("E", 5455.0, -0.0044), ("FL2", 4230.0, None), ("FL11", 4000.0, None),
    ],
)  # fmt: skip
def test_published_colour_temperatures(name: str, kelvin: float, duv: float | None) -> None:
    found = colour_temperature(tristimulus(spectrum(name)))
    assert found is not None
    # The prints stem from chromaticities rounded to 1e-4 and from the constants of their day:
    # 1e-4 in x is 0.1 % of a temperature near 6500 K, and FL's are rounded to 10 K.
    assert found.kelvin == pytest.approx(kelvin, rel=1.5e-3)
    if duv is not None:
        assert found.duv == pytest.approx(duv, abs=1.5e-4)


@pytest.mark.parametrize(
    "source", [laser(532.0), laser(450.0), spectrum("mercury"), blackbody(800.0)]
)
def test_colours_that_no_blackbody_has(source: Any) -> None:
    assert colour_temperature(tristimulus(source)) is None


def test_black_has_no_chromaticity() -> None:
    for ask in (chromaticity, colour_temperature):
        with pytest.raises(SpectraError, match="black has no chromaticity"):
            ask(np.zeros(3))


def test_chromaticities_of_many_colours() -> None:
    xyz = np.array([[[1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]])
    np.testing.assert_allclose(chromaticity(xyz), [[[1 / 3, 1 / 3], [0.5, 0.25]]], rtol=1e-15)


def test_the_efficacy_of_daylight() -> None:
    # 683 ∫ ȳ S dλ / ∫ S dλ on D65's own 5 nm steps, where ȳ is sampled: within 1e-3.
    daylight, cie = spectrum("D65"), observer()
    nm, density = daylight.wavelength_nm, daylight.density
    seen = np.interp(nm, cie.wavelength_nm, cie.cmf[:, 1])
    expected = 683.0 * np.trapezoid(seen * density, nm) / np.trapezoid(density, nm)
    assert luminous_efficacy(daylight) == pytest.approx(expected, rel=1e-3)
    assert luminous_efficacy(laser(1500.0)) == 0.0
