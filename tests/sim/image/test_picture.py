"""A picture's colours follow from its spectral radiance, and its files hold it."""

import dataclasses

import numpy as np
import pytest
from PIL import Image

import scenes
from sim.errors import OutputError
from sim.image.exposure import automatic_stops
from sim.image.picture import Picture
from spectra import observer


def test_wavelengths_are_the_band_centres(synthetic_picture):
    film = synthetic_picture.scene.film
    np.testing.assert_allclose(synthetic_picture.wavelengths_nm, film.centres_nm, rtol=1e-15)


def test_xyz_integrates_the_colour_matching_functions_over_each_band(synthetic_picture):
    # XYZ = 683 lm/W Σ_b L_b ∫_b cmf dλ (CIE 015:2018, §7.1, for band means L_b).
    weights = observer("CIE 1931 2 degree").band_response(synthetic_picture.edges_nm)
    expected = 683.0 * np.einsum("hwb,bc->hwc", synthetic_picture.spectral_radiance, weights)
    np.testing.assert_allclose(synthetic_picture.xyz, expected, rtol=1e-12, atol=1e-15)


def test_linear_rgb_has_the_luminance_of_xyz_and_keeps_negative_channels(synthetic_picture):
    # IEC 61966-2-1: Y = 0.2126 R + 0.7152 G + 0.0722 B, with white at 683 cd/m².
    luminance = synthetic_picture.linear_rgb @ [0.2126, 0.7152, 0.0722]
    np.testing.assert_allclose(luminance, synthetic_picture.xyz[..., 1] / 683.0, atol=1e-12)
    assert synthetic_picture.linear_rgb[0, 0].min() < 0.0


def test_exposure_is_automatic_unless_the_scene_says(synthetic_picture):
    linear = synthetic_picture.linear_rgb
    assert synthetic_picture.exposure_stops == automatic_stops(linear)
    film = synthetic_picture.scene.film.model_copy(update={"exposure_stops": 3.5})
    scene = synthetic_picture.scene.model_copy(update={"film": film})
    fixed = dataclasses.replace(synthetic_picture, scene=scene)
    assert fixed.exposure_stops == 3.5
    np.testing.assert_array_equal(fixed.srgb, synthetic_picture.develop(exposure_stops=3.5))


def test_a_white_of_683_cd_m2_is_developed_to_white_at_0_stops(synthetic_picture):
    grey = dataclasses.replace(synthetic_picture)
    # The colour of the white point itself; develop() reads nothing but linear_rgb.
    grey.__dict__["linear_rgb"] = np.full((8, 12, 3), 0.5)
    assert (grey.develop(exposure_stops=1.0) == 255).all()
    # IEC 61966-2-1: 0.5 encodes to 1.055 · 0.5^(1/2.4) - 0.055 = 0.7354, times 255 is 187.5.
    assert np.isin(grey.develop(exposure_stops=0.0), [187, 188]).all()


def test_the_gamut_mapping_is_the_films(synthetic_picture):
    film = synthetic_picture.scene.film.model_copy(update={"gamut": "clip"})
    scene = synthetic_picture.scene.model_copy(update={"film": film})
    clipped = dataclasses.replace(synthetic_picture, scene=scene).srgb
    assert clipped[0, 0].min() == 0
    assert synthetic_picture.srgb.dtype == clipped.dtype == np.uint8
    assert (synthetic_picture.srgb[0, 0] != clipped[0, 0]).any()


def test_the_observer_is_the_films(synthetic_picture):
    film = synthetic_picture.scene.film.model_copy(update={"observer": "CIE 2015 2 degree"})
    scene = synthetic_picture.scene.model_copy(update={"film": film})
    other = dataclasses.replace(synthetic_picture, scene=scene)
    assert not np.allclose(other.xyz, synthetic_picture.xyz, rtol=1e-3)


def test_pictures_are_frozen(synthetic_picture):
    with pytest.raises(dataclasses.FrozenInstanceError):
        synthetic_picture.energy = None


def test_save_png(synthetic_picture, tmp_path):
    path = tmp_path / "out.png"
    synthetic_picture.save_png(path)
    with Image.open(path) as image:
        assert image.mode == "RGB"
        assert image.info["srgb"] == 0  # Perceptual.
        np.testing.assert_array_equal(np.asarray(image), synthetic_picture.srgb)
    synthetic_picture.save_png(path, exposure_stops=-3.0)
    with Image.open(path) as image:
        darker = synthetic_picture.develop(exposure_stops=-3.0)
        np.testing.assert_array_equal(np.asarray(image), darker)


@pytest.mark.parametrize("save", [Picture.save_exr, Picture.save_png])
def test_a_folder_that_is_not_there_is_told(synthetic_picture, tmp_path, save):
    with pytest.raises(OutputError, match="there is no folder"):
        save(synthetic_picture, tmp_path / "missing" / "out.file")


def test_a_scene_made_in_python_can_be_saved(synthetic_picture, tmp_path):
    scene = scenes.Scene(title="made in Python", film=synthetic_picture.scene.film)
    dataclasses.replace(synthetic_picture, scene=scene).save_exr(tmp_path / "out.exr")
