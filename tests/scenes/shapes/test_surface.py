"""Surfaces of triangles: what closes them, how large they are, where they bend."""

import numpy as np
import pytest

from scenes.shapes import Surface

CORNERS = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]])
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def tetrahedron(triangles=TETRAHEDRON, normals=None):
    return Surface(CORNERS, np.asarray(triangles), normals)


def octahedron_ball(rounds):
    """A unit ball from an octahedron whose triangles are cut into four, again and again."""
    corners = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)])
    triangles = np.array([corners * s if s.prod() > 0 else corners[::-1] * s for s in signs])
    for _ in range(rounds):
        a, b, c = np.moveaxis(triangles, 1, 0)
        ab, bc, ca = (x / np.linalg.norm(x, axis=1)[:, None] for x in (a + b, b + c, c + a))
        parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = np.concatenate([np.stack(part, axis=1) for part in parts])
    vertices, rows = np.unique(triangles.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    return Surface(vertices, rows.reshape(-1, 3))


def test_a_closed_surface_has_no_seams_and_a_volume() -> None:
    assert tetrahedron().seams.text == ""
    assert tetrahedron().volume == pytest.approx(3.0 * 2.0 * 1.0 / 6.0, rel=1e-15)


def test_an_inverted_surface_has_a_negative_volume() -> None:
    assert tetrahedron(TETRAHEDRON[:, ::-1]).volume == pytest.approx(-1.0, rel=1e-15)


def test_a_missing_triangle_opens_three_edges() -> None:
    seams = tetrahedron(TETRAHEDRON[:3]).seams
    assert (seams.open_edges, seams.crowded_edges, seams.turned_edges) == (3, 0, 0)
    assert seams.text == "3 open edges, which only one triangle has"


def test_a_turned_triangle_disagrees_along_three_edges() -> None:
    seams = tetrahedron([*TETRAHEDRON[:3], TETRAHEDRON[3, ::-1]]).seams
    assert (seams.open_edges, seams.crowded_edges, seams.turned_edges) == (0, 0, 3)


def test_a_fin_crowds_its_edge() -> None:
    fin = Surface(np.vstack([CORNERS, [1.0, -1.0, -1.0]]), np.vstack([TETRAHEDRON, [0, 1, 4]]))
    assert (fin.seams.open_edges, fin.seams.crowded_edges) == (2, 1)


def test_neighbours_share_an_edge() -> None:
    surface = octahedron_ball(1)
    for one, others in enumerate(surface.neighbours):
        for side, other in enumerate(others):
            edge = {surface.triangles[one, side], surface.triangles[one, (side + 1) % 3]}
            assert other != one
            assert edge <= set(surface.triangles[other])
    assert (tetrahedron(TETRAHEDRON[:3]).neighbours < 0).sum() == 3


def test_sharp_edges_part_patches() -> None:
    assert len(set(tetrahedron().patches)) == 4
    # Facets of a ball cut three times bend by less than 10° from one to the next.
    assert len(set(octahedron_ball(3).patches)) == 1


def test_smoothed_normals_of_a_ball_are_exact() -> None:
    # Max (1999), §2: the weights are exact for corners on a sphere, regular or not. A sum of n
    # terms is off by some n² ulps, over the cancellation of sides of 1/10 to their squares.
    smooth = octahedron_ball(3).smoothed()
    assert smooth.corner_normals is not None
    np.testing.assert_allclose(smooth.corner_normals, smooth.corners, atol=36 * 100 * 2.2e-16)


def test_smoothing_keeps_sharp_edges() -> None:
    smooth = tetrahedron().smoothed()
    assert smooth.corner_normals is not None
    flat = np.repeat(smooth.facet_normals[:, None], 3, axis=1)
    np.testing.assert_allclose(smooth.corner_normals, flat, atol=1e-15)


def test_a_triangle_without_area_has_no_normal() -> None:
    line = Surface(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]]))
    assert not line.facet_normals.any()


def test_a_turn_takes_the_normals_along() -> None:
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = tetrahedron().smoothed().moved(quarter)
    assert turned.corner_normals is not None
    np.testing.assert_allclose(turned.corner_normals[:, 0], turned.facet_normals, atol=1e-15)
    assert turned.volume == pytest.approx(1.0, rel=1e-15)
