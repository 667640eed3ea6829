"""Lamps on the device: their wavelengths, and how photons are shared among them."""

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.photons.lamps import compile_lamps
from sim.scene_data import compile_scene
from spectra import spectrum

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0)),
    material=scenes.Lambertian(reflectance=0.5),
)
STONE = scenes.SceneObject(
    name="stone",
    shape=scenes.Box(position=(3.0, 0.0, 0.0), size=(0.5, 0.5, 0.5)),
    material=scenes.Absorber(),
)


def shine(*specs, **film):
    """A floor under one beam for each spectrum."""
    beams = tuple(
        scenes.Beam(
            position=(0.0, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=2.0 + row, spectrum=spec,
            profile=scenes.RoundProfile(radius=0.5),
        )
        for row, spec in enumerate(specs)
    )
    return scenes.Scene(objects=(FLOOR, STONE), emitters=beams, film=scenes.Film(**film))


SAWTOOTH = scenes.SpectrumTable(
    wavelength_nm=(380.0, 430.0, 500.0, 501.0, 600.0, 680.0), values=(0.0, 2.0, 0.5, 5.0, 0.0, 0.0)
)


@pytest.mark.parametrize(
    "spec",
    ["E", "D65", "A", "FL2", SAWTOOTH, scenes.Laser(wavelength_nm=532.0, width_nm=20.0)],
    ids=str,
)
def test_wavelengths_are_distributed_as_the_spectrum(trace_passes, assert_mean, spec):
    scene = shine(spec)
    passes = trace_passes(scene, photons=10_000, passes=16)
    edges_nm = scene.film.edges_nm
    flux = passes.sums(
        lambda p: np.histogram(p["wavelength_nm"], edges_nm, weights=p["flux"])[0]
    )
    # Φ_b = Φ ∫_b s dλ / ∫ s dλ, exactly for the linear interpolant. Wavelengths are stored in
    # single precision, 3e-5 nm of a band's 10.
    emission = scene.emitters[0].emission()
    expected = 2.0 * emission.band_flux(edges_nm) / emission.total
    assert_mean(flux, expected, slack=1e-5 * expected.max())
    assert passes.flux == pytest.approx(expected.sum(), rel=1e-12)
    assert np.all(flux.std(axis=0) < 2e-3 * expected.sum())


@pytest.mark.parametrize("name", ["sodium", "mercury", "helium-neon"])
def test_lines_stay_lines(trace_passes, assert_mean, name):
    passes = trace_passes(shine(name), photons=10_000, passes=16)
    lines = spectrum(name)
    inside = (lines.line_wavelength_nm >= 395.0) & (lines.line_wavelength_nm <= 705.0)
    lines_nm = lines.line_wavelength_nm[inside].astype(np.float32)
    for photons in passes.photons:
        assert set(photons["wavelength_nm"]) <= set(lines_nm)
    flux = passes.sums(
        lambda p: [p["flux"][p["wavelength_nm"] == line].sum() for line in lines_nm]
    )
    assert_mean(flux, 2.0 * lines.line_flux[inside] / lines.total)


def test_a_laser_without_width_has_one_wavelength(trace_passes):
    passes = trace_passes(shine(scenes.Laser(wavelength_nm=532.1)), photons=1000)
    assert set(passes.photons[0]["wavelength_nm"]) == {np.float32(532.1)}


def test_every_lamp_shines_by_itself(trace_passes):
    # The second one is dark inside the film's range, and drops out: rows count those that shine.
    infrared = scenes.Laser(wavelength_nm=1064.0)
    green, red = scenes.Laser(wavelength_nm=532.0), scenes.Laser(wavelength_nm=633.0)
    passes = trace_passes(shine(green, infrared, red), photons=1000)
    photons = passes.photons[0]
    assert passes.flux == pytest.approx(2.0 + 4.0, rel=1e-12)
    for row, (line, flux) in enumerate(((532.0, 2.0), (633.0, 4.0))):
        mine = photons["emitter"] == row
        assert set(photons["wavelength_nm"][mine]) == {np.float32(line)}
        assert photons["flux"][mine].sum() == pytest.approx(flux, rel=1e-12)


@pytest.mark.parametrize("photons", [1, 2, 3, 10, 1000, 12_345])
def test_streams_add_up_to_the_pass(photons):
    compiled = compile_scene(shine("E", "sodium", "D65"), device=start_device("cpu"))
    lamps = compile_lamps(compiled, compiled.scene.film.edges_nm, photons)
    assert sum(stream.photons for stream in lamps.streams) == max(photons, 3)
    assert min(stream.photons for stream in lamps.streams) >= 1


@pytest.mark.parametrize("photons", [1, 2, 5, 40])
def test_a_handful_of_photons_carries_all_of_the_light_too(trace_passes, assert_mean, photons):
    # Two lamps, and three ways to aim each: a lamp or an aim that got none of so few photons
    # would be missing.
    lamps = (
        scenes.Point(position=(0.0, 1.0, 0.0), flux=1.0, spectrum="E"),
        scenes.SphereLamp(position=(0.5, 0.8, 0.0), radius=0.1, flux=2.0, spectrum="E"),
    )
    ball = STONE.model_copy(update={"name": "ball", "material": FLOOR.material})
    passes = trace_passes(
        scenes.Scene(objects=(FLOOR, ball), emitters=lamps), photons=photons, passes=400
    )
    assert_mean([books.emitted for books in passes.books], passes.flux)
