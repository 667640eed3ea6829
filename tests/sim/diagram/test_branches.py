"""Paths that are reflected where the ray's own is refracted."""

import numpy as np
import pytest

import scenes
from sim.diagram.branches import trace_branches
from sim.diagram.draw import draw_rays
from sim.scene_data import compile_scene

ETA = 1.5


@pytest.fixture(scope="module")
def plate():
    """Glass between z = 0 and z = 1, without an end for a ray along z; a black wall behind."""
    return compile_scene(
        scenes.Scene(
            objects=(
                scenes.SceneObject(
                    shape=scenes.Box(position=(0.0, 0.0, 0.5), size=(4.0, 4.0, 1.0)),
                    material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA)),
                ),
                scenes.SceneObject(
                    shape=scenes.Rectangle(
                        position=(0.0, 0.0, 2.0), size=(4.0, 4.0), normal=(0.0, 0.0, -1.0)
                    ),
                    material=scenes.Absorber(),
                ),
            )
        )
    )


def drawn(compiled, reflections, **options):
    origin, direction = np.array([[0.0, 0.0, -1.0]]), np.array([[0.0, 0.0, 1.0]])
    return trace_branches(
        compiled, origin, direction, np.array([550.0]), reflections=reflections, **options
    )


def test_a_ray_alone_is_its_refracted_path(plate):
    (path,) = drawn(plate, 0)
    np.testing.assert_array_equal(path.points[:, 2], [-1.0, 0.0, 1.0, 2.0])
    assert path.kinds == ("refracted",) * 3
    assert not path.escapes
    assert path.strength == 1.0
    assert path.normals is None


def test_one_reflection_adds_a_path_from_each_surface(plate):
    _, front, back = drawn(plate, 1)
    assert front.points[0, 2] == 0.0
    assert front.kinds == ("reflected",)
    assert front.escapes
    np.testing.assert_array_equal(back.points[:2, 2], [1.0, 0.0])
    assert back.kinds == ("reflected", "refracted")
    # R = ((n − 1)/(n + 1))² = 4 % at normal incidence: the back gets what the front lets through.
    assert front.strength == pytest.approx(0.04**0.3, rel=1e-12)
    assert back.strength == pytest.approx((0.96 * 0.04) ** 0.3, rel=1e-12)


def test_two_reflections_add_the_light_that_goes_to_and_fro(plate):
    paths = drawn(plate, 2)
    # The ray; off the front; off the back; and off the front again from inside.
    assert len(paths) == 4
    assert paths[3].points[0, 2] == 0.0
    assert paths[3].points[1, 2] == 1.0
    assert paths[3].strength == pytest.approx((0.96 * 0.04 * 0.04) ** 0.3, rel=1e-12)


def test_total_reflection_is_told_from_the_other_kind():
    # Inside the glass at 60° to the normal: beyond the critical angle of 41.8°.
    scene = scenes.Scene(
        objects=(
            scenes.SceneObject(
                shape=scenes.Box(position=(0.0, 0.0, 0.5), size=(99.0, 99.0, 1.0)),
                material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA)),
            ),
        )
    )
    slope = np.radians(60.0)
    (path, *_) = trace_branches(
        compile_scene(scene), np.array([[0.0, 0.0, 0.5]]),
        np.array([[np.sin(slope), 0.0, np.cos(slope)]]), np.array([550.0]),
    )  # fmt: skip
    assert path.kinds[:2] == ("refracted", "totally reflected")


def test_normals_point_at_the_ray_and_are_drawn(plate):
    (path,) = drawn(plate, 0, normals=True)
    places, normals = path.normals
    np.testing.assert_array_equal(places[:, 2], [0.0, 1.0, 2.0])
    np.testing.assert_allclose(normals, [[0.0, 0.0, -1.0]] * 3, atol=1e-15)
    (axes,) = draw_rays(plate.scene, [path], view="yz").axes
    assert len(axes.collections[-1].get_segments()) == 3


def test_kinds_have_their_own_lines(plate):
    (axes,) = draw_rays(plate.scene, drawn(plate, 1), view="yz").axes
    solid, dashed = (one.get_linestyles()[0][1] for one in axes.collections)
    assert solid is None
    assert dashed is not None
