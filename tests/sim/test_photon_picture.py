"""Pass 1 as a picture: dots where the camera's pinhole sees the stored photons."""

import numpy as np
import pytest

import scenes
import sim
from sim.line_of_sight import in_sight
from sim.photon_picture import picture_photons
from sim.scene_data import compile_scene

SETTINGS = sim.RenderSettings(photons=4000, passes=1, direct_light="photons")
RED, BLUE = 650.0, 450.0


def bench(wavelength_nm=RED, *extra):
    """A narrow beam straight down at (0.25, 0, 0) of a floor, seen from right above the origin."""
    return scenes.Scene(
        film=scenes.Film(width=40, height=40, first_nm=400.0, last_nm=700.0, bands=4),
        camera=scenes.Camera(
            position=(0.0, 2.0, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=53.13
        ),
        objects=(
            scenes.SceneObject(
                shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0)),
                material=scenes.Lambertian(reflectance=0.5),
            ),
            *extra,
        ),
        emitters=(
            scenes.Beam(
                position=(0.25, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=1.0,
                profile=scenes.RoundProfile(radius=1e-4),
                spectrum=scenes.Laser(wavelength_nm=wavelength_nm),
            ),
        ),
    )  # fmt: skip


def lit(picture):
    return np.argwhere(picture.max(axis=-1) > 0)


def test_a_photon_is_drawn_where_it_lies():
    # tan(53.13°/2) = ½: the 40 pixels span 2 m on the floor, and x = 0.25 is 5 pixels right of the
    # middle; the spot lies on the pixel borders of row 20 and column 25, within rounding.
    places = lit(picture_photons(bench(), SETTINGS))
    assert set(places[:, 0]) <= {19, 20}
    assert set(places[:, 1]) <= {24, 25}


@pytest.mark.parametrize(("wavelength_nm", "strongest"), [(RED, 0), (BLUE, 2)])
def test_its_colour_is_that_of_its_wavelength(wavelength_nm, strongest):
    picture = picture_photons(bench(wavelength_nm), SETTINGS)
    (row, column), *_ = lit(picture)
    assert picture[row, column].argmax() == strongest


def test_only_photons_that_the_map_stores_are_drawn():
    # Shadow rays bring what comes straight from the lamp: the map holds none of it.
    only_glass = sim.RenderSettings(photons=4000, passes=1)
    assert len(lit(picture_photons(bench(), only_glass))) == 0


def test_glass_hides_nothing_and_the_rest_does():
    glass = scenes.SceneObject(
        shape=scenes.Sphere(position=(0.5, 1.0, 0.0), radius=0.1),
        material=scenes.Dielectric(medium="N-BK7"),
    )
    lid = scenes.SceneObject(
        shape=scenes.Rectangle(position=(-0.5, 1.0, 0.0), size=(0.2, 0.2)),
        material=scenes.Absorber(),
    )
    compiled = compile_scene(bench(RED, glass, lid))
    # Seen from (0, 2, 0), what lies at (±1, 0, 0) is behind what is at (±0.5, 1, 0).
    points = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.5]])
    assert in_sight(compiled, (0.0, 2.0, 0.0), points).tolist() == [True, False, True]
