"""Automatic exposure, against its definition."""

import numpy as np
import pytest

import scenes
from sim.image.exposure import WHITE_QUANTILE, automatic_stops, lamp_level, scene_stops


def test_a_uniform_picture_is_developed_to_white():
    # Level 0.25 everywhere: 2**2 brings it to 1.
    assert automatic_stops(np.full((4, 5, 3), 0.25)) == pytest.approx(2.0, abs=1e-12)


def test_the_largest_channel_counts_not_the_luminance():
    blue = np.zeros((4, 5, 3))
    blue[..., 2] = 0.125
    assert automatic_stops(blue) == pytest.approx(3.0, abs=1e-12)


def test_dark_pixels_and_a_few_bright_ones_do_not_count():
    picture = np.zeros((100, 100, 3))
    picture[:10] = 0.5
    picture[0, :5] = 1e6  # 5 of 1000 lit pixels: fewer than 1 - WHITE_QUANTILE of them.
    assert 5 / 1000 < 1.0 - WHITE_QUANTILE
    assert automatic_stops(picture) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("value", [0.0, -1.0])
def test_a_black_picture_needs_none(value):
    assert automatic_stops(np.full((2, 2, 3), value)) == 0.0


def test_the_unit_does_not_matter():
    picture = np.random.default_rng(1).exponential(1.0, (20, 30, 3))
    shifted = automatic_stops(picture * 2.0**-17) - automatic_stops(picture)
    assert shifted == pytest.approx(17.0, abs=1e-12)


def test_lamps_do_not_count_unless_there_is_little_else():
    picture = np.full((10, 10, 3), 0.5)
    picture[:2] = 1000.0
    assert automatic_stops(picture, 1500.0) == pytest.approx(1.0, abs=1e-12)
    picture[:6] = 1000.0
    assert automatic_stops(picture, 1500.0) == pytest.approx(-np.log2(1000.0), abs=1e-12)


def lamp(flux, **fields):
    return scenes.RectangleLamp(
        position=(0.0, 0.0, 0.0), size=(0.5, 0.4), flux=flux, spectrum="D65", **fields
    )


def test_a_lamps_level_is_its_pictures():
    # D65 of luminance 683 cd/m² is (1, 1, 1); its luminance is 683 ∫ L_λ ȳ dλ.
    film = scenes.Film(first_nm=380, last_nm=780, bands=81)
    scene = scenes.Scene(film=film, emitters=(lamp(3.0), lamp(1.0), lamp(0.1, visible=False)))
    from spectra.observer import observer

    spectrum = scene.emitters[0].emission()
    density = spectrum.band_flux(film.edges_nm) / spectrum.total / film.spacing_nm
    radiance = 1.0 / (np.pi * 0.2) * density
    luminance = observer(film.observer).xyz(radiance, film.edges_nm)[1]
    # 1 % for bands that are 5 nm wide, and a white point of four digits.
    assert lamp_level(scene) == pytest.approx(luminance / 683.0, rel=0.01)
    assert lamp_level(scenes.Scene()) == np.inf


def test_a_camera_exposes_as_a_photographers_does():
    view = {"position": (0.0, 0.0, 0.0), "look_at": (0.0, 0.0, -1.0), "fov_deg": 40.0}
    # "Sunny 16": f/16, 1/100 s, ISO 100 is for sunlit white paper, 16,000 to 32,000 cd/m². The
    # formula's 120 N²/(S t) = 120 · 256 = 30,720.
    sunny = scenes.SensorExposure(iso=100.0, shutter_s=0.01, f_number=16.0)
    camera = scenes.Camera(**view, exposure=sunny)
    assert camera.white_luminance == pytest.approx(30_720.0, rel=1e-12)
    stops = scene_stops(scenes.Scene(camera=camera))
    assert 683.0 * 2.0**-stops == pytest.approx(30_720.0, rel=1e-12)
    assert scene_stops(scenes.Scene(camera=scenes.Camera(**view))) is None


def test_the_f_number_is_the_lens_own_unless_another_is_given():
    view = {"position": (0.0, 0.0, 0.0), "look_at": (0.0, 0.0, -1.0), "fov_deg": 40.0}
    bare = scenes.SensorExposure(iso=200.0, shutter_s=0.5)
    fast = scenes.Camera(**view, f_number=2.0, exposure=bare)
    assert fast.white_luminance == pytest.approx(120.0 * 4.0 / 100.0, rel=1e-12)
    same = scenes.Camera(**view, aperture_radius=fast.lens_radius, exposure=bare)
    assert same.white_luminance == pytest.approx(fast.white_luminance, rel=1e-12)
    given = scenes.SensorExposure(iso=200.0, shutter_s=0.5, f_number=4.0)
    other = scenes.Camera(**view, f_number=2.0, exposure=given)
    assert other.white_luminance == pytest.approx(4.0 * fast.white_luminance, rel=1e-12)
    with pytest.raises(scenes.SceneError, match=r"exposure\.f_number: must be given"):
        scenes.Camera(**view, exposure=bare)
    with pytest.raises(scenes.SceneError, match=r"film\.exposure_stops: must be left out"):
        scenes.Scene(camera=other, film=scenes.Film(exposure_stops=1.0))
