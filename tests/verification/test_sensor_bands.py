"""Bands of a sensor: light that met nothing dispersive is spread over them as its lamp shines."""

import numpy as np
import pytest

import scenes
import sim

FILM = scenes.Film(first_nm=420.0, last_nm=680.0, bands=14)
PIXELS = (6, 6)
PASSES = 8
PHOTONS = 20_000
LAMP = {"position": (0.0, 1.0, 0.0), "spectrum": "A", "flux": 4.0}
GREEN = {"position": (0.3, 0.8, 0.2), "spectrum": "mercury", "flux": 1.0}


def measure(*things, lamps, film=FILM, ambient="reference", passes=PASSES, **fields):
    """A sensor of bins, and one that keeps the rays, in one place above the things."""
    place = scenes.Rectangle(position=(0.0, 0.001, 0.0), size=(0.6, 0.6))
    scene = scenes.Scene(
        objects=tuple(scenes.SceneObject(shape=shape, material=made) for shape, made in things),
        emitters=lamps, film=film, ambient=ambient,
        sensors=(
            scenes.IrradianceSensor(name="bins", shape=place, pixels=PIXELS, **fields),
            scenes.RaySensor(name="rays", shape=place),
        ),
    )  # fmt: skip
    return sim.measure(scene, sim.RenderSettings(photons=PHOTONS, passes=passes, seed=5))


def band_shares(reading):
    """(rows, columns, bands) part of a cell's flux in each band."""
    flux = reading.spectral_irradiance * np.diff(reading.edges_nm)
    return flux / flux.sum(axis=2, keepdims=True)


def lamp_shares(lamp, edges_nm):
    flux = lamp.emission().band_flux(edges_nm)
    return flux / flux.sum()


@pytest.mark.parametrize("bands", [None, 5])
def test_direct_light_has_its_lamps_spectrum_in_every_cell(bands):
    lamp = scenes.Point(**LAMP)
    reading = measure(lamps=(lamp,), passes=2, bands=bands).sensors["bins"]
    expected = lamp_shares(lamp, reading.edges_nm)
    assert len(expected) == (bands or FILM.bands)
    # No noise at all: a product of two numbers, and their sum.
    np.testing.assert_allclose(
        band_shares(reading), np.broadcast_to(expected, (*PIXELS, len(expected))), rtol=1e-12
    )


@pytest.fixture(scope="module")
def behind_a_pane():
    """Two lamps, and a pane of dispersive glass that some of their light goes through."""
    pane = scenes.Box(position=(0.12, 0.3, 0.0), size=(0.3, 0.1, 0.7))
    return measure(
        (pane, scenes.Dielectric(medium="SF11")),
        lamps=(scenes.Point(**LAMP), scenes.Point(**GREEN)),
    )


def own_bins(reading, rays):
    """Means over passes and their errors, of rays binned by their own wavelengths [W]."""
    flux = np.zeros((PASSES, *PIXELS, FILM.bands))
    column = np.clip(np.searchsorted(reading.x, rays.position[:, 0]) - 1, 0, PIXELS[0] - 1)
    row = np.clip(np.searchsorted(-reading.y, rays.position[:, 2]) - 1, 0, PIXELS[1] - 1)
    band = np.searchsorted(reading.edges_nm, rays.wavelength_nm) - 1
    place = rays.pass_index, row, column, np.clip(band, 0, FILM.bands - 1)
    np.add.at(flux, place, rays.flux * PASSES)
    return flux.mean(axis=0), flux.std(axis=0, ddof=1) / np.sqrt(PASSES)


def test_it_is_the_expectation_of_bins_by_wavelength(behind_a_pane):
    reading, rays = behind_a_pane.sensors["bins"], behind_a_pane.sensors["rays"]
    mean, error = own_bins(reading, rays)
    width = np.diff(reading.edges_nm) * reading.areas[..., None]
    spread, spread_error = reading.spectral_irradiance * width, reading.standard_error * width
    # All bands together nothing changes: the same photons in the same cells.
    np.testing.assert_allclose(spread.sum(axis=2), mean.sum(axis=2), rtol=1e-9)
    # Band by band: 504 differences in units of their errors, known from 8 passes (Student's t of 7
    # degrees of freedom passes 8.5 once in 10⁵). Without bias their mean is 0 to 1/√504 at most.
    allowed = 8.5 * np.hypot(error, spread_error)
    assert np.all(np.abs(spread - mean) <= allowed)
    total, total_error = mean.sum(axis=(0, 1)), np.sqrt(np.sum(error**2, axis=(0, 1)))
    assert np.all(np.abs(spread.sum(axis=(0, 1)) - total) <= 5.0 * total_error)
    assert rays.dispersed.any()
    assert not rays.dispersed.all()


def test_and_it_is_less_noisy(behind_a_pane):
    # Beside the pane, left of x = −0.1, light is direct but for what the pane reflects.
    reading, rays = behind_a_pane.sensors["bins"], behind_a_pane.sensors["rays"]
    _, error = own_bins(reading, rays)
    width = np.diff(reading.edges_nm) * reading.areas[..., None]
    ratio = error / (reading.standard_error * width)
    print(f"beside {np.median(ratio[:, :2]):.1f}, in all {np.median(ratio):.1f}")
    assert np.median(ratio[:, :2]) > 3.0
    assert np.median(ratio) > 1.0


def test_light_in_a_tinted_medium_is_not_spread():
    # E of a point over a plane is Φ h/(4π d³), times exp(−α(λ) d) in a medium whose index is the
    # same at every wavelength: nothing but its colour tells one band from another.
    table = scenes.CoefficientTable(wavelength_nm=(400.0, 560.0, 570.0, 720.0), values=(0, 0, 3, 3))
    medium = scenes.ConstantMedium(
        eta=1.3, absorption=scenes.NapierianAbsorption(coefficient=table)
    )
    lamp = scenes.Point(position=(0.0, 1.0, 0.0), spectrum="E", flux=1.0)
    reading = measure(lamps=(lamp,), ambient=medium).sensors["bins"]
    x, z = np.meshgrid(np.linspace(-0.3, 0.3, 601), np.linspace(-0.3, 0.3, 601))
    d = np.sqrt(x**2 + z**2 + 0.999**2)
    red = reading.wavelengths_nm > 580.0
    blue = reading.wavelengths_nm < 550.0
    flux = reading.spectral_irradiance.mean(axis=(0, 1))
    ratio = flux[red].mean() / flux[blue].mean()
    expected = np.mean(np.exp(-3.0 * d) / d**3) / np.mean(1.0 / d**3)
    # 9,000 of 160,000 photons cross, half of them in each part: 1.5 % each at random.
    assert ratio == pytest.approx(expected, rel=5 * 0.021)
