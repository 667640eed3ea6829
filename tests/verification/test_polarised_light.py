"""Photons and pictures of polarised light, against closed forms."""

import math

import numpy as np
import pytest

import scenes
import sim
from sim import analytic
from sim.analytic_polarisation import plate_stack_transmittance, retarding_incidences
from sim.device import start_device
from sim.errors import SettingsError
from sim.photons.lamps import compile_lamps
from sim.photons.tracing import trace_photons
from sim.scene_data import compile_scene

PASSES = 16
BREWSTER = math.atan(1.5)
R_S = (1.25 / 3.25) ** 2  # ((n² − 1)/(n² + 1))² (Born & Wolf 1999, §1.5.3)
GLASS = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
ONE_BAND = scenes.Film(width=3, height=2, bands=1, first_nm=550, last_nm=550, band_width_nm=10)


def beam(*, polarisation=None, **fields):
    return scenes.Beam(
        position=(-1.0, 0.0, 0.0), direction=(1.0, 0.0, 0.0), flux=1.0, spectrum="E",
        profile=scenes.RoundProfile(radius=0.005), polarisation=polarisation, **fields,
    )  # fmt: skip


def bench(objects, **fields):
    """A beam along +x through `objects`, onto a screen behind them that takes in all of it."""
    screen = scenes.SceneObject(
        name="screen",
        shape=scenes.Disk(position=(1.0, 0.0, 0.0), normal=(-1.0, 0.0, 0.0), radius=20.0),
        material=scenes.Lambertian(reflectance=0.0),
    )
    things = [scenes.SceneObject(shape=shape, material=material) for shape, material in objects]
    return scenes.Scene(film=ONE_BAND, objects=[screen, *things], emitters=[beam(**fields)])


def plate(x, turn):
    size = (0.001, 2.0, 2.0)
    return scenes.Box(position=(x, 0.0, 0.0), size=size, rotation_deg=turn), GLASS


def transmitted(scene, polarisation="auto", *, photons=512):
    """Fraction of the flux that reaches the screen along +x, one a pass; the books must balance.

    What plates reflect reaches the screen as well, but not in this direction.
    """
    compiled = compile_scene(scene, device=start_device("cpu"), polarisation=polarisation)
    lamps = compile_lamps(compiled, scene.film.edges_nm, photons)
    found = []
    for index in range(PASSES):
        batch = trace_photons(
            compiled, lamps, seed=0, pass_index=index, max_interactions=1024, threads=2
        )
        books = batch.books
        went = books.deposited + books.absorbed + books.escaped + books.culled
        assert went == pytest.approx(books.emitted, rel=1e-12)
        deposits = batch.to_numpy()
        on_screen = (deposits["object"] == 0) & (deposits["direction"][:, 0] > 1.0 - 1e-6)
        found.append(float(np.sum(deposits["flux"][on_screen])) / lamps.flux)
    return np.array(found), compiled.features


TILT = (0.0, 0.0, math.degrees(BREWSTER))
STACK = bench([plate(0.004 * k, TILT) for k in range(10)])


@pytest.mark.parametrize("mode", ["auto", "s-p", "stokes"])
def test_ten_brewster_plates(assert_mean, mode):
    # (1 − r)/(1 + 19 r) for s and 1 for p (Stokes 1862), all reflections between them summed.
    of_s, of_p = plate_stack_transmittance(BREWSTER, 1.5, 10)
    found, features = transmitted(STACK, mode)
    assert features.light_of("photons") == ("s-p" if mode == "s-p" else "stokes")
    assert_mean(found, 0.5 * (of_s + of_p))


def test_averages_get_ten_brewster_plates_wrong(assert_mean):
    # (1 − r)/(1 + 19 r) of the mean r: 37 % less. Why polarisation is there, and how averages are.
    found, features = transmitted(STACK, "averaged")
    assert features.light_of("photons") == "averaged"
    wrong = (1.0 - 0.5 * R_S) / (1.0 + 9.5 * R_S)
    assert_mean(found, wrong)
    of_s, of_p = plate_stack_transmittance(BREWSTER, 1.5, 10)
    assert wrong == pytest.approx(0.63 * 0.5 * (of_s + of_p), rel=0.01)


CROSSED = bench([plate(-0.2, TILT), plate(0.2, (0.0, math.degrees(BREWSTER), 0.0))])


