"""Far fields and spot diagrams of kept rays, against closed forms."""

import numpy as np
import pytest

import scenes
import sim

PASSES = 16
UP = (0.0, 1.0, 0.0)
DOWN = (0.0, -1.0, 0.0)
SPECTRUM = scenes.SpectrumTable(wavelength_nm=(500.0, 600.0), values=(1.0, 1.0))
FILM = scenes.Film(first_nm=525.0, last_nm=575.0, bands=2)
HALF_ANGLE_DEG = 20.0
EDGES = np.radians(np.linspace(0.0, 60.0, 13))


def measure(lamp, distance, *, radius=1.0, max_rays=1 << 20):
    """Rays of a lamp at the origin, looking down, on a disk below it."""
    shape = scenes.Disk(position=(0.0, -distance, 0.0), normal=UP, radius=radius)
    sensor = scenes.RaySensor(name="rays", shape=shape, max_rays=max_rays)
    scene = scenes.Scene(sensors=(sensor,), emitters=(lamp,), film=FILM)
    return sim.measure(scene, sim.RenderSettings(photons=20_000, passes=PASSES)).sensors["rays"]


def spot():
    return scenes.Spot(
        position=(0.0, 0.0, 0.0), direction=DOWN, half_angle_deg=HALF_ANGLE_DEG, flux=3.0,
        spectrum=SPECTRUM,
    )


def lambertian():
    return scenes.RectangleLamp(
        position=(0.0, 0.0, 0.0), size=(0.01, 0.02), normal=DOWN, flux=3.0, spectrum=SPECTRUM,
        up=(1.0, 0.0, 0.0),
    )


def even_cone():
    """I = Φ/(2π (1 − cos θ)) inside the cone."""
    inside = EDGES[1:] <= np.radians(HALF_ANGLE_DEG) * (1.0 + 1e-12)
    return np.where(inside, 3.0 / (2.0 * np.pi * (1.0 - np.cos(np.radians(HALF_ANGLE_DEG)))), 0.0)


def cosine():
    """I = Φ cos θ/π, on the mean over a ring Φ (sin² θ₁ − sin² θ₀)/(2π (cos θ₀ − cos θ₁))."""
    return -3.0 * np.diff(np.sin(EDGES) ** 2) / (2.0 * np.pi * np.diff(np.cos(EDGES)))


FAR_FIELDS = {"cone": (spot, 0.5, even_cone), "lambertian": (lambertian, 0.4, cosine)}


@pytest.mark.parametrize("max_rays", [1 << 20, 5000])
@pytest.mark.parametrize("name", list(FAR_FIELDS))
def test_far_fields(name, max_rays):
    lamp, distance, closed_form = FAR_FIELDS[name]
    reading = measure(lamp(), distance, max_rays=max_rays)
    assert 0 < len(reading) <= max_rays
    assert (reading.kept == 1.0) == (max_rays > reading.crossings)
    expected = closed_form()
    found = reading.far_field(EDGES)
    # Student's t of 16 replicates is beyond 6 once in 4·10⁴.
    assert np.all(np.abs(found.intensity - expected) <= 6.0 * found.standard_error + 1e-9)
    lit = expected > 0.0
    assert np.all(found.intensity[~lit] == 0.0)
    power = 0.02 if reading.kept == 1.0 else 0.3
    assert np.all(found.standard_error[lit] < power * expected[lit])
    # Thinning costs the sum of the rays' fluxes some noise, and the sensor's own nothing.
    assert reading.total_flux_error < 1e-3 * reading.total_flux
    thinned = 0.0 if reading.kept == 1.0 else 5.0 / np.sqrt(len(reading))
    assert reading.flux.sum() == pytest.approx(reading.total_flux, rel=1e-12 + thinned)


def test_the_spot_of_a_cone_is_that_of_even_directions():
    # ρ = h tan θ with u = cos θ even between c and 1: the mean of tan² θ is ∫ (1/u² − 1) du/(1 − c)
    # = (1/c − 2 + c)/(1 − c) = (1 − c)/c.
    reading = measure(spot(), 0.5)
    c = np.cos(np.radians(HALF_ANGLE_DEG))
    expected = 0.5 * np.sqrt((1.0 - c) / c)
    found = reading.spot()
    each = [reading.spot(reading.pass_index == k).rms_radius for k in range(PASSES)]
    error = np.std(each, ddof=1) / np.sqrt(PASSES)
    assert abs(found.rms_radius - expected) < 6.0 * error + 1e-9
    assert error < 1e-3 * expected
    np.testing.assert_allclose(found.centre, 0.0, atol=1e-3 * expected)


def test_the_spot_of_a_beam_is_its_profile():
    reading = measure(
        scenes.Beam(
            position=(0.0, 0.0, 0.0), direction=DOWN, flux=3.0, spectrum=SPECTRUM,
            profile=scenes.RoundProfile(radius=0.1),
        ),
        0.5,
    )
    # An even disk of radius r has a root mean square radius of r/√2.
    assert reading.spot().rms_radius == pytest.approx(0.1 / np.sqrt(2.0), rel=2e-4)
    assert np.isnan(reading.spot(reading.flux < 0.0).rms_radius)
    np.testing.assert_allclose(reading.cosines[:, 2], -1.0, rtol=1e-12)
