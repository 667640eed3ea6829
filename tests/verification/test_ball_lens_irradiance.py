"""The profile that a ball lens throws on a sensor, folds and all, against the closed form.

A ray of a parallel beam at the height h above the axis of a ball of radius R and index n enters at
sin θ = h/R, is refracted to sin θ' = h/(n R), and after k internal reflections leaves at the polar
angle φ = π − θ − (k + 1)(π − 2θ') from the axis, in a direction ψ = −2(θ − θ') − k(π − 2θ') to it
(Born & Wolf 1999, §4.1: Snell's law at either face; equal angles at the ends of a chord). A screen
at the distance z behind the centre it meets at

    y(h) = R sin φ + (z − R cos φ) tan ψ,  ρ = |y|

and brings E/E₀ = Σ T h/(ρ |dρ/dh|), summed over all rays that come to ρ, with the transmittance
T = (1 − r)² rᵏ. Each branch's part of a ring is then ∫ 2πρ E dρ = E₀ ∫ 2πh T dh between the heights
that come to its edges, which stays finite where dρ/dh = 0: at the folds.
"""

import functools

import numpy as np
import pytest

import scenes
import sim
from sim import analytic
from sim.sensors.cells import cell_areas

PASSES = 16
PHOTONS = 60_000
RADIUS = 0.01
ETA = 1.5
BEAM = 0.75 * RADIUS
WAVELENGTH_NM = 550.0
ORDERS = range(6)
"""Internal reflections: 6 of them leave r⁶ < 1e-7. What the front reflects goes wide."""

SCREENS = {"caustic": 1.25 * RADIUS, "far": 4.0 * RADIUS}
"""Behind the centre. The paraxial focus is at n R/(2 (n − 1)) = 1.5 R and the margin's rays cross
sooner: on the first screen the profile has folds, on the second the order is turned over."""

HALF = {"caustic": 0.07 * RADIUS, "far": 1.3 * RADIUS}
"""Half the sensors' widths; what reflects twice or more inside goes wider, and is not all seen."""

HEIGHTS = np.linspace(0.0, BEAM, 400_001)


def trace(heights, order, z):
    """y on the screen and the transmittance, of rays at given heights; NaN if they miss it."""
    theta = np.arcsin(heights / RADIUS)
    inside = np.arcsin(heights / (ETA * RADIUS))
    phi = np.pi - theta - (order + 1) * (np.pi - 2.0 * inside)
    psi = -2.0 * (theta - inside) - order * (np.pi - 2.0 * inside)
    y = RADIUS * np.sin(phi) + (z - RADIUS * np.cos(phi)) * np.tan(psi)
    # A ball's normals lie in one plane of incidence with the ray: s stays s, and p stays p.
    r = np.array(analytic.fresnel_reflectance(np.cos(theta), 1.0, ETA))
    forward = (np.cos(psi) > 0.0) & (RADIUS * np.cos(phi) < z)
    return np.where(forward, y, np.nan), np.mean((1.0 - r) ** 2 * r**order, axis=0)


@functools.cache
def trace_beam(order, z):
    """The same of HEIGHTS."""
    return trace(HEIGHTS, order, z)


def ring_flux(edges, z, orders=ORDERS):
    """Flux on rings, of E₀ = 1: ∫ 2πh T dh over the heights that come to each."""
    flux = np.zeros(len(edges) - 1)
    for order in orders:
        y, transmitted = trace_beam(order, z)
        # A ring has hundreds of the heights, and may be off by the one that lies on its edge.
        middle = 0.5 * (HEIGHTS[1:] + HEIGHTS[:-1])
        share = 2.0 * np.pi * middle * np.diff(HEIGHTS) * 0.5 * (transmitted[1:] + transmitted[:-1])
        rho = 0.5 * np.abs(y[1:] + y[:-1])
        seen = np.isfinite(rho)
        flux += np.histogram(rho[seen], edges, weights=share[seen])[0]
    return flux


def irradiance(rho, z):
    """E/E₀ = Σ T h/(ρ |dρ/dh|) at one place, over all heights whose rays come there."""
    total = 0.0
    for order in ORDERS:
        y, _ = trace_beam(order, z)
        for sign in (1.0, -1.0):
            off = sign * y - rho
            for k in np.flatnonzero(off[1:] * off[:-1] <= 0.0):
                part = off[k] / (off[k] - off[k + 1])
                h = HEIGHTS[k] + part * (HEIGHTS[k + 1] - HEIGHTS[k])
                step = 1e-6 * RADIUS
                near, transmitted = trace(np.array([h - step, h, h + step]), order, z)
                slope = abs(near[2] - near[0]) / (2.0 * step)
                total += transmitted[1] * h / (rho * slope)
    return total


