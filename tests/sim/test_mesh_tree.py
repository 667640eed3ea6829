"""Trees of boxes over triangles: complete, tight, and nothing missing."""

import numpy as np
import pytest

from sim.mesh_tree import build_tree


def small_triangles(count, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1.0, 1.0, (count, 1, 3)) + rng.uniform(-0.02, 0.02, (count, 3, 3))


@pytest.mark.parametrize("count", [1, 2, 4, 5, 63, 64, 65, 1000])
def test_every_triangle_is_in_a_leaf_that_holds_it(count) -> None:
    corners = small_triangles(count)
    tree = build_tree(corners)
    assert sorted(tree.order[tree.order >= 0]) == list(range(count))
    for leaf, rows in enumerate(tree.order.reshape(-1, tree.leaf_size)):
        node = tree.inner_nodes + leaf
        held = corners[rows[rows >= 0]].reshape(-1, 3)
        assert (held >= tree.low[node]).all()
        assert (held <= tree.high[node]).all()


@pytest.mark.parametrize("count", [5, 64, 1000])
def test_nodes_hold_their_children(count) -> None:
    tree = build_tree(small_triangles(count))
    assert len(tree.low) == 2 * tree.inner_nodes + 1
    for node in range(tree.inner_nodes):
        children = [2 * node + 1, 2 * node + 2]
        np.testing.assert_array_equal(tree.low[node], tree.low[children].min(axis=0))
        np.testing.assert_array_equal(tree.high[node], tree.high[children].max(axis=0))


def test_leaves_are_near_one_another() -> None:
    # Medians along the widest axis of 4096 triangles in a cube of side 2 leave cells of side 1/5,
    # 1024 of them; those of a tree over rows in any order would be as large as the cube.
    tree = build_tree(small_triangles(4096))
    sizes = (tree.high - tree.low)[tree.inner_nodes :].max(axis=1)
    assert np.median(sizes) < 0.4


def test_a_large_triangle_is_entered_where_it_is_and_swells_no_leaf() -> None:
    small = small_triangles(400)
    large = np.array([[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]])
    corners = np.concatenate([small, large])
    tree = build_tree(corners)
    rows = tree.order.reshape(-1, tree.leaf_size)
    with_it = np.flatnonzero((rows == 400).any(axis=1))
    assert len(with_it) > 20
    # Whatever point of the triangle: some leaf that has it holds the point.
    weights = np.random.default_rng(1).dirichlet((1.0, 1.0, 1.0), 500)
    points = weights @ large[0]
    low, high = tree.low[tree.inner_nodes + with_it], tree.high[tree.inner_nodes + with_it]
    inside = ((points[:, None] >= low) & (points[:, None] <= high)).all(axis=2)
    assert inside.any(axis=1).all()
    assert (high - low).max() < 1.0


def test_what_is_given_is_left_alone() -> None:
    corners = np.concatenate([small_triangles(50), 40.0 * small_triangles(2)])
    before = corners.copy()
    build_tree(corners)
    np.testing.assert_array_equal(corners, before)


def test_triangles_in_one_place_are_no_trouble() -> None:
    tree = build_tree(np.repeat(small_triangles(1), 100, axis=0))
    assert sorted(tree.order[tree.order >= 0]) == list(range(100))