def test_crossed_plates_need_frames(assert_mean):
    # A plate lets t = (1 − R_s)/(1 + R_s) of its s through and all of p; s of the one is p of the
    # other, so that both give t. As if in one plane, it would be ½ (1 + t²).
    t = (1.0 - R_S) / (1.0 + R_S)
    assert_mean(transmitted(CROSSED)[0], t)
    assert_mean(transmitted(CROSSED, "s-p")[0], 0.5 * (1.0 + t * t))


def sheet(x, axis):
    disk = scenes.Disk(position=(x, 0.0, 0.0), normal=(1.0, 0.0, 0.0), radius=0.2)
    return disk, scenes.Polariser(axis=axis)


@pytest.mark.parametrize(
    ("light", "expected"),
    [
        (None, 0.5),
        (scenes.Polarisation(up=(0.0, 1.0, 0.0), angle_deg=30.0), 0.75),
        (scenes.Polarisation(up=(0.0, 1.0, 0.0), angle_deg=30.0, degree=0.5), 0.625),
        (scenes.Polarisation(ellipticity_deg=-45.0), 0.5),
    ],
)
def test_polarised_lamps_obey_malus(light, expected):
    # ½ (1 + P cos 2α) of what vibrates at α to the axis (Hecht 2017, §8.2.1); natural light ½.
    scene = bench([sheet(0.0, (0.0, 1.0, 0.0))], polarisation=light)
    found, _ = transmitted(scene, photons=64)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_averages_know_a_polariser_as_a_grey_sheet():
    scene = bench([sheet(0.0, (0.0, 1.0, 0.0)), sheet(0.1, (0.0, 0.0, 1.0))])
    found, _ = transmitted(scene, "averaged", photons=64)
    np.testing.assert_allclose(found, 0.25, rtol=1e-12)
    found, _ = transmitted(scene, photons=64)
    np.testing.assert_allclose(found, 0.0, atol=1e-30)


def test_shares_of_s_and_p_refuse_polarised_lamps():
    scene = bench([plate(0.0, TILT)], polarisation=scenes.Polarisation())
    with pytest.raises(SettingsError, match="emitters\\[0\\] polarises in a plane of its own"):
        transmitted(scene, "s-p")


def looking_at_a_reflection(axis):
    """A camera that sees a screen by a plate at Brewster's angle, through a polariser.

    The camera looks along +x; the plate in the origin sends its look along (cos 2β, sin 2β), β the
    angle of its face, to a screen there, which a beam lights evenly from its front.
    """
    angle = 0.5 * math.pi - BREWSTER  # of the face to the x axis
    way = np.array([math.cos(2.0 * angle), math.sin(2.0 * angle), 0.0])
    screen = scenes.Disk(position=tuple(way), normal=tuple(-way), radius=0.2)
    lamp = scenes.Beam(
        position=tuple(way + 0.5 * np.array([-way[0], -way[1], 1.0])),
        direction=(way[0], way[1], -1.0), flux=1.0, spectrum="E",
        profile=scenes.RoundProfile(radius=0.1),
    )  # fmt: skip
    return scenes.Scene(
        film=ONE_BAND,
        camera=scenes.Camera(position=(-1.0, 0.0, 0.0), look_at=(0.0, 0.0, 0.0), fov_deg=0.5),
        objects=[
            scenes.SceneObject(
                name="plate",
                shape=scenes.Box(
                    position=(0.0005 * math.sin(angle), -0.0005 * math.cos(angle), 0.0),
                    size=(0.2, 0.001, 0.2), rotation_deg=(0.0, 0.0, math.degrees(angle)),
                ),
                material=GLASS,
            ),
            scenes.SceneObject(
                name="screen", shape=screen, material=scenes.Lambertian(reflectance=0.8)
            ),
            scenes.SceneObject(
                name="filter",
                shape=scenes.Disk(position=(-0.5, 0.0, 0.0), normal=(1.0, 0.0, 0.0), radius=0.05),
                material=scenes.Polariser(axis=axis),
            ),
        ],
        emitters=[lamp],
    )  # fmt: skip


