"""Which side a diagram is seen from."""

import numpy as np
import pytest

import scenes
from sim.diagram.view import NAMED_VIEWS, choose_view

FLAT = np.random.default_rng(2).normal(size=(50, 3)) * [3.0, 2.0, 0.0]


@pytest.mark.parametrize("view", NAMED_VIEWS.values(), ids=NAMED_VIEWS)
def test_named_views_are_right_handed_frames(view):
    axes = np.stack([view.right, view.up, view.toward_viewer])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_projection():
    point = np.array([[1.0, 2.0, 3.0]])
    np.testing.assert_array_equal(NAMED_VIEWS["xy"].project(point), [[1.0, 2.0]])
    np.testing.assert_array_equal(NAMED_VIEWS["xz"].project(point), [[1.0, -3.0]])
    np.testing.assert_array_equal(NAMED_VIEWS["yz"].project(point), [[3.0, 2.0]])


@pytest.mark.parametrize(("name", "flat_axis"), [("xy", 2), ("xz", 1), ("yz", 0)])
def test_paths_in_a_plane_of_the_axes_are_seen_in_it(name, flat_axis):
    assert choose_view(np.roll(FLAT, flat_axis - 2, axis=1)) is NAMED_VIEWS[name]


def test_a_little_noise_out_of_the_plane_does_not_tilt_the_view():
    noise = np.random.default_rng(3).normal(size=FLAT.shape) * 0.01
    assert choose_view(FLAT + noise) is NAMED_VIEWS["xy"]


@pytest.mark.parametrize("rotation_deg", [(35.0, 0.0, 0.0), (0.0, 40.0, 10.0), (-50.0, 20.0, 70.0)])
def test_a_tilted_plane_is_seen_face_on_and_upright(rotation_deg):
    turn = scenes.rotation_matrix(rotation_deg)
    view = choose_view(FLAT @ turn.T)
    # The paths lie in the turned x-y plane, so one looks along the turned z axis.
    assert abs(view.toward_viewer @ turn[:, 2]) == pytest.approx(1.0, abs=1e-9)
    assert view.up[1] > 0.0
    np.testing.assert_allclose(np.linalg.norm([view.right, view.up], axis=1), 1.0, rtol=1e-12)


@pytest.mark.parametrize("points", [np.empty((0, 3)), np.zeros((1, 3)), np.ones((5, 3))])
def test_paths_without_extent_have_a_view_too(points):
    assert choose_view(points) is NAMED_VIEWS["xy"]


def test_paths_along_a_line_have_a_view_that_shows_it():
    line = np.linspace(-1.0, 1.0, 9)[:, None] * [0.0, 0.0, 1.0]
    assert np.ptp(choose_view(line).project(line), axis=0).max() == pytest.approx(2.0)
