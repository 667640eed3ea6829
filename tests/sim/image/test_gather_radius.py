"""Discs are as wide as pixels are on what they see, and shrink as Knaus and Zwicker say."""

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.errors import SettingsError
from sim.image.gather_radius import NARROWEST, WIDEST, choose_gather_radius, radius_shrinkage
from sim.image.survey import Survey
from sim.scene_data import compile_scene
from sim.settings import RenderSettings

FILM = scenes.Film(width=48, height=32)


def make_survey(grid):
    grid = np.asarray(grid, dtype=float)
    widths = grid[np.isfinite(grid)]
    return Survey(
        widths=widths, points=np.zeros((len(widths), 3)),
        objects=np.zeros(len(widths), dtype=np.int32), width_grid=grid,
    )


def choose(grid, scene, **settings):
    plan = RenderSettings(**settings).resolved(scene)
    compiled = compile_scene(scene, device=start_device("cpu"))
    return choose_gather_radius(compiled, make_survey(grid), FILM, plan)


def test_the_median_pixel_has_two_pixel_widths_or_as_many_as_are_asked_for(small_scene):
    grid = np.geomspace(1e-3, 2e-3, 64).reshape(8, 8)
    assert choose(grid, small_scene).median == pytest.approx(2.0 * np.median(grid))
    wide = choose(grid, small_scene, radius_pixels=5.0)
    assert wide.median == pytest.approx(5.0 * np.median(grid))


def test_radii_follow_the_widths(small_scene):
    # Widths that grow as a power from left to right: logarithms are linear in x, which neither
    # the median of neighbours nor interpolation changes, but for half a sample at the borders.
    across = 1e-3 * 1.1 ** np.arange(12.0)
    radius = choose(np.tile(across, (8, 1)), small_scene)
    x = (np.arange(FILM.width) + 0.5) * 12 / FILM.width - 0.5
    expected = 1e-3 * 1.1**x / np.median(across)
    inside = (x >= 1.0) & (x <= 10.0)
    found = radius.scale[:, inside]
    # float32 rounds by 6e-8.
    np.testing.assert_allclose(found, np.tile(expected[inside], (FILM.height, 1)), rtol=1e-6)


def test_foci_and_horizons_are_kept_within_limits(small_scene):
    grid = np.ones((8, 8))
    grid[:3], grid[5:] = 1e-9, 1e9
    grid[3:5, :] = np.where(np.arange(8) % 2, 0.9, 1.1)
    scale = choose(grid, small_scene).scale
    assert scale.min() == pytest.approx(NARROWEST)
    assert scale.max() == pytest.approx(WIDEST)


def test_single_samples_and_what_sees_nothing_change_no_radius(small_scene):
    # One sample in four looks at reflections, and is NaN; an edge of glass is wide by chance.
    grid = np.full((8, 8), 2e-3)
    grid[1::2, 1::2] = np.nan
    grid[4, 4] = 1.0
    np.testing.assert_allclose(choose(grid, small_scene).scale, 1.0, rtol=1e-6)
    grid[:, :4] = np.nan
    np.testing.assert_allclose(choose(grid, small_scene).scale, 1.0, rtol=1e-6)


def test_a_radius_in_metres_is_the_same_everywhere(small_scene):
    radius = choose(np.geomspace(1e-3, 1e-1, 64).reshape(8, 8), small_scene, radius=0.25)
    assert radius.median == 0.25
    np.testing.assert_array_equal(radius.scale, np.ones((FILM.height, FILM.width)))


def test_without_a_receiver_in_view_there_has_to_be_a_radius(small_scene):
    nothing = np.full((8, 8), np.nan)
    with pytest.raises(SettingsError, match="radius"):
        choose(nothing, small_scene)
    assert choose(nothing, small_scene, radius=0.1).median == 0.1


@pytest.mark.parametrize("alpha", [2 / 3, 0.5, 1.0])
def test_the_radius_shrinks_as_knaus_and_zwicker_say(alpha):
    # r²ᵢ₊₁ / r²ᵢ = (i + α)/(i + 1), i = 1, 2, … (Knaus & Zwicker 2011, eq. 15).
    radii = np.array([radius_shrinkage(index, alpha) for index in range(20)])
    i = np.arange(1.0, 20.0)
    assert radii[0] == 1.0
    shrinkage = radii[1:] ** 2 / radii[:-1] ** 2
    np.testing.assert_allclose(shrinkage, (i + alpha) / (i + 1.0), rtol=1e-12)


def test_a_pixel_gathers_over_its_own_disc(darkroom, small_scene):
    # Twice the map's radius in every pixel is a map of twice the radius: the same photons, their
    # sums in another order. A pixel has some hundreds of them, each rounded by 1e-16 of the sum.
    def expose(radius, scale):
        room = darkroom(small_scene, photons=20_000, radius=radius)
        film = room.create_film(width=12, height=8, radius_scale=scale)
        room.expose(film, small_scene.camera)
        return film.radiance()

    np.testing.assert_allclose(expose(0.05, 2.0), expose(0.1, 1.0), rtol=1e-12)
    assert not np.allclose(expose(0.05, 1.0), expose(0.1, 1.0), rtol=1e-3)
