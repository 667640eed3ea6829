"""Beer and Lambert's law on every way: slabs, coloured plates, and a coloured medium all around."""

import math

import numpy as np
import pytest

import scenes
from sim import analytic
from sim.render import render
from sim.settings import RenderSettings

ETA = 1.5
THICKNESS = 0.01
REACH = 20.0
PASSES = 16


def slab(absorption):
    """From y = 0 down, wide enough that light leaves it before it comes to an edge."""
    material = scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA), absorption=absorption)
    shape = scenes.Box(position=(0.0, -0.5 * THICKNESS, 0.0), size=(8.0, THICKNESS, 8.0))
    return scenes.SceneObject(name="slab", shape=shape, material=material)


def white(name, y, normal_y):
    shape = scenes.Rectangle(position=(0, y, 0), size=(REACH, REACH), normal=(0, normal_y, 0))
    return scenes.SceneObject(
        name=name, shape=shape, material=scenes.Lambertian(reflectance=0.5)
    )


def slab_scene(absorption, theta=0.0, film=None):
    """A pencil of light onto a slab, between a floor and a ceiling."""
    way = np.array([math.sin(theta), -math.cos(theta), 0.0])
    beam = scenes.Beam(
        position=tuple((-0.3 * way).tolist()), direction=tuple(way.tolist()),
        profile=scenes.RoundProfile(radius=1e-3), flux=2.0, spectrum="E",
    )  # fmt: skip
    objects = (slab(absorption), white("floor", -1.0, 1.0), white("ceiling", 1.0, -1.0))
    return scenes.Scene(objects=objects, emitters=(beam,), film=film or scenes.Film())


def napierian(coefficient):
    return scenes.NapierianAbsorption(coefficient=coefficient)


@pytest.mark.parametrize("theta_deg", [0.0, 40.0, 75.0])
@pytest.mark.parametrize("depth", [0.02, 0.5, 3.0])
def test_a_slab_reflects_transmits_and_absorbs_what_is_right(
    trace_passes, assert_mean, theta_deg, depth
):
    # Each face reflects r of s light and another r of p, and each crossing leaves a =
    # exp(−α d/cos θt). All internal reflections sum to T = (1 − r)² a/(1 − r² a²) and R =
    # r (1 + a T) of each, and natural light is half of both (Duffie & Beckman 2013, §5.3).
    theta = math.radians(theta_deg)
    r = np.array(analytic.fresnel_reflectance(math.cos(theta), 1.0, ETA), dtype=float).ravel()
    cos_theta_t = math.sqrt(1.0 - (math.sin(theta) / ETA) ** 2)
    a = math.exp(-depth / cos_theta_t)
    of_each = (1.0 - r) ** 2 * a / (1.0 - (r * a) ** 2)
    transmitted = float(np.mean(of_each))
    reflected = float(np.mean(r * (1.0 + a * of_each)))
    if theta == 0.0:
        split = analytic.slab_split(0.0, ETA, optical_depth=depth)
        assert transmitted == pytest.approx(float(split.transmitted), rel=1e-14)

    scene = slab_scene(napierian(depth / THICKNESS), theta)
    passes = trace_passes(scene, photons=500, passes=PASSES)
    emitted = np.array([books.emitted for books in passes.books])
    below = passes.sums(lambda one: one["flux"][one["position"][:, 1] < -0.5].sum())
    above = passes.sums(lambda one: one["flux"][one["position"][:, 1] > 0.5].sum())
    absorbed = np.array([books.absorbed for books in passes.books])
    # Roulette alone is left to chance: it decides on branches of less than 0.01.
    assert_mean(below / emitted, transmitted)
    assert_mean(above / emitted, reflected)
    assert_mean(absorbed / emitted, 1.0 - transmitted - reflected)
    for share in (below, above, absorbed):
        assert np.std(share / emitted) < 3e-3
    for books in passes.books:
        assert abs(books.residual) < 1e-12
        assert books.escaped == 0.0


