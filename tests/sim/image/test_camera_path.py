"""Radiance on its way to the camera: (η_i/η_t)² and Fresnel at every boundary."""

import numpy as np
import pytest

import scenes
from sim.analytic import fresnel_reflectance
from spectra import glass

ETA = 1.5
R = ((ETA - 1.0) / (ETA + 1.0)) ** 2
"""Reflectance at normal incidence."""
RHO = 0.6
PASSES = 8
PLAIN = scenes.SellmeierMedium(b=(ETA**2 - 1.0,), c_um2=(0.0,), range_nm=(300.0, 900.0))
DOWN = (0.0, -1.0, 0.0)
FILM = scenes.Film(first_nm=425, last_nm=675, bands=6)

SHEET = scenes.SceneObject(
    name="sheet",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0)),
    material=scenes.Lambertian(reflectance=RHO),
)


def make_box(centre_y, height, medium, *, x=0.0, width=1.0, rotation_deg=(0.0, 0.0, 0.0)):
    return scenes.SceneObject(
        name="glass",
        shape=scenes.Box(
            position=(x, centre_y, 0.0), size=(width, height, width), rotation_deg=rotation_deg
        ),
        material=scenes.Dielectric(medium=medium),
    )


def make_beam(side, position, direction):
    """A square beam, `side` wide, of unit irradiance across it and over the film's range."""
    spectrum = scenes.SpectrumTable(wavelength_nm=(400.0, 700.0), values=(1.0, 1.0))
    return scenes.Beam(
        position=position, direction=direction, flux=side**2, spectrum=spectrum,
        profile=scenes.SlitProfile(width=side, height=side),
    )


ASIDE = make_beam(1.0, (-1.5, 1.5, 0.0), (1.0, -1.0, 0.0))
"""It comes from the side, below what the camera looks through, and meets the sheet at 45°."""
LIT = np.sqrt(0.5) * RHO / np.pi / 300.0
"""Spectral radiance of the sheet then, E cosθ ρ/π per nm."""


def block_means(darkroom, objects, beam, camera):
    """Mean over a small picture of each pass, (passes, bands)."""
    scene = scenes.Scene(objects=objects, emitters=(beam,), film=FILM)
    room = darkroom(scene, photons=20_000, radius=0.05, passes=PASSES)
    films = []
    for index in range(PASSES):
        films.append(room.create_film(width=16, height=16))
        room.expose(films[-1], camera, index)
    return np.array([film.radiance().mean(axis=(0, 1)) for film in films])


def straight_down(height):
    """A camera whose rays are within 6° of the vertical, where R is that of 0° to θ⁴ = 1e-4."""
    return scenes.Camera(
        position=(0.0, height, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=8.0
    )


def assert_radiance(assert_mean, means, expected):
    # θ⁴ of R = 0.04, and the square of the picture's obliquity elsewhere.
    assert_mean(means, expected, slack=1e-4 * np.max(expected))
    assert np.all(means.std(axis=0, ddof=1) < 0.05 * expected)


def test_without_glass(darkroom, assert_mean):
    means = block_means(
        darkroom, (SHEET, make_box(5.0, 0.1, PLAIN, x=9.0)), ASIDE, straight_down(3.0)
    )
    assert_radiance(assert_mean, means, np.full(6, LIT))


@pytest.mark.parametrize("medium", [PLAIN, "N-BK7"], ids=["plain", "N-BK7"])
def test_through_a_plate(darkroom, assert_mean, medium):
    # (η_i/η_t)² in and out is 1, and T = (1 − R)/(1 + R) with the reflections inside. With N-BK7 a
    # path for each band does it, without dispersion one for all.
    objects = (SHEET, make_box(2.0, 0.1, medium, width=0.5))
    means = block_means(darkroom, objects, ASIDE, straight_down(3.0))
    eta = glass(medium).eta(FILM.centres_nm) if isinstance(medium, str) else np.full(6, ETA)
    r = ((eta - 1.0) / (eta + 1.0)) ** 2
    assert_radiance(assert_mean, means, LIT * (1.0 - r) / (1.0 + r))


def test_from_inside_of_glass(darkroom, assert_mean):
    # A camera in the glass sees η² (1 − R) times the radiance outside, and as much times R², R⁴ …
    # that the lower face sends back and the upper one down again.
    objects = (SHEET, make_box(2.0, 0.5, PLAIN, width=0.5))
    means = block_means(darkroom, objects, ASIDE, straight_down(2.0))
    assert_radiance(assert_mean, means, np.full(6, ETA**2 / (1.0 + R) * LIT))


def test_into_glass(darkroom, assert_mean):
    # A sheet inside of a block, lit from above: (1 − R) of the light enters, and (1 − R)/η² of the
    # radiance comes out. What total reflection holds back the sheet absorbs.
    objects = (
        SHEET.model_copy(update={"shape": scenes.Rectangle(position=(0, 0, 0), size=(0.9, 0.9))}),
        make_box(0.0, 1.0, PLAIN),
    )
    beam = make_beam(0.8, (0.0, 2.0, 0.0), DOWN)
    means = block_means(darkroom, objects, beam, straight_down(3.0))
    expected = (1.0 - R) ** 2 / ETA**2 * RHO / np.pi / 300.0
    assert_radiance(assert_mean, means, np.full(6, expected))


def test_in_a_mirror_of_glass(darkroom, assert_mean):
    # A camera looks along x onto a plate at 45° and sees the sheet below, reflected by both faces:
    # R + (1 − R)² R / (1 − R²) = 2R/(1 + R) of s and of p, each with its own R at every face.
    plate = make_box(1.5, 0.02, PLAIN, width=1.0, rotation_deg=(0.0, 0.0, -45.0))
    camera = scenes.Camera(position=(-2.0, 1.5, 0.0), look_at=(0.0, 1.5, 0.0), fov_deg=2.0)
    beam = make_beam(1.0, (0.0, 1.0, -1.0), (0.0, -1.0, 1.0))
    means = block_means(darkroom, (SHEET, plate), beam, camera)
    # A turn of ±1° about 45° changes R by ±6% and, on average over the picture, by 1e-3 at most.
    r = np.array(fresnel_reflectance(np.sqrt(0.5), 1.0, ETA))
    expected = np.full(6, np.mean(2.0 * r / (1.0 + r)) * LIT)
    assert_mean(means, expected, slack=2e-3 * expected)
    assert np.all(means.std(axis=0) < 0.2 * expected)


def test_the_camera_sees_nothing_of_what_is_not_lit(darkroom):
    objects = (SHEET, make_box(2.0, 0.1, PLAIN, width=0.5))
    below = scenes.Camera(
        position=(0.0, -1.0, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=5.0
    )
    np.testing.assert_array_equal(block_means(darkroom, objects, ASIDE, below), 0.0)
