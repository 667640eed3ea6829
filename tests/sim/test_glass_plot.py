"""The plot of a medium's index."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from sim.glass_plot import plot_glass
from spectra import Cauchy, Medium, glass, glasses


@pytest.mark.parametrize("name", glasses())
def test_the_curve_is_the_index_over_the_visible_part_of_the_range(name):
    medium = glass(name)
    (axes,) = plot_glass(medium).axes
    (curve,) = (item for item in axes.collections if isinstance(item, LineCollection))
    points = np.array([segment[0] for segment in curve.get_segments()])
    np.testing.assert_allclose(points[:, 1], medium.eta(points[:, 0]), rtol=1e-12)
    lowest_nm, highest_nm = medium.wavelength_range_nm
    assert axes.get_xlim() == pytest.approx((max(lowest_nm, 360.0), min(highest_nm, 830.0)))
    assert axes.get_title() == name
    assert medium.relative_to in axes.get_ylabel()


def test_a_medium_that_is_only_known_in_the_infrared_is_plotted_there():
    infrared = Medium("germanium", Cauchy((4.0, 0.1)), (2000.0, 14000.0), "made up", "air")
    (axes,) = plot_glass(infrared).axes
    assert axes.get_xlim() == (2000.0, 14000.0)
    assert len(axes.texts) == 0
