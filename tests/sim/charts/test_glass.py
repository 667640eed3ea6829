"""The chart of a medium: index, reflectance, transmittance, colours."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from sim.analytic import fresnel_reflectance
from sim.charts.glass import colour_through, plot_glass
from spectra import (
    Absorption,
    Cauchy,
    Medium,
    absorbing_media,
    glass,
    glasses,
    published_absorption,
)


def curves(axes):
    """The points of each coloured curve, without its last."""
    found = [item for item in axes.collections if isinstance(item, LineCollection)]
    return [np.array([segment[0] for segment in one.get_segments()]) for one in found]


@pytest.mark.parametrize("name", glasses())
def test_the_curve_is_the_index_over_the_visible_part_of_the_range(name):
    medium = glass(name)
    figure = plot_glass(medium)
    axes, _ = figure.axes
    (points,) = curves(axes)
    np.testing.assert_allclose(points[:, 1], medium.eta(points[:, 0]), rtol=1e-12)
    lowest_nm, highest_nm = medium.wavelength_range_nm
    assert axes.get_xlim() == pytest.approx((max(lowest_nm, 360.0), min(highest_nm, 830.0)))
    assert figure.get_suptitle() == name
    assert medium.relative_to in axes.get_ylabel()


def test_a_medium_that_is_only_known_in_the_infrared_is_plotted_there():
    infrared = Medium("germanium", Cauchy((4.0, 0.1)), (2000.0, 14000.0), "made up", "air")
    axes, angles = plot_glass(infrared).axes
    assert axes.get_xlim() == (2000.0, 14000.0)
    assert len(axes.texts) == 0
    assert angles.get_title() == "at 8000 nm"


def test_reflectance_by_angle_is_fresnels_at_the_d_line():
    _, angles = plot_glass(glass("SF11")).axes
    lines = {line.get_label(): line.get_data() for line in angles.lines}
    for which, label in enumerate(("s", "p")):
        theta_deg, found = lines[label]
        expected = fresnel_reflectance(np.cos(np.radians(theta_deg)), 1.0, glass("SF11").n_d)
        # The cosine of 90° is 6e-17 here, 0 there.
        np.testing.assert_allclose(found, expected[which], atol=1e-14)
    assert lines["unpolarised"][1][-1] == 1.0


@pytest.mark.parametrize("name", absorbing_media())
def test_internal_transmittance_is_that_of_the_thickness_and_its_multiples(name):
    absorption = published_absorption(name)
    axes = plot_glass(glass(name), absorption, thickness_m=0.02).axes[2]
    thicknesses = {"20 mm": 0.02, "200 mm": 0.2, "2 m": 2.0}
    assert [text.get_text() for text in axes.get_legend().get_texts()] == list(thicknesses)
    for points, thickness_m in zip(curves(axes), thicknesses.values(), strict=True):
        expected = absorption.transmittance(points[:, 0], thickness_m)
        np.testing.assert_allclose(points[:, 1], expected, rtol=1e-12)


def test_daylight_is_white_through_nothing_and_darker_through_grey():
    white = colour_through(Absorption((0.0,)), 0.01)
    # D65 is sRGB's white, up to its rounded chromaticity and matrix: 4e-4.
    np.testing.assert_allclose(white, 1.0, atol=4e-4)
    grey = colour_through(Absorption.from_internal_transmittance((0.3,), thickness_m=0.01), 0.01)
    np.testing.assert_allclose(grey, 0.3 * white, rtol=1e-12)


def test_dense_flint_is_yellow_and_deep_water_blue():
    red, _, blue = colour_through(published_absorption("SF11"), 0.5)
    assert blue < 0.5 * red
    red, _, blue = colour_through(published_absorption("water"), 5.0)
    assert red < 0.5 * blue
