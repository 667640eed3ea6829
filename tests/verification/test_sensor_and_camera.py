"""A sensor flush with a floor, and the camera that looks at it, agree on how bright it is."""

import numpy as np
import pytest

import scenes
import sim

PASSES = 8
PHOTONS = 60_000
BLOCKS = 8
PIXELS = 12
"""The picture is BLOCKS² blocks of PIXELS² pixels; a block is a cell of the sensor."""
SIDE = 1.0
HEIGHT = 3.0
RHO = 0.6
FILM = scenes.Film(
    width=BLOCKS * PIXELS, height=BLOCKS * PIXELS, first_nm=425, last_nm=675, bands=6
)
CAMERA = scenes.Camera(
    position=(0.0, HEIGHT, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0),
    fov_deg=float(np.degrees(2.0 * np.arctan(0.5 * SIDE / HEIGHT))),
)
"""It looks straight down: pixels are equal squares of the floor, columns along x, rows along z."""


def make_scene():
    """A point lamp, and a pane of glass that part of its light goes through or is reflected by."""
    floor = scenes.SceneObject(
        name="floor",
        shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(3.0, 3.0)),
        material=scenes.Lambertian(reflectance=RHO),
    )
    pane = scenes.SceneObject(
        name="pane",
        shape=scenes.Box(position=(0.57, 0.45, -0.3), size=(0.02, 0.86, 0.9)),
        material=scenes.Dielectric(medium="N-BK7"),
    )
    lamp = scenes.Point(position=(0.7, 0.9, -0.3), flux=10.0, spectrum="A")
    sensor = scenes.IrradianceSensor(
        name="flush", pixels=(BLOCKS, BLOCKS),
        shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(SIDE, SIDE)),
    )
    return scenes.Scene(
        objects=(floor, pane), emitters=(lamp,), sensors=(sensor,), film=FILM, camera=CAMERA
    )


@pytest.fixture(scope="module")
def picture():
    """One run: the camera gathers the photons that the sensor counts.

    It finds direct light by shadow rays, where the sensor counts photons all the same.
    """
    settings = sim.RenderSettings(photons=PHOTONS, passes=PASSES, radius=0.02, alpha=1.0)
    return sim.render(make_scene(), settings)


def blocks_of(picture):
    """Irradiance in blocks by the camera, L = ρ E/π, (rows, columns, bands)."""
    radiance = picture.spectral_radiance.reshape(BLOCKS, PIXELS, BLOCKS, PIXELS, FILM.bands)
    return radiance.mean(axis=(1, 3)) * np.pi / RHO


def test_cells_agree(picture):
    reading = picture.sensors["flush"]
    assert (reading.passes, reading.origin.energy) == (PASSES, picture.energy)
    seen = blocks_of(picture).sum(axis=2) * FILM.spacing_nm
    # Blocks share their photons, so that the errors are not independent: their sum is enough. The
    # kernel moves photons over borders, and a pixel samples the pane's edges' shadow at points:
    # 1% of the mean.
    pixel = picture.standard_error.sum(axis=2) * FILM.spacing_nm * np.pi / RHO
    error = np.sqrt((pixel.reshape(BLOCKS, PIXELS, BLOCKS, PIXELS) ** 2).mean(axis=(1, 3)))
    allowed = 5.0 * reading.irradiance_error + error + 0.01 * reading.irradiance.mean()
    assert np.all(np.abs(seen - reading.irradiance) < allowed)
    assert np.median(reading.irradiance_error / reading.irradiance) < 0.005
    assert np.median(allowed / reading.irradiance) < 0.1


def test_bands_agree_on_the_whole(picture):
    # Over all cells the borders' light is but that of the rim, 4 · 20 mm of 1 m² gone or come.
    reading = picture.sensors["flush"]
    np.testing.assert_array_equal(reading.edges_nm, picture.edges_nm)
    measured = reading.spectral_irradiance.mean(axis=(0, 1))
    seen = blocks_of(picture).mean(axis=(0, 1))
    error = np.sqrt(np.sum(reading.standard_error**2, axis=(0, 1))) / BLOCKS**2
    assert np.all(np.abs(seen - measured) < 6.0 * error + 0.003 * measured)
    assert np.all(error < 0.005 * measured)


def test_light_through_the_pane_is_part_of_it(picture):
    # The pane takes 8% of what goes through it and throws as much back: without either the sides
    # of it would differ from the bare lamp's E = Φ h/(4π d³) by no more than noise.
    reading = picture.sensors["flush"]
    x, z = 0.5 * (reading.x[1:] + reading.x[:-1]), -0.5 * (reading.y[1:] + reading.y[:-1])
    distance = np.sqrt((x[None, :] - 0.7) ** 2 + 0.9**2 + (z[:, None] + 0.3) ** 2)
    bare = picture.energy.emitted * 0.9 / (4.0 * np.pi * distance**3)
    behind = reading.irradiance[3:5, :5] / bare[3:5, :5]
    assert np.all((behind > 0.75) & (behind < 0.97))
