"""The chart of a metal: complex index, reflectance, colour."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from sim.analytic_conductor import conductor_reflectance
from sim.charts.metal import normal_reflectance, plot_metal, reflected_colour
from spectra import Conductor, conductor, conductors


def curves(axes):
    found = [item for item in axes.collections if isinstance(item, LineCollection)]
    return [np.array([segment[0] for segment in one.get_segments()]) for one in found]


@pytest.mark.parametrize("name", conductors())
def test_the_curves_are_the_metals(name):
    metal = conductor(name)
    figure = plot_metal(metal)
    index, reflectance, angles, _ = figure.axes
    of_eta, of_k = curves(index)
    np.testing.assert_allclose(of_eta[:, 1], metal.eta(of_eta[:, 0]), rtol=1e-12)
    np.testing.assert_allclose(of_k[:, 1], metal.k(of_k[:, 0]), rtol=1e-12)
    (points,) = curves(reflectance)
    np.testing.assert_allclose(points[:, 1], normal_reflectance(metal, points[:, 0]), rtol=1e-12)
    assert index.get_xlim() == (360.0, 830.0)
    eta, k = metal.eta(587.5618), metal.k(587.5618)
    theta_deg, found = next(one for one in angles.lines if one.get_label() == "p").get_data()
    expected = conductor_reflectance(np.cos(np.radians(theta_deg)), 1.0, eta, k)[1]
    np.testing.assert_allclose(found, expected, atol=1e-14)
    assert figure.get_suptitle() == name


def test_a_perfect_reflector_shows_daylight_itself():
    # R = 1 - 4n/((n + 1)² + k²): 4e-8 below 1 here; D65 is white to 4e-4.
    mirror = Conductor("mirror", (300.0, 900.0), (1e-6, 1e-6), (10.0, 10.0), "made up")
    np.testing.assert_allclose(reflected_colour(mirror), 1.0, atol=4e-4)


def test_gold_and_copper_are_reddish_silver_and_aluminium_grey():
    for name in conductors():
        red, _, blue = reflected_colour(conductor(name))
        if name in ("gold", "copper"):
            assert red > 1.5 * blue
        else:
            assert red == pytest.approx(blue, rel=0.06)
