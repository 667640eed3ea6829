"""Height fields: waves, grids and files of heights; sheets, and solids below them."""

import numpy as np
import pytest

import scenes

WAVE = {"amplitude": 0.1, "period": 2.0, "direction_deg": 30.0, "phase_deg": 50.0}
FIELDS = {"position": (0.0, 0.0, 0.0), "size": (4.0, 3.0)}


def field(**fields):
    return scenes.HeightField(**FIELDS | fields)


def height(x, z):
    """A sin(2π s/P + φ) with s = x cosθ + z sinθ."""
    s = x * np.cos(np.pi / 6) + z * np.sin(np.pi / 6)
    return 0.1 * np.sin(np.pi * s + np.radians(50.0))


def slope(x, z):
    """dh/ds = (2π/P) A cos(2π s/P + φ)."""
    s = x * np.cos(np.pi / 6) + z * np.sin(np.pi / 6)
    return 0.1 * np.pi * np.cos(np.pi * s + np.radians(50.0))


def test_waves_have_their_heights_and_normals() -> None:
    surface = field(waves=[WAVE], cells=(8, 6)).local_surface()
    x, y, z = np.moveaxis(surface.corners, 2, 0)
    np.testing.assert_allclose(y, height(x, z), atol=1e-15)
    gradient = np.stack([
        -slope(x, z) * np.cos(np.pi / 6), np.ones_like(x), -slope(x, z) * np.sin(np.pi / 6)
    ], axis=-1)  # fmt: skip
    normals = gradient / np.linalg.norm(gradient, axis=2, keepdims=True)
    np.testing.assert_allclose(surface.corner_normals, normals, atol=1e-15)


def test_waves_add_up() -> None:
    two = field(waves=[WAVE, WAVE], cells=(3, 3)).grid().heights
    np.testing.assert_allclose(two, 2.0 * field(waves=[WAVE], cells=(3, 3)).grid().heights)


def test_a_sheet_looks_up_and_is_open() -> None:
    surface = field(waves=[WAVE], cells=(8, 6)).local_surface()
    assert (surface.facet_normals[:, 1] > 0.0).all()
    assert surface.seams.open_edges == 2 * (8 + 6)
    area = 0.5 * surface.area_vectors[:, 1].sum()
    assert area == pytest.approx(4.0 * 3.0, rel=1e-14)


def test_a_depth_closes_it() -> None:
    shape = field(waves=[{**WAVE, "direction_deg": 0.0}], cells=(40, 3), depth=0.5)
    assert shape.is_closed
    # A whole number of periods along x adds nothing to the slab's volume.
    assert shape.local_surface().volume == pytest.approx(4.0 * 3.0 * 0.5, rel=1e-12)
    patches = shape.local_surface().patches
    assert len(set(patches)) == 6


def test_rows_run_along_z_and_columns_along_x() -> None:
    surface = field(heights=[[0.0, 0.0, 3.0], [0.0, 0.0, 0.0]]).local_surface()
    top = surface.vertices[np.argmax(surface.vertices[:, 1])]
    assert top.tolist() == [2.0, 3.0, -1.5]


def test_slopes_of_a_grid_are_exact_for_a_parabola() -> None:
    # Central differences, and one-sided ones of second order, are exact for y = x²/4 + z.
    x, z = np.linspace(-2.0, 2.0, 5), np.linspace(-1.5, 1.5, 4)
    surface = field(heights=(x**2 / 4.0 + z[:, None]).tolist()).local_surface()
    at = surface.corners[:, :, 0]
    expected = np.stack([-at / 2.0, np.ones_like(at), -np.ones_like(at)], axis=-1)
    expected /= np.linalg.norm(expected, axis=2, keepdims=True)
    np.testing.assert_allclose(surface.corner_normals, expected, atol=1e-14)


def test_heights_may_stand_in_a_file(tmp_path) -> None:
    heights = np.array([[0.0, 1.0, 0.5], [2.0, 3.0, 0.25]])
    np.save(tmp_path / "h.npy", heights)
    np.savetxt(tmp_path / "h.csv", heights, delimiter=",")
    (tmp_path / "h.txt").write_text("0 1 .5\n\n2 3 .25\n")
    text = """
    length_unit = "mm"
    [[objects]]
    shape = {{ type = "heightfield", position = [0, 0, 0], size = [4, 3], file = "{}" }}
    material = {{ type = "absorber" }}
    """
    for name in ("h.npy", "h.csv", "h.txt"):
        scene = scenes.loads(text.format(name), folder=tmp_path)
        # Written out in metres, the file's numbers are millimetres still.
        again = scenes.loads(scene.to_toml(), folder=tmp_path)
        for one in (scene, again):
            grid = one.objects[0].shape.grid()
            np.testing.assert_allclose(grid.heights, heights / 1000.0, rtol=1e-15)


@pytest.mark.parametrize(
    ("content", "words"),
    [("1 2\n3\n", "rows differ"), ("1 2\n", "shape"), ("1 x\n2 3", "cannot be used"),
     ("1 inf\n2 3", "heights must be numbers"), ("", "shape"), ("1 2\n3 nan", "must be numbers")],
)  # fmt: skip
def test_what_is_wrong_with_a_file_is_said(tmp_path, content, words) -> None:
    (tmp_path / "h.txt").write_text(content)
    with pytest.raises(scenes.SceneError, match=words) as caught:
        field(file=str(tmp_path / "h.txt"))
    assert caught.value.problems[0].path == "file"


@pytest.mark.parametrize(
    ("fields", "path"),
    [
        ({}, "heights"),
        ({"waves": [WAVE], "heights": [[0, 0], [0, 0]]}, "heights"),
        ({"heights": [[0.0, 0.0], [0.0]]}, "heights[1]"),
        ({"heights": [[0.0], [0.0]]}, "heights[0]"),
        ({"waves": [WAVE], "depth": 0.05}, "depth"),
        ({"waves": [WAVE], "cells": (0, 3)}, "cells[0]"),
        ({"waves": [{**WAVE, "period": 0.0}]}, "waves[0].period"),
    ],
)
def test_bad_fields_are_named(fields, path) -> None:
    with pytest.raises(scenes.SceneError) as caught:
        field(**fields)
    assert path in [problem.path for problem in caught.value.problems]


def test_a_sheet_holds_no_water() -> None:
    with pytest.raises(scenes.SceneError, match="open edges"):
        scenes.SceneObject(
            shape=field(waves=[WAVE], cells=(4, 4)), material=scenes.Dielectric(medium="water")
        )
