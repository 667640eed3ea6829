"""Outlines lie on the shapes they outline."""

import numpy as np
import pytest

import scenes
from sim.diagram.outlines import emitter_outline, shape_outline

TOWARD = np.array([0.0, 0.0, 1.0])
FLUX = {"flux": 1.0, "spectrum": "D65"}


def test_a_sphere_is_a_circle_about_its_centre_facing_the_viewer():
    outline = shape_outline(scenes.Sphere(position=(1, 2, 3), radius=0.5), TOWARD)
    np.testing.assert_allclose(np.linalg.norm(outline - [1, 2, 3], axis=1), 0.5, rtol=1e-12)
    np.testing.assert_allclose(outline[:, 2], 3.0, atol=1e-12)


def test_a_disk_is_a_circle_in_its_own_plane():
    outline = shape_outline(scenes.Disk(position=(0, 0, 0), normal=(1, 0, 0), radius=2.0), TOWARD)
    np.testing.assert_allclose(np.linalg.norm(outline, axis=1), 2.0, rtol=1e-12)
    np.testing.assert_allclose(outline[:, 0], 0.0, atol=1e-12)


def test_a_rectangle_is_its_corners():
    rectangle = scenes.Rectangle(position=(1, 1, 1), size=(4.0, 2.0), normal=(0, 0, 1))
    corners = shape_outline(rectangle, TOWARD) - [1, 1, 1]
    np.testing.assert_allclose(np.abs(corners), [[2.0, 1.0, 0.0]] * 4, atol=1e-12)
    # In order around it: neighbours are an edge apart, not a diagonal.
    edges = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    np.testing.assert_allclose(sorted(edges), [2.0, 2.0, 4.0, 4.0])


def test_a_box_seen_face_on_is_a_rectangle_and_seen_on_a_corner_a_hexagon():
    box = scenes.Box(position=(0, 0, 0), size=(2.0, 4.0, 6.0))
    assert len(shape_outline(box, np.array([1.0, 1.0, 1.0]) / np.sqrt(3.0))) == 6
    seen = shape_outline(box, TOWARD)[:, :2]
    np.testing.assert_allclose(np.abs(seen).max(axis=0), [1.0, 2.0])


def test_a_prism_seen_along_its_edge_is_its_triangle():
    prism = scenes.Prism(position=(0, 0, 0), apex_deg=60.0, base=2.0, length=1.0)
    seen = shape_outline(prism, TOWARD)[:, :2]
    sides = np.linalg.norm(np.roll(seen, -1, axis=0) - seen, axis=1)
    np.testing.assert_allclose(sides, 2.0)  # An apex of 60° makes it equilateral.


def test_a_lens_is_its_section_rim_to_rim():
    lens = scenes.Lens(
        position=(0, 0, 0), axis=(1, 0, 0), thickness=0.3, aperture=1.0,
        first=scenes.LensSurface(radius=1.0), second=scenes.LensSurface(curvature=0.0),
    )  # fmt: skip
    outline = shape_outline(lens, TOWARD)
    np.testing.assert_allclose(outline[:, 2], 0.0, atol=1e-12)
    first, second = np.split(outline, 2)
    np.testing.assert_allclose(second[:, 0], 0.15)  # The plane, half a thickness from the middle.
    # The first surface: a sphere of radius 1 about (-0.15 + 1, 0, 0).
    np.testing.assert_allclose(np.linalg.norm(first - [0.85, 0, 0], axis=1), 1.0, rtol=1e-12)
    assert np.ptp(outline[:, 1]) == pytest.approx(1.0)


def test_a_lens_seen_along_its_axis_is_a_circle():
    flat = scenes.LensSurface(curvature=0.0)
    lens = scenes.Lens(position=(0, 0, 0), thickness=0.1, aperture=1.0, first=flat, second=flat)
    np.testing.assert_allclose(np.linalg.norm(shape_outline(lens, TOWARD), axis=1), 0.5)


def test_a_plane_has_no_outline():
    assert shape_outline(scenes.Plane(position=(0, 0, 0), normal=(0, 1, 0)), TOWARD) is None


@pytest.mark.parametrize(
    ("emitter", "extent"),
    [
        (scenes.SphereLamp(position=(0, 0, 0), radius=0.5, **FLUX), (1.0, 1.0, 0.0)),
        (
            scenes.RectangleLamp(position=(0, 0, 0), size=(2.0, 1.0), normal=(0, 0, -1), **FLUX),
            (2.0, 1.0, 0.0),
        ),
        (
            scenes.Beam(
                position=(0, 0, 0), direction=(1, 0, 0),
                profile=scenes.RoundProfile(radius=0.5), **FLUX,
            ),
            (0.0, 1.0, 1.0),
        ),
        (
            scenes.Beam(
                position=(0, 0, 0), direction=(1, 0, 0),
                profile=scenes.SlitProfile(width=0.2, height=3.0), **FLUX,
            ),
            (0.0, 3.0, 0.2),
        ),
    ],
    ids=lambda value: getattr(value, "type", None),
)  # fmt: skip
def test_lamps_are_as_large_as_they_are(emitter, extent):
    outline = emitter_outline(emitter, TOWARD)
    # A circle of 96 points misses its widest place by at most 1 - cos(π/96) = 5.4e-4.
    np.testing.assert_allclose(np.ptp(outline, axis=0), extent, rtol=6e-4, atol=1e-12)


def test_points_have_no_outline():
    assert emitter_outline(scenes.Point(position=(0, 0, 0), **FLUX), TOWARD) is None