def make_scene():
    """A ball in a parallel beam along +x, and on each screen one sensor of each kind."""
    ball = scenes.SceneObject(
        name="ball",
        shape=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=RADIUS),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA)),
    )
    lamp = scenes.Beam(
        position=(-3.0 * RADIUS, 0.0, 0.0), direction=(1.0, 0.0, 0.0), flux=1.0,
        profile=scenes.RoundProfile(radius=BEAM),
        spectrum=scenes.Laser(wavelength_nm=WAVELENGTH_NM),
    )
    sensors = []
    for name, z in SCREENS.items():
        half = HALF[name]
        place = {"position": (z, 0.0, 0.0), "normal": (-1.0, 0.0, 0.0)}
        square = scenes.Rectangle(**place, size=(2.0 * half, 2.0 * half))
        disk = scenes.Disk(**place, radius=half)
        sensors += [
            scenes.IrradianceSensor(name=f"{name} cells", shape=square, pixels=(16, 16), bands=1),
            scenes.RaySensor(name=f"{name} rays", shape=disk, max_rays=1 << 22),
        ]
    film = scenes.Film(first_nm=500.0, last_nm=600.0, bands=2)
    return scenes.Scene(objects=(ball,), emitters=(lamp,), sensors=tuple(sensors), film=film)


@pytest.fixture(scope="module")
def measurement():
    settings = sim.RenderSettings(photons=PHOTONS, passes=PASSES)
    return sim.measure(make_scene(), settings)


E0 = 1.0 / (np.pi * BEAM**2)


def rings_of(reading, edges):
    """Flux on rings in each pass, (passes, rings)."""
    rho = np.hypot(*reading.place.T)
    passes = np.arange(reading.passes + 1) - 0.5
    return np.histogram2d(
        reading.pass_index, rho, bins=(passes, edges), weights=reading.flux * reading.passes
    )[0]


def test_the_first_screen_has_a_fold():
    y, _ = trace_beam(0, SCREENS["caustic"])
    turns = np.flatnonzero(np.diff(np.sign(np.diff(y))))
    assert len(turns) == 1
    assert 0.0 < abs(y[turns[0]]) < HALF["caustic"]


@pytest.mark.parametrize("name", list(SCREENS))
def test_the_closed_form_is_the_density_of_its_rings(name):
    z, half = SCREENS[name], HALF[name]
    rho = np.array([0.13, 0.31, 0.47, 0.7]) * half
    width = 1e-2 * half
    for one in rho:
        edges = np.array([one - 0.5 * width, one + 0.5 * width])
        area = np.pi * (edges[1] ** 2 - edges[0] ** 2)
        # Off by E″w²/24 < 1e-3 E, and by the heights on the ring's edges, 1 of some thousands.
        assert ring_flux(edges, z)[0] / area == pytest.approx(irradiance(one, z), rel=2e-3)


@pytest.mark.parametrize("name", list(SCREENS))
def test_rings_of_rays(measurement, assert_mean, name):
    reading = measurement.sensors[f"{name} rays"]
    assert (reading.kept, reading.media) == (1.0, ("reference",))
    edges = np.linspace(0.0, HALF[name], 41)
    expected = E0 * ring_flux(edges, SCREENS[name])
    found = rings_of(reading, edges)
    error = found.std(axis=0, ddof=1) / np.sqrt(PASSES)
    assert np.median(error / expected) < 0.01
    assert_mean(found, expected, k=6.0, slack=2e-5 * expected.max())


def areas_within(half, radius):
    """(16, 16) area of each of the square's cells within a circle about its centre."""
    if radius == 0.0:
        return np.zeros((16, 16))
    return cell_areas(np.full(2, half), (16, 16), radius=radius)


@pytest.mark.parametrize("name", list(SCREENS))
def test_cells(measurement, name):
    # A ring's flux is spread evenly around it: a cell gets the part of the ring that lies in it.
    reading, half = measurement.sensors[f"{name} cells"], HALF[name]
    edges = np.linspace(0.0, np.sqrt(2.0) * half, 1201)
    flux = E0 * ring_flux(edges, SCREENS[name])
    inside = np.stack([areas_within(half, edge) for edge in edges])
    rings = np.pi * np.diff(edges**2)
    expected = np.tensordot(flux / rings, np.diff(inside, axis=0), axes=1) / reading.areas
    off, error = reading.irradiance - expected, reading.irradiance_error
    assert np.median(error / expected) < 0.02
    # Rings are 1/85 of a cell's diagonal wide: what E varies over one moves 0.1% between cells.
    assert np.all(np.abs(off) < 6.0 * error + 2e-3 * expected.max())
    assert abs(reading.flux - np.sum(expected * reading.areas)) < 6.0 * reading.flux_error