@pytest.mark.parametrize("degrees", [0.0, 45.0, 90.0])
def test_a_filter_takes_reflections_away(degrees):
    angle = math.radians(degrees)
    scene = looking_at_a_reflection((0.0, math.sin(angle), math.cos(angle)))
    picture = sim.render(
        scene, sim.RenderSettings(photons=4096, passes=8, threads=2, radius=0.01)
    )
    # Of the screen's radiance L the plate sends 2 R/(1 + R) of s back, both faces summed, and none
    # of p; a filter at α to s passes ½ cos²α of it. E = Φ cos 45°/(π r²) of the beam, L = ρ E/π.
    lit = float(scene.emitters[0].emission().band_flux(ONE_BAND.edges_nm)[0])
    flux = lit / scene.emitters[0].emission().total
    radiance = 0.8 * flux * math.sqrt(0.5) / (math.pi * 0.1**2) / math.pi / 10.0
    expected = radiance * 0.5 * math.cos(angle) ** 2 * 2.0 * R_S / (1.0 + R_S)
    # Half the picture is 0.003 rad across: 2 R_p' of that is some 1e-5 of p, and R_s changes by
    # some 3e-3 from edge to edge, and less in the mean. The paths' roulette is all the noise.
    found = picture.spectral_radiance[..., 0]
    noise = picture.standard_error[..., 0]
    mean, error = float(found.mean()), float(np.sqrt(np.mean(noise**2) / noise.size))
    assert abs(mean - expected) <= 5.0 * error + 2e-3 * expected + 1e-4 * radiance


def test_reflectance_of_the_slab_is_that_of_analytic():
    # What the test above is built on: 2 R/(1 + R) is the lossless slab's (Duffie & Beckman 2013).
    assert 0.5 * 2.0 * R_S / (1.0 + R_S) == pytest.approx(
        float(analytic.slab_split(BREWSTER, 1.5).reflected), rel=1e-12
    )


def looking_through_a_rhomb(lamp_light, axis):
    """A camera that looks along +x through a filter and Fresnel's rhomb at a lamp.

    Both reflections retard s, along z, by 45° over p.
    """
    eta, width = 1.51, 0.02
    theta = float(retarding_incidences(math.pi / 4, eta)[1])
    slope = 2.0 * width * math.tan(theta) * np.array([math.sin(theta), math.cos(theta)])
    across = np.array([0.0, width])
    corners = np.array([0.0 * across, across, slope + across, slope])
    vertices = [(float(x), float(y), z) for x, y in corners for z in (-0.01, 0.01)]
    middle = 0.5 * width
    return scenes.Scene(
        film=ONE_BAND,
        camera=scenes.Camera(
            position=(-0.1, middle, 0.0), look_at=(0.0, middle, 0.0), fov_deg=0.1
        ),
        objects=[
            scenes.SceneObject(
                name="filter",
                shape=scenes.Disk(
                    position=(-0.05, middle, 0.0), normal=(1.0, 0.0, 0.0), radius=0.01
                ),
                material=scenes.Polariser(axis=axis),
            ),
            scenes.SceneObject(
                name="rhomb",
                shape=scenes.Polyhedron(position=(0.0, 0.0, 0.0), vertices=vertices),
                material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=eta)),
            ),
        ],
        emitters=[
            scenes.RectangleLamp(
                position=(0.3, 0.05, 0.0), normal=(-1.0, 0.0, 0.0), size=(0.2, 0.2), flux=1.0,
                spectrum="E", polarisation=lamp_light,
            )
        ],
    )  # fmt: skip


@pytest.mark.parametrize(
    ("ellipticity_deg", "angle_deg", "passing"),
    [(45.0, 0.0, -1.0), (-45.0, 0.0, 1.0), (0.0, 45.0, 0.0)],
)
def test_the_eye_knows_left_from_right(ellipticity_deg, angle_deg, passing):
    # Light goes along −x, p = d × s = +y. From V, the rhomb makes U = −V: right-handed light
    # vibrates along (s − p)/√2 behind it, left-handed along (s + p)/√2; light at 45° becomes
    # circular, and half of it passes either way.
    light = scenes.Polarisation(
        ellipticity_deg=ellipticity_deg, angle_deg=angle_deg, up=(0.0, 0.0, 1.0)
    )
    seen = []
    for side in (1.0, -1.0):
        scene = looking_through_a_rhomb(light, (0.0, side, 1.0))
        picture = sim.render(scene, sim.RenderSettings(photons=64, passes=4, threads=2))
        seen.append(float(picture.spectral_radiance.mean()))
    # Both end faces let 1 − R through, and of what they send back and forth, twice reflected and
    # retarded anew, R² at the most.
    reflectance = (0.51 / 2.51) ** 2
    assert (seen[0] - seen[1]) / sum(seen) == pytest.approx(passing, abs=2.5 * reflectance**2)
    lit = float(scene.emitters[0].emission().band_flux(ONE_BAND.edges_nm)[0])
    flux = lit / scene.emitters[0].emission().total
    radiance = flux / (math.pi * 0.2 * 0.2) / 10.0
    assert sum(seen) == pytest.approx(radiance * (1.0 - reflectance) ** 2, rel=2.5 * reflectance**2)
