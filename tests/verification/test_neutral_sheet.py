"""Light without colour stays without colour behind a plain sheet of glass."""

import numpy as np

import scenes
import sim
from sim.analytic import slab_transmittance
from spectra import glass, observer, xyz_to_linear_srgb
from spectra.units import LUMINOUS_EFFICACY_LM_W

BLOCK = 16
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Y of linear sRGB (IEC 61966-2-1)."""


def make_scene(*, camera_y, pixels):
    """A white floor that fills the picture, under a sheet of glass and a lamp of equal energy."""
    sheet = scenes.Box(position=(0.0, 2.5, 0.0), size=(5.0, 0.02, 5.0))
    floor = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0))
    objects = (
        scenes.SceneObject(shape=sheet, material=scenes.Dielectric(medium="N-BK7")),
        scenes.SceneObject(shape=floor, material=scenes.Lambertian(reflectance=0.8)),
    )
    # Its mirror image in the sheet is no part of what is seen through it.
    lamp = scenes.SphereLamp(
        position=(0.3, 3.0, -0.2), radius=0.1, flux=100.0, spectrum="E", visible=False
    )
    camera = scenes.Camera(
        position=(0.0, camera_y, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0),
        fov_deg=float(np.degrees(2.0 * np.arctan(0.97 / camera_y))),
    )
    film = scenes.Film(width=pixels, height=pixels)
    return scenes.Scene(film=film, camera=camera, objects=objects, emitters=(lamp,))


def deviations(picture, spectrum):
    """Blocks' linear RGB over their luminance, relative to that of `spectrum`, minus 1."""
    side = picture.scene.film.height // BLOCK
    expected = xyz_to_linear_srgb(
        observer(picture.scene.film.observer).xyz(spectrum, picture.edges_nm)
        / LUMINOUS_EFFICACY_LM_W
    )
    blocks = picture.linear_rgb.reshape(side, BLOCK, side, BLOCK, 3).mean(axis=(1, 3))
    return blocks / (blocks @ LUMINANCE)[..., None] / (expected / (expected @ LUMINANCE)) - 1.0


def sheet_transmittance(picture):
    """Of one crossing near the normal, T = (1 − R)/(1 + R): 0.2% less for blue than for green."""
    return slab_transmittance(0.0, glass("N-BK7").eta(picture.wavelengths_nm))


def test_every_block_is_neutral_within_one_per_cent():
    # Equal energy in every band gives XYZ ∝ ∫ cmf dλ over the film; the blocks' linear RGB over
    # their luminance is held against that.
    scene = make_scene(camera_y=2.2, pixels=256)
    picture = sim.render(scene, sim.RenderSettings(photons=400_000, passes=4))
    assert np.all(np.abs(deviations(picture, np.ones(31))) < 0.01)
    # Noise, not colour: the whole has only the colour that the glass gives it.
    whole = deviations(picture, sheet_transmittance(picture)).mean(axis=(0, 1))
    np.testing.assert_allclose(whole, 0.0, atol=5e-4)


def test_seen_through_the_sheet_it_is_neutral_too():
    # A camera above the sheet follows a path for each band. The second crossing takes another
    # 0.2% of the blue, which is expected here.
    scene = make_scene(camera_y=2.9, pixels=128)
    picture = sim.render(scene, sim.RenderSettings(photons=300_000, passes=4))
    once = sheet_transmittance(picture)
    assert np.all(np.abs(deviations(picture, once)) < 0.01)
    whole = deviations(picture, once**2).mean(axis=(0, 1))
    np.testing.assert_allclose(whole, 0.0, atol=5e-4)