def test_what_leaves_a_coloured_plate_is_coloured(trace_passes, assert_mean):
    knots, alpha = (400.0, 500.0, 550.0, 700.0), (20.0, 300.0, 50.0, 400.0)
    table = scenes.CoefficientTable(wavelength_nm=knots, values=alpha)
    film = scenes.Film(first_nm=420.0, last_nm=680.0, bands=14)
    scene = slab_scene(napierian(table), film=film)
    passes = trace_passes(scene, photons=2000, passes=PASSES)
    edges = np.asarray(film.edges_nm)

    def below(one):
        floor = one["position"][:, 1] < -0.5
        return np.histogram(one["wavelength_nm"][floor], edges, weights=one["flux"][floor])[0]

    # Straight on, T(λ) as above, of a lamp of the same flux in each nanometre; the mean over a
    # band by 200 midpoints errs by 1e-5 of it at the kinks of α.
    r = ((ETA - 1.0) / (ETA + 1.0)) ** 2
    fine = edges[0] + (np.arange(200 * 14) + 0.5) * (edges[-1] - edges[0]) / (200 * 14)
    a = np.exp(-np.interp(fine, knots, alpha) * THICKNESS)
    transmitted = (1.0 - r) ** 2 * a / (1.0 - (r * a) ** 2)
    expected = passes.flux / 14.0 * transmitted.reshape(14, 200).mean(axis=1)
    # Wavelengths are kept in single precision: a band's edge is off by 3e-5 of 20 nm.
    assert_mean(passes.sums(below), expected, slack=2e-5 * expected)
    for books in passes.books:
        assert abs(books.residual) < 1e-12


DYE = scenes.CoefficientTable(wavelength_nm=(300.0, 500.0, 900.0), values=(1.5, 0.1, 0.9))


def dyed_pool(grey=False):
    """A lamp over a floor, all in a coloured medium; the camera looks straight down."""
    coefficient = 0.7 if grey else DYE
    ambient = scenes.ConstantMedium(eta=1.33, absorption=napierian(coefficient))
    return scenes.Scene(
        ambient=ambient,
        film=scenes.Film(width=6, height=4, bands=8, first_nm=430.0, last_nm=670.0),
        camera=scenes.Camera(position=(0, 1.5, 0), look_at=(0, 0, 0), up=(0, 0, 1), fov_deg=10.0),
        objects=(
            scenes.SceneObject(
                name="floor", shape=scenes.Rectangle(position=(0, 0, 0), size=(1.0, 1.0)),
                material=scenes.Lambertian(reflectance=0.6),
            ),
        ),
        emitters=(scenes.Point(position=(0.3, 0.8, 0.0), flux=5.0, spectrum="E"),),
    )  # fmt: skip


@pytest.mark.parametrize("grey", [False, True])
def test_a_medium_all_around_colours_direct_light_and_what_is_seen(grey):
    scene = dyed_pool(grey)
    lamps, photons = (
        render(scene, RenderSettings(photons=40_000, passes=8, direct_light=one, radius=0.04))
        for one in ("lamps", "photons")
    )
    # L = ρ/π Φ'(λ)/(4π d²) cos θ exp(−α (d + s)), d the way from the lamp, s to the camera: its
    # mean over the picture, by midpoints, 96 a side and 41 a band: each errs by less than 1e-4.
    half = math.tan(math.radians(5.0))
    grid = (np.arange(96) + 0.5) / 48.0 - 1.0
    x, y = np.meshgrid(1.5 * half * 1.5 * grid, 1.5 * half * grid)
    edges = np.asarray(lamps.edges_nm)
    emission = scene.emitters[0].emission()
    per_nm = 5.0 * emission.band_flux(edges) / (emission.total * np.diff(edges))
    d2 = (x - 0.3) ** 2 + y**2 + 0.8**2
    way = np.sqrt(d2) + np.sqrt(x**2 + y**2 + 1.5**2)
    bare = 0.6 / math.pi * 0.8 / (4.0 * math.pi * d2 * np.sqrt(d2))
    fractions = (np.arange(41) + 0.5) / 41
    expected = []
    for low, high, power in zip(edges[:-1], edges[1:], per_nm, strict=True):
        nm = low + (high - low) * fractions
        alpha = 0.7 if grey else np.interp(nm, DYE.wavelength_nm, DYE.values)[:, None, None]
        expected.append(power * np.mean(bare * np.exp(-alpha * way)))
    for picture in (lamps, photons):
        radiance = picture.spectral_radiance
        error = np.sqrt(np.sum(picture.standard_error**2, axis=(0, 1))) / radiance[..., 0].size
        # Of a pixel's few samples the standard error is itself known to a part only: 8 for 5.
        off = np.abs(radiance.mean(axis=(0, 1)) - expected)
        # The gather's own bias is r² ∇²E/12: 1e-3 of E.
        assert np.all(off <= 8.0 * error + 2e-3 * np.array(expected))
        assert np.all(error < 0.02 * np.array(expected))
