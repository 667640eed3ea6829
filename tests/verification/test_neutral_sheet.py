"""Light without colour stays without colour behind a plain sheet of glass."""

import numpy as np
import pytest

import scenes
import sim
from sim.analytic import slab_transmittance
from spectra import glass, observer, xyz_to_linear_srgb
from spectra.units import LUMINOUS_EFFICACY_LM_W

BLOCK = 16


@pytest.fixture(scope="module")
def picture():
    sheet = scenes.Box(position=(0.0, 2.0, 0.0), size=(6.0, 0.05, 6.0))
    floor = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(9.0, 9.0))
    scene = scenes.Scene(
        film=scenes.Film(width=256, height=256),
        camera=scenes.Camera(position=(0.0, 1.6, 2.0), look_at=(0.0, 0.0, 0.0), fov_deg=40.0),
        objects=(
            scenes.SceneObject(shape=sheet, material=scenes.Dielectric(medium="N-BK7")),
            scenes.SceneObject(shape=floor, material=scenes.Lambertian(reflectance=0.8)),
        ),
        emitters=(
            scenes.SphereLamp(position=(-0.5, 3.0, 0.5), radius=0.1, flux=100.0, spectrum="E"),
        ),
    )
    return sim.render(scene)


def deviations(picture, spectrum):
    """Blocks' linear RGB over their luminance, relative to that of `spectrum`, minus 1."""
    side = picture.scene.film.height // BLOCK
    expected = xyz_to_linear_srgb(
        observer(picture.scene.film.observer).xyz(spectrum, picture.edges_nm)
        / LUMINOUS_EFFICACY_LM_W
    )
    blocks = picture.linear_rgb.reshape(side, BLOCK, side, BLOCK, 3).mean(axis=(1, 3))
    luminance = np.array([0.2126, 0.7152, 0.0722])  # IEC 61966-2-1, Y of linear sRGB
    return (blocks / (blocks @ luminance)[..., None]) / (expected / (expected @ luminance)) - 1.0


def test_every_block_is_neutral_within_one_per_cent(picture):
    # Equal energy in every band gives XYZ ∝ ∫ cmf dλ over the film; the blocks' linear RGB over
    # their luminance is held against that. The glass itself takes 0.2 % more of the blue.
    flat = np.ones(len(picture.wavelengths_nm))
    assert np.all(np.abs(deviations(picture, flat)) < 0.01)


def test_seen_through_the_sheet_it_is_neutral_too(picture):
    # A camera above the sheet follows a path for each band. The sheet's second crossing takes
    # another 0.2 % of the blue, T = (1 − R)/(1 + R): that much is expected.
    camera = scenes.Camera(
        position=(0.0, 2.9, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=40.0
    )
    scene = picture.scene.model_copy(update={"camera": camera})
    seen = sim.render(scene, sim.RenderSettings(photons=400_000, passes=4))
    transmittance = slab_transmittance(0.0, glass("N-BK7").eta(seen.wavelengths_nm))
    assert np.all(np.abs(deviations(seen, transmittance)) < 0.01)
    # Noise, not colour: on the whole it is neutral to a fraction of that.
    whole = deviations(seen, transmittance**2).mean(axis=(0, 1))
    np.testing.assert_allclose(whole, 0.0, atol=5e-4)
