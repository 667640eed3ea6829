import numpy as np
import pytest

from sim.device import start_device
from sim.study.triangle_bins import bin_triangles

SHAPE = (6, 8)
"""Rows and columns."""


@pytest.fixture(scope="module", autouse=True)
def device():
    return start_device("cpu")


def bins_of(corners, flux=None, shape=SHAPE):
    corners = np.asarray(corners, dtype=np.float64).reshape(-1, 3, 2)
    flux = np.ones(len(corners)) if flux is None else np.asarray(flux, dtype=np.float64)
    return bin_triangles(corners, flux, np.zeros(len(corners), int), (1, *shape))[0]


def test_a_right_triangle_is_cut_along_its_diagonal():
    # Legs of 3 bins from (1, 2): area 9/2; three bins on the diagonal hold 1/2, three below it 1.
    expected = np.zeros(SHAPE)
    expected[2, 1:4] = [1.0, 1.0, 0.5]
    expected[3, 1:3] = [1.0, 0.5]
    expected[4, 1] = 0.5
    for turned in ([(1, 2), (4, 2), (1, 5)], [(1, 5), (4, 2), (1, 2)]):  # either sense
        np.testing.assert_allclose(bins_of(turned, [4.5]), expected, rtol=1e-14, atol=1e-15)


def test_a_slanted_edge_leaves_areas_of_trapezoids():
    # From (0, 0) over (4, 0) to (4, 1): under y = x/4 a bin holds (x0 + x1)/8, the area is 2.
    found = bins_of([(0, 0), (4, 0), (4, 1)], [2.0])
    np.testing.assert_allclose(found[0, :4], [1 / 8, 3 / 8, 5 / 8, 7 / 8], rtol=1e-14)
    assert np.count_nonzero(found) == 4


def test_a_triangle_larger_than_the_grid_covers_every_bin_alike():
    # Density is flux over area, 5/(1000²/2).
    found = bins_of([(-300, -300), (700, -300), (-300, 700)], [5.0])
    np.testing.assert_allclose(found, 5.0 / 5e5, rtol=1e-9)


@pytest.fixture(scope="module")
def triangles():
    """Large, small and thin ones, on the grid and partly or wholly off it."""
    random = np.random.default_rng(3)
    middle = random.uniform(-2.0, 10.0, (4000, 1, 2))
    size = 10.0 ** random.uniform(-4.0, 0.7, (4000, 1, 1))
    thin = 10.0 ** random.uniform(-5.0, 0.0, (4000, 1, 1)) * np.array([0.0, 1.0]) + [1.0, 0.0]
    return middle + size * thin * random.normal(size=(4000, 3, 2))


def test_coarse_bins_are_sums_of_fine_ones(triangles):
    # However small a triangle's share of a bin: the same triangles on bins of 1/4 by 1/2.
    coarse = bins_of(triangles)
    fine = bins_of(triangles * [4.0, 2.0], shape=(SHAPE[0] * 2, SHAPE[1] * 4))
    summed = fine.reshape(SHAPE[0], 2, SHAPE[1], 4).sum(axis=(1, 3))
    np.testing.assert_allclose(coarse, summed, rtol=1e-9)


def test_flux_and_centre_of_gravity_stay(triangles):
    # All on a grid large enough: Σ bins = Σ flux. A triangle's middle is that of its corners, and
    # that of its bins, each of which it may fill unevenly, is at most half a bin away; in bins a
    # hundred times smaller, half of one of these.
    flux = np.random.default_rng(4).exponential(size=200)
    some = triangles[:200]
    low, high = some.min(axis=(0, 1)) - 0.5, some.max(axis=(0, 1)) + 0.5
    columns, rows = np.ceil((high - low) * 20.0).astype(int)
    found = bins_of((some - low) * 20.0, flux, (rows, columns))
    assert found.sum() == pytest.approx(flux.sum(), rel=1e-9)
    x = (np.arange(columns) + 0.5) @ found.sum(axis=0) / flux.sum()
    y = (np.arange(rows) + 0.5) @ found.sum(axis=1) / flux.sum()
    middle = ((some - low) * 20.0).mean(axis=1).T @ flux / flux.sum()
    # 200 independent halves of a bin: 0.29/√200 of a standard deviation, a fifth of a bin is far.
    assert np.hypot(x - middle[0], y - middle[1]) < 0.2


def test_points_and_lines_keep_their_flux():
    # Three equal corners, on an edge between bins too; a line counts where its middle is.
    point = [(2.0, 3.5)] * 3
    line = [(0.5, 0.5), (7.5, 5.5), (4.0, 3.0)]
    found = bins_of([point, line], [1.0, 2.0])
    expected = np.zeros(SHAPE)
    expected[3, 2], expected[3, 4] = 1.0, 2.0
    np.testing.assert_allclose(found, expected)


def test_layers_are_kept_apart_and_far_away_is_nowhere():
    inside, far = [(1.2, 1.2), (1.8, 1.2), (1.2, 1.8)], [(1e30, 0), (1e30, 1e30), (0.0, 1e30)]
    corners = np.array([inside, inside, far])
    bins = bin_triangles(corners, np.array([1.0, 2.0, 4.0]), np.array([0, 2, 1]), (3, *SHAPE))
    np.testing.assert_allclose(bins.sum(axis=(1, 2)), [1.0, 0.0, 2.0], atol=1e-12)


def test_nothing_is_dark():
    np.testing.assert_array_equal(bins_of(np.zeros((0, 3, 2))), np.zeros(SHAPE))
