import numpy as np
import pytest

from scenes import Blackbody, Laser, Lines, SceneError, SpectrumTable
from scenes.emission import resolve_spectrum
from spectra import blackbody, spectrum


def test_names_and_descriptions_resolve_to_spectra() -> None:
    assert resolve_spectrum("D65").support_nm == spectrum("D65").support_nm
    edges_nm = np.linspace(400.0, 700.0, 31)
    np.testing.assert_array_equal(
        Blackbody(temperature_k=3000.0).emission().band_flux(edges_nm),
        blackbody(3000.0).band_flux(edges_nm),
    )


def test_lines_share_the_flux_by_their_weights() -> None:
    emission = Lines(wavelength_nm=(450.0, 650.0), weights=(1.0, 3.0)).emission()
    flux = emission.band_flux(np.array([400.0, 500.0, 600.0, 700.0])) / emission.total
    np.testing.assert_allclose(flux, [0.25, 0.0, 0.75], atol=1e-15)


def test_a_table_is_linear_between_its_entries() -> None:
    emission = SpectrumTable(wavelength_nm=(400.0, 500.0), values=(0.0, 1.0)).emission()
    # The area of the triangle up to 450 nm is a quarter of the whole.
    flux = emission.band_flux(np.array([400.0, 450.0, 500.0])) / emission.total
    np.testing.assert_allclose(flux, [0.25, 0.75], atol=1e-15)


def test_a_laser_has_one_wavelength_or_a_width() -> None:
    assert Laser(wavelength_nm=532.0).emission().support_nm == (532.0, 532.0)
    low, high = Laser(wavelength_nm=532.0, width_nm=1.0).emission().support_nm
    assert low < 531.5
    assert high > 532.5


def test_spectra_without_light() -> None:
    with pytest.raises(SceneError, match="total flux 0"):
        Lines(wavelength_nm=(450.0,), weights=(0.0,))
    with pytest.raises(SceneError, match="total flux inf"):
        SpectrumTable(wavelength_nm=(400.0, 500.0), values=(1e308, 1e308))
    with pytest.raises(SceneError, match=r"values\[0\]: must be at least 0, is -1.0"):
        SpectrumTable(wavelength_nm=(400.0, 500.0), values=(-1.0, 1.0))
    with pytest.raises(SceneError, match="width_nm: must be at most a tenth of the wavelength"):
        Laser(wavelength_nm=500.0, width_nm=51.0)
    with pytest.raises(SceneError, match="temperature_k: must be at least 100, is 0"):
        Blackbody(temperature_k=0.0)
