import numpy as np
import pytest

import scenes
from sim.errors import SettingsError
from sim.study.receiver_bins import lay_bins

LAMP = scenes.Point(name="lamp", position=(0.0, 2.0, 0.0), flux=1.0, spectrum="E")
FLOOR = scenes.Rectangle(position=(0.5, 1.0, 2.0), size=(0.8, 0.4), normal=(0.0, 0.0, 1.0))
"""Upright: u = x, v = y."""


@pytest.fixture(scope="module")
def scene(make_bench):
    return make_bench(LAMP, floor=FLOOR)


def test_bins_cover_the_rectangle_or_a_window(scene):
    bins = lay_bins(scene, "floor", rows=2, columns=4)
    np.testing.assert_allclose(bins.bin_centres()[0, 0], [0.2, 0.9, 2.0], atol=1e-15)
    np.testing.assert_allclose(bins.bin_centres()[1, 3], [0.8, 1.1, 2.0], atol=1e-15)
    assert bins.bin_area == pytest.approx(0.04)
    part = lay_bins(scene, "floor", rows=1, columns=2, window=((0.0, 0.2), (-0.2, 0.0)))
    np.testing.assert_allclose(part.bin_centres()[0, :, 0], [0.55, 0.65])
    assert part.bin_area == pytest.approx(0.02)
    np.testing.assert_allclose(part.to_bins(np.array([0.15, -0.05])), [1.5, 0.75])


def test_photons_are_summed_where_they_lie(scene):
    bins = lay_bins(scene, "floor", rows=2, columns=4)
    photons = {
        "position": np.array([[0.2, 0.9, 2.0], [0.8, 1.1, 2.0], [0.8, 1.1, 2.0], [0.8, 1.1, 2.0]]),
        "wavelength_nm": np.array([500.0, 500.0, 620.0, 620.0]),
        "flux": np.array([1.0, 2.0, 4.0, 8.0]),
        "object": np.array([2, 2, 2, 0]),  # the last one on the ball
    }
    found = bins.bin_photons(photons, [450.0, 550.0, 650.0])
    # E = Φ / (A Δλ), with A = 0.04 m² and Δλ = 100 nm.
    expected = np.zeros((2, 4, 2))
    expected[0, 0, 0], expected[1, 3] = 1.0 / 4.0, [2.0 / 4.0, 4.0 / 4.0]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("wall", {}, "receiver: 'wall' is not allowed; allowed: an object of the scene: ball, "),
        ("ball", {}, "a rectangle, not a sphere"),
        ("floor", {"rows": 0}, "rows, columns"),
        ("floor", {"window": ((0.0, 0.5), (-0.1, 0.1))}, "window"),
        ("floor", {"window": ((0.2, 0.1), (-0.1, 0.1))}, "window"),
    ],
)
def test_what_is_no_receiver_is_refused(scene, name, options, message):
    with pytest.raises(SettingsError, match=message):
        lay_bins(scene, name, **{"rows": 2, "columns": 2, **options})
