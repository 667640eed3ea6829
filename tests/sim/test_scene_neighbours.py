"""Neighbours: who may touch whom, and which of two media comes first."""

import pytest

import scenes
from sim.errors import SettingsError
from sim.scene_neighbours import (
    find_neighbours,
    near_pairs,
    rank_media,
    refuse_merged_sheets,
    touch_distance,
)

GLASS = scenes.Dielectric(medium="N-BK7")
WHITE = scenes.Lambertian(reflectance=0.5)


def ball(x, radius=1.0, material=GLASS, **fields):
    shape = scenes.Sphere(position=(x, 0.0, 0.0), radius=radius)
    return scenes.SceneObject(shape=shape, material=material, **fields)


def plane(y, material=WHITE):
    shape = scenes.Plane(position=(0.0, y, 0.0), normal=(0.0, 1.0, 0.0))
    return scenes.SceneObject(shape=shape, material=material)


def test_touching_nested_and_resting_solids_are_neighbours():
    scene = scenes.Scene(
        objects=[ball(0.0), ball(2.0), ball(0.1, 0.2), plane(-1.0), ball(9.0), plane(-5.0)]
    )
    assert find_neighbours(scene, 1e-9) == [[1, 2, 3], [0, 3], [0], [0, 1, 4], [3], []]


def test_opaque_ones_do_not_mind_each_other():
    black = scenes.Absorber()
    scene = scenes.Scene(objects=[ball(0.0, material=WHITE), ball(1.0, material=black), plane(0)])
    assert find_neighbours(scene, 1e-9) == [[], [], []]


@pytest.mark.parametrize(("gap", "slack", "count"), [(0.01, 0.009, 0), (0.01, 0.011, 1)])
def test_slack_is_how_far_apart_they_may_be(gap, slack, count):
    scene = scenes.Scene(objects=[ball(0.0), ball(2.0 + gap)])
    assert sum(map(len, find_neighbours(scene, slack))) == 2 * count


def test_near_pairs_are_told_once_and_in_order():
    scene = scenes.Scene(objects=[ball(0.0), ball(2.0), ball(4.0), plane(-3.0)])
    assert near_pairs(scene) == [(0, 1), (1, 2)]


def test_an_empty_scene_has_no_neighbours():
    assert find_neighbours(scenes.Scene(), 1.0) == []
    assert near_pairs(scenes.Scene()) == []
    assert rank_media(scenes.Scene()) == []


def test_touch_is_a_part_of_the_bench():
    assert touch_distance(1.0, "float64") == 2.0**-40
    assert touch_distance(3.0, "float32") == 3.0 * 2.0**-17


def test_ranks_go_by_priority_and_then_by_order():
    def prefer(priority):
        return scenes.Dielectric(medium="N-BK7", priority=priority)

    scene = scenes.Scene(objects=[
        ball(0.0, material=prefer(0)), plane(-1.0), ball(5.0, material=prefer(7)),
        ball(10.0, material=prefer(0)), ball(15.0, material=prefer(-3)),
        ball(20.0, material=scenes.Mirror()),
    ])  # fmt: skip
    ranks = rank_media(scene)
    order = sorted((0, 2, 3, 4), key=lambda prim: -ranks[prim])
    assert order == [2, 0, 3, 4]
    assert sorted(ranks[prim] for prim in order) == [0, 1, 2, 3]


def test_single_precision_cannot_part_a_polariser_from_glass_so_near():
    # 2^-17 of the scene's size is 8e-6 here: what is nearer is one surface, which a polariser on
    # glass must not be.
    block = scenes.SceneObject(
        name="block", shape=scenes.Box(position=(0, -0.5, 0), size=(1, 1, 1)), material=GLASS
    )
    touch = touch_distance(1.0, "float32")

    def over(gap):
        shape = scenes.Rectangle(position=(0.0, gap, 0.0), size=(1.0, 1.0))
        film = scenes.SceneObject(
            name="film", shape=shape, material=scenes.Polariser(axis=(1, 0, 0))
        )
        return scenes.Scene(objects=[block, film])

    with pytest.raises(SettingsError, match=r"precision: 'float32' .* 'float64', since 'block'"):
        refuse_merged_sheets(over(0.5 * touch), touch, "float32")
    refuse_merged_sheets(over(2.0 * touch), touch, "float32")
    refuse_merged_sheets(over(0.5 * touch), touch_distance(1.0, "float64"), "float64")
