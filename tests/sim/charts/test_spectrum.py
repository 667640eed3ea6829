"""The chart of a light: spectrum, chromaticity, gamut mappings."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from sim.charts.spectrum import plot_spectrum
from spectra import EmissionSpectrum, blackbody, chromaticity, laser, spectrum, tristimulus
from spectra.srgb import GAMUT_METHODS


def test_a_continuous_spectrum_is_drawn_against_its_highest():
    source = spectrum("A")
    flux = plot_spectrum(source).axes[0]
    (curve,) = (item for item in flux.collections if isinstance(item, LineCollection))
    points = np.array([segment[0] for segment in curve.get_segments()])
    expected = source.density_at(points[:, 0]) / source.density.max()
    np.testing.assert_allclose(points[:, 1], expected, rtol=1e-12)


def test_lines_are_drawn_as_sticks():
    source = spectrum("mercury")
    flux = plot_spectrum(source).axes[0]
    (sticks,) = (item for item in flux.collections if isinstance(item, LineCollection))
    tips = np.array([segment[1] for segment in sticks.get_segments()])
    np.testing.assert_array_equal(tips[:, 0], source.line_wavelength_nm)
    np.testing.assert_array_equal(tips[:, 1], source.line_flux / source.line_flux.max())


def test_lines_and_a_continuum_are_both_drawn():
    both = EmissionSpectrum(
        "both", np.array([400.0, 700.0]), np.array([1.0, 1.0]), np.array([500.0]), np.array([9.0])
    )
    flux = plot_spectrum(both).axes[0]
    assert sum(isinstance(item, LineCollection) for item in flux.collections) == 2


@pytest.mark.parametrize("source", [spectrum("D65"), laser(532.0), blackbody(3000.0)])
def test_the_light_stands_at_its_chromaticity(source):
    figure = plot_spectrum(source)
    diagram = figure.axes[1]
    mark = diagram.lines[-1]
    x, y = chromaticity(tristimulus(source))
    assert (mark.get_xdata()[0], mark.get_ydata()[0]) == (x, y)
    assert f"{x:.4f}" in mark.get_label()
    assert figure.get_suptitle() == source.name
    # Each light twice: what glares is white by desaturating alone; preserving keeps its hue.
    full, glaring = np.reshape(
        [patch.get_facecolor() for patch in figure.axes[2].patches], (2, len(GAMUT_METHODS), 4)
    )
    methods = list(GAMUT_METHODS)
    np.testing.assert_array_equal(glaring[methods.index("desaturate")], 1.0)
    one, other = (codes[methods.index("preserve"), :3] for codes in (full, glaring))
    assert other.max() == 1.0
    assert other.min() <= other.max() - (one.max() - one.min())


def test_the_gamut_mappings_of_the_rainbow_are_side_by_side():
    strips = plot_spectrum(spectrum("D65")).axes[3]
    (image,) = strips.images
    pixels = image.get_array()
    assert len(pixels) == len(GAMUT_METHODS)
    wavelength_nm = np.linspace(390.0, 700.0, pixels.shape[1])
    green = np.argmin(np.abs(wavelength_nm - 525.0))
    # Out of gamut, 525 nm is clipped to the screen's pure green; desaturated it is not.
    assert pixels[1][green].tolist() == [0, 255, 0]
    assert pixels[0][green][2] > 100


def test_light_that_nobody_sees_is_drawn_without_a_colour():
    figure = plot_spectrum(laser(1500.0))
    assert figure.axes[0].get_xlim() == (360.0, 1501.0)
    assert [one.get_text() for one in figure.axes[2].get_xticklabels()] == ["invisible"]
