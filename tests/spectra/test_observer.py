from typing import Any

import numpy as np
import pytest

from spectra import (
    EmissionSpectrum,
    Observer,
    SpectraError,
    UnknownObserver,
    blackbody,
    observer,
    spectrum,
)

ONE_NM = np.arange(360.0, 831.0)


def chromaticity(source: EmissionSpectrum) -> tuple[float, float]:
    band_means = source.band_flux(ONE_NM) / np.diff(ONE_NM)
    x, y, z = observer().xyz(band_means, ONE_NM)
    return x / (x + y + z), y / (x + y + z)


@pytest.mark.parametrize(
    ("source", "key"),
    [
        (spectrum("D65"), "D65_xy"),
        (spectrum("A"), "A_xy"),
        (blackbody(2856.0), "blackbody_2856K_xy"),
    ],
)
def test_chromaticities_are_the_published_ones(
    source: EmissionSpectrum, key: str, references: dict[str, Any]
) -> None:
    colours = references["colour_2_degree"]
    assert chromaticity(source) == pytest.approx(colours[key], abs=colours["tolerance_xy"])


def test_the_observer_is_the_cie_1931_table() -> None:
    cie = observer()
    assert cie.name == "CIE 1931 2 degree"
    assert cie.wavelength_nm.tolist() == [float(nm) for nm in range(360, 831)]
    # CIE 018:2019, table 1: ȳ(555) = 1 and x̄, ȳ, z̄ at 450 nm.
    assert cie.cmf[555 - 360, 1] == 1.0
    assert cie.cmf[450 - 360].tolist() == [0.3362, 0.038, 1.77211]


def test_the_2015_observer_is_another() -> None:
    modern = observer("CIE 2015 2 degree")
    assert (modern.wavelength_nm[0], modern.wavelength_nm[-1]) == (390.0, 830.0)
    assert modern.cmf.shape == (441, 3)
    assert not np.allclose(modern.cmf[450 - 390], observer().cmf[450 - 360], rtol=0.01)


def test_unknown_observers_list_the_known() -> None:
    with pytest.raises(UnknownObserver, match="nearest: CIE 1931 2 degree"):
        observer("CIE 1931 2 Degree")


def test_band_responses_add_up_whatever_the_bands() -> None:
    cie = observer()
    whole = cie.band_response([360.0, 830.0])[0]
    np.testing.assert_allclose(whole, np.trapezoid(cie.cmf, cie.wavelength_nm, axis=0), rtol=1e-14)
    odd = np.array([360.0, 401.3, 402.0, 402.4, 555.55, 700.0, 830.0])
    np.testing.assert_allclose(cie.band_response(odd).sum(axis=0), whole, rtol=1e-14)


def test_a_band_response_is_the_exact_integral_of_the_linear_interpolant() -> None:
    # By hand: from 450.25 to 451.5 the interpolant has one knot, at 451.
    cie = observer()
    at_450, at_451, at_452 = cie.cmf[90:93]
    at_left, at_right = 0.75 * at_450 + 0.25 * at_451, 0.5 * (at_451 + at_452)
    expected = 0.375 * (at_left + at_451) + 0.25 * (at_451 + at_right)
    np.testing.assert_allclose(cie.band_response([450.25, 451.5])[0], expected, rtol=1e-14)


def test_bands_the_eye_does_not_see_give_nothing() -> None:
    assert not observer().band_response([200.0, 300.0, 360.0]).any()
    assert not observer().band_response([830.0, 2000.0]).any()


def test_a_monochromatic_watt_at_555_nm_is_683_lumens() -> None:
    # One band of 1 nm about 555 nm that holds 1 W: K_m times the mean of ȳ, 1 to its curvature.
    luminance = observer().xyz([1.0], [554.5, 555.5])[1]
    assert luminance == pytest.approx(683.0, rel=1e-4)


def test_any_shape_of_picture_is_seen_pixel_by_pixel() -> None:
    edges = np.linspace(395.0, 705.0, 32)
    radiance = np.random.default_rng(1).random((2, 3, 31))
    xyz = observer().xyz(radiance, edges)
    assert xyz.shape == (2, 3, 3)
    np.testing.assert_allclose(xyz[1, 2], observer().xyz(radiance[1, 2], edges), rtol=1e-14)


def test_radiance_must_fit_its_bands() -> None:
    with pytest.raises(SpectraError, match=r"\(2, 4\) over 3 bands; allowed: \(\.\.\., 3\)"):
        observer().xyz(np.zeros((2, 4)), [400.0, 500.0, 600.0, 700.0])


def test_an_observer_of_your_own() -> None:
    grey = Observer("grey", np.array([400.0, 700.0]), np.ones((2, 3)))
    assert grey.band_response([400.0, 700.0]).tolist() == [[300.0, 300.0, 300.0]]
