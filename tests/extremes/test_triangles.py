"""Triangles that are none, or hardly any: points, lines, slivers; and coordinates that are none."""

import warnings

import numpy as np
import pytest

import scenes

ETA = 1.5
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1.5, 1.5) for z in (-2, 2)], dtype=float)
"""Of a box of 2 by 3 by 4."""

REST = [
    [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
]  # fmt: skip
"""Its faces, but for one half of its left side, of the corners 0, 1 and 3."""

BOX = scenes.Box(position=(0.0, 0.0, 0.0), size=(2.0, 3.0, 4.0))


def mesh(path, corners, faces, **fields):
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(corners, dtype=float).tolist()]
    rows += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    file = path / "mesh.obj"
    file.write_text("\n".join(rows))
    return scenes.Mesh(position=(0.0, 0.0, 0.0), file=str(file), **fields)


def rays(count=500):
    """From the left, most of them at the left side, some along its edges and its middle line."""
    rng = np.random.default_rng(71)
    aims = np.column_stack([np.full(count, -1.0), rng.uniform(-1.6, 1.6, (count, 2))])
    aims[:100, 1] = -1.5 + np.abs(aims[:100, 1]) * 0.01
    starts = aims + np.column_stack([np.full(count, -3.0), rng.uniform(-0.5, 0.5, (count, 2))])
    return starts, aims - starts


SLIVERS = {
    "a line": 0.0,  # on the edge from corner 0 to 1: with no area at all
    "a hair": 1e-15,
    "a thread": 1e-9,
    "a strip": 1e-4,
}


@pytest.mark.parametrize("name", SLIVERS)
def test_slivers_close_a_box_as_well_as_wide_triangles(
    follow, solid, precision, eps, tmp_path, name
):
    # A vertex on the edge of the left side, for the left side alone: the sliver closes the joint.
    # Where it sticks out of the box's face, it is as much as its width over its length.
    width = SLIVERS[name]
    middle = 0.5 * (CORNERS[0] + CORNERS[1]) + (0.0, -width, 0.0)
    faces = [*REST, [0, 8, 3], [8, 1, 3], [0, 1, 8]]
    shape = mesh(tmp_path, [*CORNERS, middle], faces)
    assert shape.is_closed
    starts, ways = rays()
    expected = follow([solid(BOX, ETA)], starts, ways, precision=precision, max_interactions=16)
    paths = follow([solid(shape, ETA)], starts, ways, precision=precision, max_interactions=16)
    different = 0
    for path, other in zip(paths, expected, strict=True):
        assert np.all(np.isfinite(path.points))
        norms = np.linalg.norm(path.directions, axis=1)
        np.testing.assert_allclose(norms, 1.0, rtol=0, atol=4 * eps[precision])
        same = path.events == other.events and np.allclose(
            path.directions, other.directions, rtol=0, atol=64 * eps[precision]
        )
        different += not same
    # Only rays within the sliver's width, or rounding, of the edge may be otherwise: of 100 along a
    # strip of 0.016 that many, and the strip's rays alone where it is wide.
    assert different <= 3 + 100 * width / 0.016


def test_points_and_lines_are_left_out_of_a_mesh(tmp_path):
    # Two corners in one place: no triangle at all. Without any other the file is refused.
    degenerate = [[0, 0, 1], [2, 3, 3], [4, 4, 4]]
    whole = mesh(tmp_path, CORNERS, [*REST, [0, 1, 3], *degenerate])
    assert len(whole.surface().triangles) == 12
    with pytest.raises(scenes.SceneError, match="no triangle of three different corners"):
        mesh(tmp_path, CORNERS, degenerate)


def test_a_flat_mesh_is_no_solid_but_a_sheet(solid, tmp_path):
    flat = mesh(tmp_path, CORNERS * (1.0, 1.0, 0.0), [*REST, [0, 1, 3]])
    with pytest.raises(scenes.SceneError, match="encloses no volume"):
        solid(flat, ETA)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_corners_that_are_nowhere_are_refused(tmp_path, value):
    corners = CORNERS.copy()
    corners[3, 1] = value
    with pytest.raises(scenes.SceneError, match="coordinates that are not finite numbers"):
        mesh(tmp_path, corners, [*REST, [0, 1, 3]])


@pytest.mark.parametrize("scale", [1e9, 1e100, 1e200, 1e300])
def test_meshes_larger_than_any_scene_are_refused(tmp_path, scale):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(scenes.SceneError, match=r"m from its origin; allowed: at most 1e\+09"):
            mesh(tmp_path, CORNERS * scale, [*REST, [0, 1, 3]])


@pytest.mark.parametrize("scale", [1e-10, 1e-100, 1e-300])
def test_meshes_smaller_than_anything_are_refused(tmp_path, scale):
    with pytest.raises(scenes.SceneError, match="m wide; allowed: at least 1e-09 m"):
        mesh(tmp_path, CORNERS * scale, [*REST, [0, 1, 3]])


@pytest.mark.parametrize("scale", [2.0**-30, 2.0**27])
def test_meshes_of_any_size_are_met_as_boxes(follow, solid, precision, eps, tmp_path, scale):
    shape = mesh(tmp_path, CORNERS * scale, [*REST, [0, 1, 3]])
    box = scenes.Box(position=(0, 0, 0), size=(2.0 * scale, 3.0 * scale, 4.0 * scale))
    starts, ways = rays()
    options = {"precision": precision, "max_interactions": 16}
    paths = follow([solid(shape, ETA)], starts * scale, ways, **options)
    expected = follow([solid(box, ETA)], starts * scale, ways, **options)
    different = 0
    for path, other in zip(paths, expected, strict=True):
        assert np.all(np.isfinite(path.points))
        same = path.events == other.events and np.allclose(
            path.directions, other.directions, rtol=0, atol=16 * eps[precision]
        )
        different += not same
    assert different <= 1  # on an edge


# --- lamps without a size ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("lamp", "fields", "where"),
    [
        (scenes.SphereLamp, {"radius": 0.0}, "radius"),
        (scenes.SphereLamp, {"radius": 1e-10}, "radius"),
        (scenes.RectangleLamp, {"size": (0.0, 1.0)}, r"size\[0\]"),
        (scenes.RectangleLamp, {"size": (1.0, 0.0)}, r"size\[1\]"),
        (scenes.Beam, {"direction": (0, -1, 0), "profile": {"type": "round", "radius": 0.0}},
         r"profile.*radius"),
        (scenes.Beam, {"direction": (0, -1, 0),
                       "profile": {"type": "slit", "width": 0.0, "height": 1.0}},
         r"profile.*width"),
    ],
)  # fmt: skip
def test_lamps_of_no_size_are_refused(lamp, fields, where):
    with pytest.raises(scenes.SceneError, match=rf"{where}: must be"):
        lamp(position=(0, 1, 0), flux=1.0, spectrum="E", **fields)
