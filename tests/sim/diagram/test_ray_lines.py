"""Coinciding segments become one, in the sum of their colours."""

import numpy as np
import pytest

from sim.diagram.ray_lines import DrawnPath, ray_lines
from sim.diagram.view import NAMED_VIEWS
from spectra import wavelength_to_srgb

VIEW = NAMED_VIEWS["xy"]


def fork(wavelength_nm, end):
    """A path along x that leaves the axis at x = 1."""
    return DrawnPath(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, end, 0.0]]), wavelength_nm)


def test_shared_segments_are_drawn_once_in_the_sum_of_their_colours():
    blue, red = wavelength_to_srgb(np.array([450.0, 650.0]))
    lines, colours = ray_lines(
        [fork(450.0, -0.5), fork(650.0, 0.5)], VIEW, reach=9.0, resolution=0.01
    )
    np.testing.assert_array_equal(lines[:, 1], [[1.0, 0.0], [2.0, -0.5], [2.0, 0.5]])
    total = blue + red
    np.testing.assert_allclose(colours, [total / max(total.max(), 1.0), blue, red])


def test_all_wavelengths_of_a_spectrum_together_are_white():
    ends = np.linspace(-0.5, 0.5, 5)
    paths = [fork(nm, end) for nm, end in zip((430, 490, 550, 600, 650), ends, strict=True)]
    _, colours = ray_lines(paths, VIEW, reach=9.0, resolution=0.01)
    np.testing.assert_allclose(colours[0], 1.0, rtol=1e-12)


def test_segments_further_apart_than_the_resolution_stay_apart():
    paths = [fork(450.0, 0.0), fork(650.0, 0.1)]
    assert len(ray_lines(paths, VIEW, reach=9.0, resolution=0.05)[0]) == 3
    assert len(ray_lines(paths, VIEW, reach=9.0, resolution=0.2)[0]) == 2


def test_a_fan_of_close_rays_is_not_merged_into_one_by_its_neighbours():
    fan = [fork(wavelength_nm, end) for wavelength_nm, end in zip(
        np.linspace(420, 680, 40), np.linspace(-1.0, 1.0, 40), strict=True)]  # fmt: skip
    lines, _ = ray_lines(fan, VIEW, reach=9.0, resolution=0.06)
    # 40 rays 2/39 apart: each may swallow its nearest neighbours, so about every second stays.
    assert len(lines) - 1 >= 13


def test_a_path_that_escapes_leads_out_of_the_picture():
    points = np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0]])
    path = DrawnPath(points, 550.0, escapes=True)
    lines, _ = ray_lines([path], VIEW, reach=100.0, resolution=0.1)
    np.testing.assert_allclose(lines, [[[0.0, 0.0], [60.0, 80.0]]])
    assert path.vertices.tolist() == [[0.0, 0.0, 0.0]]


@pytest.mark.parametrize("paths", [[], [DrawnPath(np.zeros((1, 3)), 550.0)]])
def test_nothing_to_draw(paths):
    lines, colours = ray_lines(paths, VIEW, reach=1.0, resolution=0.1)
    assert lines.shape == (0, 2, 2)
    assert colours.shape == (0, 3)
