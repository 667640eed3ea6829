"""Irradiance of every lamp on a bare sensor, against closed forms."""

import numpy as np
import pytest

import scenes
import sim

PASSES = 16
SIZE = (1.2, 0.8)
HEIGHT = 0.9
"""Height of the lamps above the sensor's plane [m]."""
PIXELS = (6, 4)
BANDS = 3
FILM = scenes.Film(first_nm=450.0, last_nm=650.0, bands=3)
SPECTRUM = scenes.SpectrumTable(wavelength_nm=(400.0, 700.0), values=(1.0, 2.0))
SHARES = np.array([7.0, 9.0, 11.0]) / 27.0
"""Of the bands: a density of 1 at 400 nm to 2 at 700 nm, over thirds of that."""
PLACE = (0.15, HEIGHT, -0.1)
DOWN = (0.0, -1.0, 0.0)

SENSOR = scenes.IrradianceSensor(
    name="sensor", shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=SIZE), pixels=PIXELS
)


def corners():
    """Edges of the columns along +x and of the rows along z, from the top (−z) down."""
    return np.linspace(-0.5, 0.5, PIXELS[0] + 1) * SIZE[0], np.linspace(
        -0.5, 0.5, PIXELS[1] + 1
    ) * SIZE[1]


def solid_angles():
    """(rows, columns) of the cells seen from PLACE.

    ω(x, z) = atan(x z / (h √(x² + z² + h²))) of the rectangle from below the point to (x, z)
    (Gossman 1956; the integral of h/d³).
    """
    x, z = corners()
    x, z = x[None, :] - PLACE[0], z[:, None] - PLACE[2]
    omega = np.arctan2(x * z, HEIGHT * np.sqrt(x**2 + z**2 + HEIGHT**2))
    return np.diff(np.diff(omega, axis=0), axis=1)


def point_like(whole):
    """Flux on the cells of a lamp that sends 1 W evenly into the solid angle `whole`."""
    return solid_angles() / whole


def even(area):
    """Flux on the cells of 1 W spread evenly over an area."""
    return np.full(PIXELS[::-1], SIZE[0] * SIZE[1] / (PIXELS[0] * PIXELS[1]) / area)


LAMP_SIZE = (0.5, 0.3)


def rectangle_lamp():
    """Flux on the cells of a Lambertian rectangle of 1 W that faces the sensor.

    E = M/(2π) Σ Θᵢ (Γᵢ · n) over the lamp's edges, Θᵢ the angle that an edge is seen under and Γᵢ
    the unit normal of the plane through it and the point (Lambert 1760; Howell, Mengüç & Siegel
    2010, *Thermal Radiation Heat Transfer*, §4-2.4: contour integration); integrated over each cell
    by Gauss–Legendre of 8 × 8 points, to 1e-12.
    """
    x, z = corners()
    nodes, weights = np.polynomial.legendre.leggauss(8)
    spot_x = (x[:-1, None] + 0.5 * np.diff(x)[:, None] * (nodes + 1.0)).ravel()
    spot_z = (z[:-1, None] + 0.5 * np.diff(z)[:, None] * (nodes + 1.0)).ravel()
    points = np.stack(np.broadcast_arrays(spot_x[None, :], 0.0, spot_z[:, None]), axis=-1)
    half_x, half_z = 0.5 * LAMP_SIZE[0], 0.5 * LAMP_SIZE[1]
    ring = [(-half_x, -half_z), (half_x, -half_z), (half_x, half_z), (-half_x, half_z)]
    edge = np.array([(PLACE[0] + a, HEIGHT, PLACE[2] + b) for a, b in ring])
    total = np.zeros(points.shape[:2])
    for start, end in zip(edge, np.roll(edge, -1, axis=0), strict=True):
        one, other = start - points, end - points
        one /= np.linalg.norm(one, axis=-1, keepdims=True)
        other /= np.linalg.norm(other, axis=-1, keepdims=True)
        across = np.cross(one, other)
        sine = np.linalg.norm(across, axis=-1)
        angle = np.arctan2(sine, np.sum(one * other, axis=-1))
        total += angle * across[..., 1] / sine
    irradiance = np.abs(total) / (2.0 * np.pi * LAMP_SIZE[0] * LAMP_SIZE[1])
    shape = (PIXELS[1], 8, PIXELS[0], 8)
    cells = np.einsum("iajb,a,b->ij", irradiance.reshape(shape), weights, weights) / 4.0
    return cells * SIZE[0] * SIZE[1] / (PIXELS[0] * PIXELS[1])


