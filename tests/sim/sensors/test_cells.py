"""Areas of the cells of rectangles and disks."""

import numpy as np
import pytest

from sim.sensors.cells import cell_areas, cell_edges


def test_a_rectangles_cells_are_equal():
    areas = cell_areas(np.array([1.5, 0.5]), (6, 4))
    np.testing.assert_allclose(areas, np.full((4, 6), 3.0 / 24.0), rtol=1e-14)


def test_edges_run_right_and_down():
    x, y = cell_edges(np.array([1.5, 0.5]), (3, 2))
    np.testing.assert_allclose(x, [-1.5, -0.5, 0.5, 1.5])
    np.testing.assert_allclose(y, [0.5, 0.0, -0.5])


@pytest.mark.parametrize("pixels", [(1, 1), (2, 2), (3, 3), (64, 64), (5, 8), (1, 7)])
def test_a_disks_cells_add_up_to_it(pixels):
    radius = 0.3
    areas = cell_areas(np.full(2, radius), pixels, radius=radius)
    assert areas.shape == pixels[::-1]
    # π r², a sum of differences of numbers of the order of r².
    assert areas.sum() == pytest.approx(np.pi * radius**2, rel=1e-13)
    assert np.all(areas >= 0.0)
    np.testing.assert_allclose(areas, areas[::-1], rtol=0.0, atol=1e-16)
    np.testing.assert_allclose(areas, areas[:, ::-1], rtol=0.0, atol=1e-16)


def test_cells_of_a_disk_against_known_areas():
    # Quadrants of the unit disk: π/4. Nine cells of 2/3: the middle one is whole; one at a side
    # is a third of a square short of a segment: half the disk above y = 1/3 less the corner.
    np.testing.assert_allclose(cell_areas(np.ones(2), (2, 2), radius=1.0), np.pi / 4, rtol=1e-14)
    nine = cell_areas(np.ones(2), (3, 3), radius=1.0)
    assert nine[1, 1] == pytest.approx(4.0 / 9.0, rel=1e-14)
    # ∫ √(1 − s²) − 1/3 ds over |s| < 1/3 is what lies above the middle cell.
    third = 1.0 / 3.0
    above = third * np.sqrt(1.0 - third**2) + np.arcsin(third) - 2.0 / 9.0
    assert nine[0, 1] == pytest.approx(above, rel=1e-14)
    assert nine[1, 0] == pytest.approx(above, rel=1e-14)
    corner = (np.pi - 4.0 / 9.0 - 4.0 * above) / 4.0
    assert nine[0, 0] == pytest.approx(corner, rel=1e-13)


def test_cells_outside_the_disk_have_no_area_at_all():
    areas = cell_areas(np.ones(2), (16, 16), radius=1.0)
    assert areas[0, 0] == 0.0
    inside = cell_areas(np.ones(2), (4, 4), radius=3.0)
    np.testing.assert_allclose(inside, 0.25, rtol=1e-13)
