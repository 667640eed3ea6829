"""The spectrum on the gallery prism's screen lies where Snell's law puts it, band by band."""

import numpy as np
import pytest

import scenes
from sim.analytic import fresnel_reflectance
from spectra import glass

PASSES = 32
PHOTONS = 20_000
NODES = 8
"""Wavelengths a band over which the reference is integrated, by Gauss and Legendre."""


@pytest.fixture(scope="module")
def bench():
    """The gallery's prism and its screen, lit by the slit alone."""
    scene = scenes.load("prism")
    slit = [lamp for lamp in scene.emitters if lamp.name == "slit"]
    return scene.model_copy(update={"emitters": tuple(slit)})


@pytest.fixture(scope="module")
def spectrum(bench, trace_passes):
    """What each pass put on the screen straight through the prism: (band flux, band moments)."""
    names = [one.name for one in bench.objects]
    screen = bench.objects[names.index("screen")].shape
    along, _, normal = screen.frame()
    passes = trace_passes(bench, photons=PHOTONS, passes=PASSES)

    def weigh(photons):
        kept = photons["object"] == names.index("screen")
        kept &= (photons["refractions"] == 2) & (photons["reflections"] == 0)
        offset = photons["position"][kept] - screen.position
        np.testing.assert_allclose(offset @ normal, 0.0, atol=1e-14)
        place, flux = offset @ along, photons["flux"][kept]
        bins = photons["wavelength_nm"][kept], bench.film.edges_nm
        return [np.histogram(*bins, weights=w)[0] for w in (flux, flux * place)]

    return passes.sums(weigh)


def cross(direction, normal, eta_i, eta_t):
    """Refracted direction and transmittance of s and p light, (2, ...), all in arrays.

    With c = −n·d Snell's law reads, of unit vectors,
    t = η d + (η c − √(1 − η²(1 − c²))) n, η = η_i/η_t (Born & Wolf 1999, §1.5.1).
    """
    eta = (eta_i / eta_t)[..., None]
    c = -(direction @ normal)[..., None]
    root = np.sqrt(1.0 - eta**2 * (1.0 - c**2))
    transmittance = 1.0 - np.stack(fresnel_reflectance(c[..., 0], eta_i, eta_t))
    return eta * direction + (eta * c - root) * normal, transmittance


def expected_centroids(bench):
    """Centroid of each band along the screen [m], and its share of the light.

    A bundle of parallel rays of one colour stays parallel, and its middle follows the middle ray;
    so the slit counts by its centre, and there remain the integrals over the band, with the
    lamp's spectrum, and over the cone of directions. Both planes of incidence are one, but for the
    cone's half angle, 0.1°, whose square they mix s and p by.
    """
    shapes = {one.name: one.shape for one in bench.objects}
    prism, screen, slit = shapes["prism"], shapes["screen"], bench.emitters[0]
    edges_nm = bench.film.edges_nm
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    half, middle = 0.5 * np.diff(edges_nm)[:, None], 0.5 * (edges_nm[1:] + edges_nm[:-1])[:, None]
    wavelength_nm = middle + half * nodes
    light = slit.emission().density_at(wavelength_nm) * half * weights
    # Evenly over a narrow cone of half angle α: ⟨x²⟩ = α²/4 along either axis, which four
    # directions at α/√2 about the axis have too.
    u, v, axis = slit.frame()
    tilt = np.sin(np.radians(slit.divergence_deg)) / np.sqrt(2.0)
    total, moment = np.zeros(len(edges_nm) - 1), np.zeros(len(edges_nm) - 1)
    normals, offsets = prism.faces()
    for turn in np.arange(4) * 0.5 * np.pi:
        way = axis + tilt * (np.cos(turn) * u + np.sin(turn) * v)
        direction = np.broadcast_to(way / np.linalg.norm(way), (*wavelength_nm.shape, 3))
        point = np.broadcast_to(np.array(slit.position), direction.shape)
        eta = glass("SF11").eta(wavelength_nm)
        # Of the faces (base, right, left, ends) the light enters the one turned against it, and
        # leaves by the other at the apex.
        into = 1 + int(np.argmin(normals[1:3] @ axis))
        out = 3 - into
        halves = 0.5 * np.stack([light, light])  # s and p
        for face, eta_i, eta_t in ((into, 1.0, eta), (out, eta, 1.0)):
            normal = normals[face]
            against = normal if face == into else -normal
            t = (offsets[face] - (point - prism.position) @ normal) / (direction @ normal)
            point = point + t[..., None] * direction
            direction, transmittance = cross(
                direction, against, *np.broadcast_arrays(eta_i, eta_t)
            )
            halves = halves * transmittance
        flux = halves.sum(axis=0)
        t = (screen.position - point) @ screen.normal / (direction @ screen.normal)
        place = (point + t[..., None] * direction - screen.position) @ screen.frame()[0]
        total += flux.sum(axis=1)
        moment += (flux * place).sum(axis=1)
    return moment / total, total / total.sum()


def test_every_band_lies_where_snell_puts_it(bench, spectrum):
    # Ratios of sums over all passes; errors from the scatter of the passes, σ/√n.
    flux, moment = spectrum.sum(axis=0)
    centroid = moment / flux
    residual = spectrum[:, 1] - spectrum[:, 0] * centroid
    error = residual.std(axis=0, ddof=1) * np.sqrt(PASSES) / flux
    expected, _ = expected_centroids(bench)
    off = np.abs(centroid - expected)
    # What four directions for a cone leave out is of the order of α³ = 5e-9, times 0.5 m.
    assert np.all(off < 4.0 * error + 3e-9)
    # The test is sharp: neighbouring bands lie 1.5 to 7 mm apart, and errors are a hundredth.
    assert np.all(error[:, None] < 0.02 * np.abs(np.diff(expected)).min())


def test_red_and_violet_are_on_their_sides_and_the_order_is_that_of_the_rainbow(bench, spectrum):
    flux, moment = spectrum.sum(axis=0)
    centroid = moment / flux
    # Along the screen's width, to the right, wavelength increases: red is bent least.
    assert np.all(np.diff(centroid) > 0.0)
    assert centroid[0] < -0.03
    assert centroid[-1] > 0.03
    # 550 nm runs at minimum deviation, by δ = 2 asin(n sin 30°) − 60°, to where the gallery's file
    # says: 20 mm to the right of the screen's middle.
    at_550 = np.interp(550.0, bench.film.centres_nm, centroid)
    assert at_550 == pytest.approx(0.020, abs=1e-4)


def test_each_band_carries_its_share_of_daylight(bench, spectrum, assert_mean):
    _, share = expected_centroids(bench)
    flux = spectrum[:, 0]
    assert_mean(flux / flux.sum(axis=1, keepdims=True), share, slack=1e-6)