LAMPS = {
    # Intensity Φ/4π, so that a cell gets Φ ω/4π.
    "point": (
        scenes.Point(position=PLACE, flux=1.0, spectrum=SPECTRUM),
        lambda: point_like(4.0 * np.pi),
    ),
    # Φ over 2π (1 − cos θ); the sensor is inside the cone of 60°.
    "spot": (
        scenes.Spot(
            position=PLACE, direction=DOWN, half_angle_deg=60.0, flux=1.0, spectrum=SPECTRUM
        ),
        lambda: point_like(np.pi),
    ),
    # A Lambertian sphere, all of it above the horizon, shines as a point in its centre does.
    "sphere": (
        scenes.SphereLamp(position=PLACE, radius=0.2, flux=1.0, spectrum=SPECTRUM),
        lambda: point_like(4.0 * np.pi),
    ),
    "rectangle": (
        scenes.RectangleLamp(
            position=PLACE, size=LAMP_SIZE, normal=DOWN, up=(0.0, 0.0, -1.0), flux=1.0,
            spectrum=SPECTRUM,
        ),
        rectangle_lamp,
    ),
    # E = Φ/(π R²) inside a beam.
    "round beam": (
        scenes.Beam(
            position=(0.0, HEIGHT, 0.0), direction=DOWN, flux=1.0, spectrum=SPECTRUM,
            profile=scenes.RoundProfile(radius=0.8),
        ),
        lambda: even(np.pi * 0.64),
    ),
    # Tilted by 50° it is spread over 1/cos 50° of its cross-section.
    "tilted slit beam": (
        scenes.Beam(
            position=(np.sin(np.radians(50.0)), np.cos(np.radians(50.0)), 0.0),
            direction=(-np.sin(np.radians(50.0)), -np.cos(np.radians(50.0)), 0.0), flux=1.0,
            spectrum=SPECTRUM, profile=scenes.SlitProfile(width=1.0, height=1.0, up=(0, 0, -1)),
        ),
        lambda: even(1.0 / np.cos(np.radians(50.0))),
    ),
    # Directions even in the cone at each point of the profile: as much comes to a point from all
    # around as goes, as long as the beam reaches 0.9 m · tan 10° further than the sensor.
    "widening beam": (
        scenes.Beam(
            position=(0.0, HEIGHT, 0.0), direction=DOWN, divergence_deg=10.0, flux=1.0,
            spectrum=SPECTRUM, profile=scenes.SlitProfile(width=1.6, height=1.2),
        ),
        lambda: even(1.6 * 1.2),
    ),
}


@pytest.fixture(scope="module", params=list(LAMPS))
def measured(request):
    lamp, closed_form = LAMPS[request.param]
    both = scenes.RaySensor(name="rays", shape=SENSOR.shape)
    scene = scenes.Scene(sensors=(SENSOR, both), emitters=(lamp,), film=FILM)
    settings = sim.RenderSettings(photons=50_000, passes=PASSES)
    return sim.measure(scene, settings), closed_form()


def assert_within(off, error, expected, *, power):
    """Off by no more than its standard errors say, and these small enough to tell.

    With 16 replicates (Student's t) z² has mean 15/13, so that √(mean z²) is about 1.07, and |z| is
    beyond 6 once in 4·10⁴.
    """
    z = off / error
    assert np.abs(z).max() < 6.0
    assert np.sqrt(np.mean(z**2)) < 1.4
    assert np.all(error < power * expected)


def test_cells_get_their_flux(measured):
    reading, expected = measured[0].sensors["sensor"], measured[1]
    areas = np.full(PIXELS[::-1], SIZE[0] * SIZE[1] / (PIXELS[0] * PIXELS[1]))
    np.testing.assert_allclose(reading.areas, areas, rtol=1e-12)
    irradiance = expected / areas
    assert_within(
        reading.irradiance - irradiance, reading.irradiance_error, irradiance, power=0.01
    )


def test_bands_get_theirs(measured):
    reading, expected = measured[0].sensors["sensor"], measured[1]
    spectral = expected[..., None] * SHARES / 100.0 / reading.areas[..., None]
    assert_within(
        reading.spectral_irradiance - spectral, reading.standard_error, spectral, power=0.02
    )
    # Means over bands of 100 nm.
    total = reading.spectral_irradiance.sum(axis=2) * 100.0
    np.testing.assert_allclose(total, reading.irradiance, rtol=1e-12)


def test_the_whole_gets_it_all(measured):
    reading, rays = measured[0].sensors["sensor"], measured[0].sensors["rays"]
    expected = measured[1].sum()
    assert abs(reading.flux - expected) < 6.0 * reading.flux_error + 1e-12
    assert reading.flux_error < 1e-3 * expected
    assert rays.total_flux == pytest.approx(reading.flux, rel=1e-12)
    assert rays.total_flux_error == pytest.approx(reading.flux_error, rel=1e-6, abs=1e-15)
    # The same photons.
    assert rays.flux.sum() == pytest.approx(reading.flux, rel=1e-12)
    assert measured[0].energy.escaped == pytest.approx(measured[0].energy.emitted, rel=1e-12)
