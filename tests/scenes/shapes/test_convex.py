"""Boxes, prisms and polyhedra: faces and corners must describe the same solid."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes import Box, Polyhedron, Prism, SceneError
from scenes.shapes import ConvexSolid

rotations = st.tuples(*[st.floats(-180.0, 180.0)] * 3)
sizes = st.floats(0.1, 10.0)
prisms = st.builds(
    Prism,
    position=st.just((1.0, -2.0, 3.0)),
    rotation_deg=rotations,
    apex_deg=st.floats(1.0, 170.0),
    base=sizes,
    length=sizes,
)
boxes = st.builds(
    Box,
    position=st.just((1.0, -2.0, 3.0)),
    rotation_deg=rotations,
    size=st.tuples(sizes, sizes, sizes),
)


@given(st.one_of(prisms, boxes))
@settings(deadline=None)
def test_every_face_holds_corners_and_no_corner_is_outside(solid: Prism | Box) -> None:
    normals, offsets = solid.faces()
    distances = (solid.vertices_world() - np.array(solid.position)) @ normals.T - offsets
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-14)
    # Corners are at most 600 from the origin (a base of 10 with an apex of 1°): 1e-13 each.
    assert distances.max() < 1e-11
    assert ((abs(distances) < 1e-11).sum(axis=0) >= 3).all()


@given(st.one_of(prisms, boxes))
@settings(deadline=None)
def test_a_polyhedron_of_the_same_corners_has_the_same_faces(solid: Prism | Box) -> None:
    corners = tuple((x, y, z) for x, y, z in solid.local_vertices().tolist())
    hull = Polyhedron(position=(0.0, 0.0, 0.0), vertices=corners)
    assert_same_faces(hull.local_faces(), solid.local_faces())


def assert_same_faces(found: tuple[np.ndarray, ...], expected: tuple[np.ndarray, ...]) -> None:
    """Faces in any order; normals of thin triangles are known to about 1e-13 of their aspect."""
    rows = np.column_stack(found)
    for row in np.column_stack(expected):
        assert abs(rows - row).max(axis=1).min() < 1e-9
    assert len(rows) == len(expected[0])


@given(st.one_of(prisms, boxes))
@settings(deadline=None)
def test_the_bounding_sphere_holds_every_corner(solid: ConvexSolid) -> None:
    centre, radius = solid.bounding_sphere()
    distances = np.linalg.norm(solid.vertices_world() - centre, axis=1)
    assert distances.max() <= radius * (1.0 + 1e-12)


def test_the_faces_of_an_equilateral_prism() -> None:
    prism = Prism(position=(0.0, 0.0, 0.0), apex_deg=60.0, base=2.0, length=4.0)
    # Height √3; the origin is in the middle of it, so the base is at y = -√3/2, and the sides,
    # with normals (±cos 30°, sin 30°), are at cos 30° · 1 - sin 30° · √3/2 = √3/4.
    normals, offsets = prism.local_faces()
    half, high = 0.5, math.sqrt(3.0) / 2.0
    np.testing.assert_allclose(
        normals,
        [(0, -1, 0), (high, half, 0), (-high, half, 0), (0, 0, 1), (0, 0, -1)],
        atol=1e-15,
    )
    np.testing.assert_allclose(offsets, [high, high / 2, high / 2, 2.0, 2.0], atol=1e-15)
    assert prism.full_height == pytest.approx(math.sqrt(3.0), rel=1e-15)


def test_a_truncated_prism_is_centred_on_what_is_left() -> None:
    prism = Prism(position=(0.0, 0.0, 0.0), apex_deg=90.0, base=2.0, length=1.0, height=0.5)
    # The full height is 1; cut at 0.5 the top is 1 wide.
    corners = prism.local_vertices()
    section = [(-1.0, -0.25), (1.0, -0.25), (0.5, 0.25), (-0.5, 0.25)]
    np.testing.assert_allclose(corners[:, :2], section + section, atol=1e-15)
    normals, _ = prism.local_faces()
    assert normals.shape == (6, 3)


def test_a_height_equal_to_the_triangles_cuts_nothing_off() -> None:
    full = 0.03 / math.tan(math.radians(30.0))
    prism = Prism(position=(0.0, 0.0, 0.0), apex_deg=60.0, base=0.06, length=0.05, height=full)
    assert not prism.is_truncated
    assert prism.local_vertices().shape == (6, 3)


@pytest.mark.parametrize("apex_deg", [0.0, 180.0, -60.0, float("nan")])
def test_an_apex_that_is_none(apex_deg: float) -> None:
    with pytest.raises(SceneError, match="apex_deg: must be"):
        Prism(position=(0.0, 0.0, 0.0), apex_deg=apex_deg, base=1.0, length=1.0)


def test_a_prism_of_a_thousandth_of_a_degree_needs_a_height() -> None:
    prism = Prism(position=(0, 0, 0), apex_deg=1e-3, base=0.05, length=0.05, height=0.05)
    normals, _ = prism.local_faces()
    # The angle between the faces, π minus that between their normals, is the apex.
    sine = np.linalg.norm(np.cross(normals[1], normals[2]))
    assert math.degrees(math.asin(float(sine))) == pytest.approx(1e-3, rel=1e-12)


def test_a_prism_cut_higher_than_its_faces_meet() -> None:
    with pytest.raises(SceneError, match=r"height: must be at most 0\.5 m, where the faces meet"):
        Prism(position=(0, 0, 0), apex_deg=90.0, base=1.0, length=1.0, height=0.6)


def test_a_box_that_is_turned() -> None:
    box = Box(position=(5.0, 0.0, 0.0), size=(2.0, 4.0, 6.0), rotation_deg=(0.0, 0.0, 90.0))
    corners = {tuple(corner) for corner in box.vertices_world().tolist()}
    assert corners == set(itertools.product((3.0, 7.0), (-1.0, 1.0), (-3.0, 3.0)))


def test_corners_on_a_face_are_fine_and_those_inside_are_named() -> None:
    cube = [(float(x), float(y), float(z)) for x, y, z in itertools.product((0, 1), repeat=3)]
    on_a_face = Polyhedron(position=(0, 0, 0), vertices=(*cube, (0.5, 0.5, 1.0)))
    assert on_a_face.local_faces()[0].shape == (6, 3)
    with pytest.raises(SceneError, match=r"vertices\[8\]: must be on the hull of the others"):
        Polyhedron(position=(0, 0, 0), vertices=(*cube, (0.5, 0.5, 0.5)))


def test_corners_in_one_plane() -> None:
    corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 0.0))
    with pytest.raises(SceneError, match="vertices: must be at least four corners"):
        Polyhedron(position=(0, 0, 0), vertices=corners)


def test_corners_in_one_point() -> None:
    with pytest.raises(SceneError, match="vertices: must be at least four corners"):
        Polyhedron(position=(0, 0, 0), vertices=((1.0, 1.0, 1.0),) * 4)
