"""The film averages passes, and says how sure it is."""

import numpy as np
import pytest

import scenes
from spectra.observer import observer

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0)),
    material=scenes.Lambertian(reflectance=0.8),
)
WEDGE = scenes.SceneObject(
    name="wedge",
    shape=scenes.Prism(
        position=(0.5, 0.6, 0.0), rotation_deg=(90, 0, 0), apex_deg=40.0, base=0.3, length=0.2
    ),
    material=scenes.Dielectric(medium="SF11"),
)
LAMP = scenes.Point(position=(-0.5, 1.5, 0.2), flux=1.0, spectrum="D65")
PASSES = 8
AWAY = scenes.Camera(position=(-0.5, 1.0, 0.5), look_at=(-0.5, 0.0, 0.3), fov_deg=20.0)
THROUGH = scenes.Camera(position=(0.5, 1.6, 0.3), look_at=(0.5, 0.6, 0.0), fov_deg=12.0)
"""Cameras that see no glass, and that look through it."""


@pytest.fixture(scope="module")
def room(darkroom):
    film = scenes.Film(first_nm=425, last_nm=675, bands=6)
    scene = scenes.Scene(objects=(FLOOR, WEDGE), emitters=(LAMP,), film=film)
    return darkroom(scene, photons=4000, radius=0.1, passes=PASSES)


def expose(room, camera, pass_indices, *, passes):
    film = room.create_film(width=8, height=6, passes=passes)
    for index in pass_indices:
        room.expose(film, camera, index)
    return film


def singles(room, camera):
    """Each pass on a film of its own, (passes, height, width, bands)."""
    films = [expose(room, camera, [index], passes=1) for index in range(PASSES)]
    return np.array([film.radiance() for film in films])


@pytest.mark.parametrize("passes", [2, 3, 5, 8])
def test_mean_and_standard_error_are_numpys(room, passes):
    film = expose(room, AWAY, range(passes), passes=passes)
    assert film.radiance().shape == (6, 8, 6)
    # Rounds of passes are the replicates: they scatter by σ, the mean of n of them by σ/√n.
    starts = range(0, passes, film.turns)
    each = [
        expose(room, AWAY, range(start, start + film.turns), passes=passes) for start in starts
    ]
    rounds = np.array([one.radiance() for one in each])
    assert len(rounds) == film.rounds >= 2
    np.testing.assert_allclose(film.radiance(), rounds.mean(axis=0), rtol=1e-12)
    error = rounds.std(axis=0, ddof=1) / np.sqrt(len(rounds))
    np.testing.assert_allclose(film.standard_error(), error, rtol=1e-9, atol=1e-12 * error.max())
    assert film.standard_error().min() > 0.0


@pytest.mark.parametrize("camera", [AWAY, THROUGH], ids=["away", "through"])
def test_the_luminance_is_the_bands_and_its_noise_theirs(room, camera):
    # Y = Σ L_b 683 ∫ ȳ dλ; the noise is that of the rounds' Y, in which bands vary together.
    film = expose(room, camera, range(PASSES), passes=PASSES)
    accuracy = film.accuracy()
    eye = observer(room.scene.film.observer)
    expected = eye.xyz(film.radiance(), film.edges_nm)[..., 1]
    np.testing.assert_allclose(accuracy.luminance, expected, rtol=1e-12)
    rounds = np.array(
        [
            eye.xyz(expose(room, camera, [i, i + 1], passes=PASSES).radiance(), film.edges_nm)
            for i in range(0, PASSES, 2)
        ]
    )[..., 1]
    assert accuracy.replicates == len(rounds) == 4
    noise = rounds.std(axis=0, ddof=1) / 2.0
    np.testing.assert_allclose(accuracy.noise, noise, rtol=1e-9, atol=1e-12 * noise.max())


def test_one_pass_has_no_error(room):
    film = expose(room, AWAY, [0], passes=1)
    assert np.isnan(film.standard_error()).all()
    assert film.radiance().min() > 0.0


def test_the_order_of_films_does_not_matter(room):
    # A pass adds the same to any film, whatever the room was used for before.
    first = singles(room, THROUGH)[3]
    expose(room, AWAY, range(4), passes=4)
    np.testing.assert_array_equal(expose(room, THROUGH, [3], passes=1).radiance(), first)


def test_what_is_seen_through_glass_is_sampled_evenly(room):
    # However passes share the bands behind glass, eight of them estimate what they do singly, from
    # the same photons but through other points of the pixels. Means over the pixels scatter by
    # `spread`, and by up to √2 times that where each band has half as many looks.
    each = singles(room, THROUGH)
    film = expose(room, THROUGH, range(PASSES), passes=PASSES)
    assert each.mean() > 0.0
    spread = each.mean(axis=(1, 2)).std(axis=0, ddof=1) / np.sqrt(PASSES)
    off = np.abs(film.radiance().mean(axis=(0, 1)) - each.mean(axis=(0, 1, 2)))
    assert np.all(off < 5.0 * np.sqrt(3.0) * spread)
    assert np.all(spread < 0.1 * each.mean(axis=(0, 1, 2)))
    # Each pixel and band has been looked at.
    assert np.all((film.radiance() > 0.0) == (each.sum(axis=0) > 0.0))
