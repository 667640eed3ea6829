"""A lens focuses each band where the lensmaker's equation puts it."""

import numpy as np
import pytest

import scenes
from sim.analytic import lensmaker_back_focal_length, lensmaker_focal_length
from spectra import glass

RADIUS, THICKNESS = 0.1, 0.004
BEAM = 0.0005
"""Radius of the beam: a two-hundredth of the focal length."""
SCREEN = 0.05
"""Distance of the screen behind the lens, half way to the focus."""


@pytest.fixture(scope="module", params=["on a rectangle", "on a disk"])
def bench(request):
    """A narrow beam along x through a biconvex lens onto a screen."""
    lens = scenes.SceneObject(
        name="lens",
        shape=scenes.Lens(
            position=(0.0, 0.0, 0.0), axis=(1.0, 0.0, 0.0), thickness=THICKNESS, aperture=0.02,
            first=scenes.LensSurface(radius=RADIUS), second=scenes.LensSurface(radius=-RADIUS),
        ),
        material=scenes.Dielectric(medium="N-BK7"),
    )
    place = {"position": (0.5 * THICKNESS + SCREEN, 0.0, 0.0), "normal": (-1.0, 0.0, 0.0)}
    shape = (
        scenes.Rectangle(**place, size=(0.05, 0.05))
        if request.param == "on a rectangle"
        else scenes.Disk(**place, radius=0.025)
    )
    screen = scenes.SceneObject(
        name="screen", shape=shape, material=scenes.Lambertian(reflectance=0.5)
    )
    beam = scenes.Beam(
        position=(-0.02, 0.0, 0.0), direction=(1.0, 0.0, 0.0), flux=1.0, spectrum="D65",
        profile=scenes.RoundProfile(radius=BEAM),
    )
    return scenes.Scene(objects=(lens, screen), emitters=(beam,))


def sums_of_bands(photons, edges_nm):
    """Of each band: Σ Φ x·s and Σ Φ s², x the place on the screen and s the slope there.

    A plane at a distance z behind the screen has the spot x + z s, of mean square
    ⟨x²⟩ + 2 z ⟨x·s⟩ + z² ⟨s²⟩ about the axis: least at z = −⟨x·s⟩/⟨s²⟩.
    """
    kept = (photons["object"] == 1) & (photons["refractions"] == 2) & (photons["reflections"] == 0)
    place, direction = photons["position"][kept, 1:], photons["direction"][kept].astype(float)
    slope, flux = direction[:, 1:] / direction[:, :1], photons["flux"][kept]
    bins = photons["wavelength_nm"][kept], edges_nm
    products = flux * np.sum(place * slope, axis=1), flux * np.sum(slope * slope, axis=1)
    return [np.histogram(*bins, weights=product)[0] for product in products]


def test_the_least_spot_follows_the_chromatic_shift_of_focus(bench, trace_passes):
    passes = trace_passes(bench, photons=20_000, passes=16)
    edges_nm = bench.film.edges_nm
    sums = passes.sums(lambda photons: sums_of_bands(photons, edges_nm))
    xs, ss = sums.sum(axis=0)
    focus = SCREEN - xs / ss
    residual = sums[:, 0] + sums[:, 1] * (focus - SCREEN)
    error = residual.std(axis=0, ddof=1) * 4.0 / ss
    # What it should be: f_b of each wavelength (Hecht 2017, eq. 6.4), weighted as above by
    # s² = h²/f² and by the lamp's spectrum; the transmittance is constant over a band to 1e-4.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half, middle = 0.5 * np.diff(edges_nm)[:, None], 0.5 * (edges_nm[1:] + edges_nm[:-1])[:, None]
    wavelength_nm = middle + half * nodes
    eta = glass("N-BK7").eta(wavelength_nm)
    back = lensmaker_back_focal_length(eta, RADIUS, -RADIUS, THICKNESS)
    f = lensmaker_focal_length(eta, RADIUS, -RADIUS, THICKNESS)
    light = bench.emitters[0].emission().density_at(wavelength_nm) * weights / f**2
    expected = (light * back).sum(axis=1) / light.sum(axis=1)
    # Spherical aberration: a ray at height h is focused short by h² K/f, and a thin equiconvex
    # lens has K = [(3n + 2)(n − 1) + n³/(n − 1)] / (8 n (n − 1)) for light from infinity (Jenkins &
    # White 1976, Fundamentals of Optics, §9.5); the least spot by ⟨h⁴⟩/⟨h²⟩ = 2/3 of the margin's.
    # That is 2.7 µm of 96 mm; the lens is not quite thin.
    n, rest = eta.mean(axis=1), eta.mean(axis=1) - 1.0
    k = ((3.0 * n + 2.0) * rest + n**3 / rest) / (8.0 * n * rest)
    aberration = 2.0 / 3.0 * k * BEAM**2 / f.mean(axis=1)
    np.testing.assert_array_less(
        np.abs(focus - (expected - aberration)), 4.0 * error + 0.1 * aberration
    )
    # The shift over the spectrum is 3.5 mm, from one band to the next 40 µm at least.
    assert np.all(np.diff(focus) > 0.0)
    assert focus[-1] - focus[0] == pytest.approx(expected[-1] - expected[0], rel=1e-3)
    assert 3e-3 < focus[-1] - focus[0] < 4e-3
    assert error.max() < 0.05 * np.diff(focus).min()
