"""Ray diagrams show what they should; how they look, people judge."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon

import scenes
from sim.diagram.draw import draw_rays
from sim.diagram.ray_lines import DrawnPath

PATHS = [
    DrawnPath(np.array([[x, 3.0, 0.0], [x, 1.4, 0.0], [0.5 * x, 0.0, 0.0]]), wavelength_nm)
    for x in (-0.2, 0.2)
    for wavelength_nm in (450.0, 650.0)
]


def test_surfaces_lamps_and_rays_are_all_there(small_scene):
    (axes,) = draw_rays(small_scene, PATHS).axes
    outlines = [patch for patch in axes.patches if isinstance(patch, Polygon)]
    assert len(outlines) == 3  # Ball, floor, and the lamp's profile.
    (rays,) = (item for item in axes.collections if isinstance(item, LineCollection))
    assert len(rays.get_segments()) == 4  # Both wavelengths take the same two paths.
    assert axes.get_title() == small_scene.title
    assert axes.get_aspect() == 1.0


def test_sensors_are_dashed(small_scene):
    place = scenes.Rectangle(position=(0.0, 0.5, 0.0), size=(1.0, 1.0))
    scene = small_scene.model_copy(update={"sensors": (scenes.RaySensor(shape=place),)})
    (axes,) = draw_rays(scene, PATHS, view="xy").axes
    outlines = [patch for patch in axes.patches if isinstance(patch, Polygon)]
    (dashed,) = (one for one in outlines if one.get_linestyle() in ("--", "dashed"))
    assert len(outlines) == 4
    np.testing.assert_allclose(dashed.get_xy()[:, 1], 0.5)
    assert np.ptp(dashed.get_xy()[:, 0]) == 1.0


def test_the_picture_holds_paths_and_solids_but_no_endless_floor(small_scene):
    (axes,) = draw_rays(small_scene, PATHS, view="xy").axes
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    # The ball from -0.5 to 0.5, but not all of the 4 m floor; rays from y = 3 down to y = 0.
    assert (left, right) == pytest.approx((-0.5, 0.5), abs=0.25)
    assert (bottom, top) == pytest.approx((0.0, 3.0), abs=0.25)


def test_a_ray_that_ends_far_away_does_not_shrink_everything(small_scene):
    grazing = DrawnPath(np.array([[0.0, 3.0, 0.0], [1e4, 0.0, 0.0]]), 550.0)
    (axes,) = draw_rays(small_scene, [*PATHS, grazing], view="xy").axes
    assert axes.get_xlim()[1] < 1.0


@pytest.mark.parametrize(("y", "unit"), [(3.0, "m"), (1.6, "mm")])
def test_units_fit_the_size(small_scene, y, unit):
    path = DrawnPath(np.array([[0.0, y, 0.0], [0.0, 0.5, 0.0]]), 550.0)
    (axes,) = draw_rays(small_scene, [path], view="xy").axes
    assert axes.get_xlabel() == f"x [{unit}]"
    shown = axes.xaxis.get_major_formatter()(0.25, 0)
    assert shown == {"m": "0.25", "mm": "250"}[unit]


@pytest.mark.parametrize("view", ["xy", "xz", "yz", None])
@pytest.mark.parametrize("text", ['title = "nothing"', None])
def test_every_view_draws_even_without_rays(small_scene, view, text):
    scene = small_scene if text is None else scenes.loads(text)
    assert draw_rays(scene, [], view=view).axes


def test_an_edge_on_plane_is_a_line_and_a_face_on_plane_is_not():
    plane = {"position": (0.0, 0.0, 0.0), "normal": (0.0, 1.0, 0.0)}
    item = scenes.SceneObject(shape=scenes.Plane(**plane), material=scenes.Absorber())
    scene = scenes.Scene(objects=(item,))
    (axes,) = draw_rays(scene, PATHS, view="xy").axes
    (line,) = axes.lines
    np.testing.assert_array_equal(line.get_ydata(), [0.0, 0.0])
    (axes,) = draw_rays(scene, PATHS, view="xz").axes
    assert len(axes.lines) == 0
