"""The mesh against closed forms: plate, prism, ball and roof."""

import numpy as np
import pytest

import scenes
from sim.analytic import (
    angle_between,
    fresnel_reflectance,
    plate_lateral_shift,
    prism_deviation,
    snell_angle,
)
from sim.errors import SettingsError
from sim.study.caustic_mesh import Resolution, trace_caustic_mesh
from sim.study.metrics import ARCSECONDS, relative_l2
from sim.study.receiver_bins import lay_bins
from spectra import glass

BANDS = [400.0, 500.0, 550.0, 700.0]
GREEN = {"flux": 1.0, "spectrum": scenes.Laser(wavelength_nm=500.0)}
DOWN = (0.0, -1.0, 0.0)
COARSE = Resolution(cells=16, wavelengths=2, lamp_points=2)


def overlap(low, high, edges):
    """Length that [low, high] and each interval between the edges have in common."""
    return np.maximum(np.minimum(high, edges[1:]) - np.maximum(low, edges[:-1]), 0.0)


def test_a_plate_shifts_the_image_of_a_slit(make_bench, compile_bench):
    # Turned by 35° about z, it moves light along x by t sin θ (1 − cos θ/√(n² − sin² θ)) and takes
    # 1 − (1 − R(θ))² of it. Every cell is a parallelogram: exact to rounding, with any mesh.
    tilt, thickness, half = np.radians(35.0), 0.02, np.array([0.011, 0.007])
    spectrum = scenes.Lines(wavelength_nm=(450.0, 600.0), weights=(1.0, 3.0))
    lamp = scenes.Beam(
        name="slit", position=(0.0, 1.0, 0.003), direction=DOWN, flux=2.0, spectrum=spectrum,
        profile=scenes.SlitProfile(width=2.0 * half[0], height=2.0 * half[1]),
    )
    plate = scenes.Box(
        position=(0.0, 0.5, 0.0), size=(0.3, thickness, 0.3), rotation_deg=(0.0, 0.0, 35.0)
    )
    floor = scenes.Rectangle(position=(0.005, 0.0, 0.0), size=(0.05, 0.03))
    compiled = compile_bench(make_bench(lamp, slab=plate, floor=floor))
    bins = lay_bins(compiled.scene, "floor", rows=9, columns=13)
    mesh = trace_caustic_mesh(
        compiled, bins, emitter="slit", target="slab", edges_nm=BANDS, resolution=COARSE,
        branches=("refract", "refract"),
    )
    eta = glass("N-BK7").eta(np.array([450.0, 600.0]))
    shift = plate_lateral_shift(tilt, eta, thickness)  # downhill, toward +x
    # s stays s at the second surface, and p stays p.
    reflectance = np.array(fresnel_reflectance(np.cos(tilt), 1.0, eta))
    u_edges = bins.low[0] + np.arange(14) * bins.bin_size[0] + 0.005
    v_edges = bins.low[1] + np.arange(10) * bins.bin_size[1]
    expected = np.zeros((9, 13, 3))
    for line, band, flux in ((0, 0, 0.5), (1, 2, 1.5)):
        across = overlap(shift[line] - half[0], shift[line] + half[0], u_edges)
        along = overlap(-0.003 - half[1], -0.003 + half[1], v_edges)  # v = −z
        share = np.outer(along, across) / np.prod(2.0 * half)
        through = np.mean((1.0 - reflectance[:, line]) ** 2)
        expected[:, :, band] = flux * through * share
    expected /= bins.bin_area * np.diff(BANDS)
    np.testing.assert_allclose(mesh.irradiance, expected, rtol=1e-10, atol=1e-10 * expected.max())
    assert mesh.relative_error < 1e-10
    assert np.isnan(mesh.order)
    assert mesh.cut_fraction == 0.0
    assert mesh.emitted == pytest.approx(2.0, rel=1e-12)
    inside = np.sum(mesh.irradiance * bins.bin_area * np.diff(BANDS))
    assert inside == pytest.approx(mesh.landed, rel=1e-12)


def test_a_prism_turns_each_line_by_its_deviation(make_bench, compile_bench):
    # δ = θ_i + θ_e − A (Born & Wolf 1999, §4.7.2), from the centroids on two screens 1 m apart. A
    # centroid of bins b wide of an image of width w is off by b/2 for the light of its outermost
    # bins, b/w each: b²/w = 1e-7 m, or 0.04″ on either screen.
    lines_nm = np.array([486.1327, 587.5618, 656.2725])
    spectrum = scenes.Lines(wavelength_nm=tuple(lines_nm), weights=(1.0, 1.0, 1.0))
    incidence, apex = np.radians(50.0), np.radians(60.0)
    # Apex up, base along x; light from the left meets the left face, whose normal is (−cos 30°,
    # sin 30°, 0), at 50° below it. It is turned toward the base, clockwise.
    rising = np.radians(50.0 - 30.0)
    way = np.array([np.cos(rising), np.sin(rising), 0.0])
    prism = scenes.Prism(position=(0.0, 0.0, 0.0), base=0.06, apex_deg=60.0, length=0.05)
    start = np.array([-0.015, 0.0, 0.0]) - 0.2 * way
    lamp = scenes.Beam(
        name="slit", position=tuple(start), direction=tuple(way), flux=1.0, spectrum=spectrum,
        profile=scenes.SlitProfile(width=0.01, height=0.004, up=(-way[1], way[0], 0.0)),
    )
    expected = prism_deviation(apex, incidence, glass("N-BK7").eta(lines_nm))
    turned = rising - expected[1]
    ahead = np.array([np.cos(turned), np.sin(turned), 0.0])
    centroids = []
    for distance in (1.0, 2.0):
        screen = scenes.Rectangle(
            position=tuple(distance * ahead), size=(0.04, 0.1), normal=tuple(-ahead),
            up=(-ahead[1], ahead[0], 0.0),
        )
        compiled = compile_bench(make_bench(lamp, slab=prism, floor=screen))
        bins = lay_bins(compiled.scene, "floor", rows=5000, columns=1)
        mesh = trace_caustic_mesh(
            compiled, bins, emitter="slit", target="slab", edges_nm=[450.0, 550.0, 620.0, 700.0],
            branches=("refract", "refract"), resolution=COARSE,
        )
        share = mesh.irradiance / mesh.irradiance.sum(axis=(0, 1))
        centroids.append(np.einsum("ijb,ijx->bx", share, bins.bin_centres()))
    found = angle_between(centroids[1] - centroids[0], way)
    np.testing.assert_allclose(found * ARCSECONDS, expected * ARCSECONDS, atol=0.08)
    assert np.all(np.diff(found) < 0.0)  # red is turned least


def ball_strips(bins, profile_radius, eta, height):
    """Irradiance of strips under a unit-flux beam through a ball of radius 0.5 at the origin.

    A ray at h = R sin θ_i leaves the ball at the polar angle θ_i + π − 2 θ_t, turned by
    2 (θ_i − θ_t), and meets the floor in a ring, of which a strip holds a part: midpoints over h.
    """
    count = 200_000
    angle = (np.arange(count) + 0.5) / count * 0.5 * np.pi
    h = profile_radius * np.sin(angle)
    flux = np.sin(2.0 * angle) * 0.5 * np.pi / count
    theta_i = np.arcsin(h / 0.5)
    theta_t = snell_angle(theta_i, 1.0, eta).theta_t
    exit_angle, turn = theta_i + np.pi - 2.0 * theta_t, 2.0 * (theta_i - theta_t)
    fall = 0.5 * np.cos(exit_angle) + height
    radius = np.abs(0.5 * np.sin(exit_angle) - fall * np.tan(turn))
    into = np.array(fresnel_reflectance(np.cos(theta_i), 1.0, eta))
    out = np.array(fresnel_reflectance(np.cos(theta_t), eta, 1.0))
    flux = flux * np.mean((1.0 - into) * (1.0 - out), axis=0)
    edges = bins.low[0] + np.arange(bins.columns + 1) * bins.bin_size[0]
    below = [np.sum(flux * np.arcsin(np.clip(x / radius, -1.0, 1.0))) / np.pi for x in edges]
    return bins.irradiance(np.diff(below)[None, :, None], [450.0, 550.0]), float(flux.sum())


@pytest.mark.parametrize(("height", "size"), [(0.55, 0.14), (0.9, 0.7)])
def test_under_a_ball_the_error_falls_with_the_square_of_the_cells(
    make_bench, compile_bench, height, size
):
    # Before the paraxial focus, 0.75 from the centre for n = 1.5, and behind it, where the mesh is
    # turned inside out. Caustics included, all light lands in the bins.
    lamp = scenes.Beam(
        name="beam", position=(0.0, 3.0, 0.0), direction=DOWN,
        profile=scenes.RoundProfile(radius=0.4), **GREEN,
    )
    ball = scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.5)
    floor = scenes.Rectangle(position=(0.0, -height, 0.0), size=(size, size))
    compiled = compile_bench(make_bench(lamp, ball=ball, floor=floor))
    bins = lay_bins(compiled.scene, "floor", rows=1, columns=24)
    expected, landed = ball_strips(bins, 0.4, 1.5, height)
    meshes = [
        trace_caustic_mesh(
            compiled, bins, emitter="beam", target="ball", edges_nm=[450.0, 550.0],
            branches=("refract", "refract"),
            resolution=Resolution(cells=cells, wavelengths=2, lamp_points=2),
        )
        for cells in (32, 64, 128, 256)
    ]
    errors = np.array([relative_l2(mesh.irradiance, expected) for mesh in meshes])
    # Second order: 4 a doubling. At the caustic's edge terms of other orders differ by a fifth.
    ratios = errors[:-1] / errors[1:]
    assert np.all((ratios > 3.2) & (ratios < 4.8))
    assert errors[-1] < 2e-4
    for mesh, error in zip(meshes, errors, strict=True):
        assert 0.5 * error < mesh.mesh_error < 2.0 * error
        assert mesh.wavelength_error == mesh.lamp_error == 0.0
        # All light that the ball sends on lands, and in the bins.
        inside = np.sum(mesh.irradiance) * bins.bin_area * 100.0
        assert inside == pytest.approx(mesh.landed, rel=1e-9)
    assert meshes[-1].order == pytest.approx(2.0, abs=0.3)
    misses = [abs(mesh.landed / landed - 1.0) for mesh in meshes]
    assert misses[-1] < 3e-6
    assert misses[-2] / misses[-1] == pytest.approx(4.0, rel=0.05)


def test_edges_are_found_by_halving(make_bench, compile_bench):
    # A box blocks direct light from a point 1 m up: its shadow, of the top face 0.2 × 0.2 at
    # y = 0.5, ends in the middle of bins. Flux beside it, Φ (Ω_floor − Ω_shadow)/4π.
    lamp = scenes.Point(name="lamp", position=(0.0, 1.0, 0.0), **GREEN)
    box = scenes.Box(position=(0.0, 0.4, 0.0), size=(0.21, 0.2, 0.17))
    floor = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(0.8, 0.8))
    compiled = compile_bench(make_bench(lamp, slab=box, floor=floor))
    bins = lay_bins(compiled.scene, "floor", rows=1, columns=1)

    def solid_angle(a, b, h):  # of a rectangle 2a × 2b below its middle
        return 4.0 * np.arctan(a * b / (h * np.sqrt(a * a + b * b + h * h)))

    lit = solid_angle(0.4, 0.4, 1.0) - solid_angle(0.105, 0.085, 0.5)
    mesh = trace_caustic_mesh(
        compiled, bins, emitter="lamp", target="floor", edges_nm=[450.0, 550.0], branches=(),
        resolution=Resolution(cells=128, wavelengths=2, lamp_points=2),
    )
    flux = float(mesh.irradiance.sum()) * bins.bin_area * 100.0
    assert mesh.cut_fraction > 0.0
    # By corners alone, on cells of 1/64: the perimeter times half a cell, 1%.
    assert flux == pytest.approx(lit / (4.0 * np.pi), rel=3e-4)
    assert abs(flux * 4.0 * np.pi / lit - 1.0) < mesh.relative_error


@pytest.fixture
def roof(make_bench, compile_bench):
    """A beam on the ridge of a roof of glass, of 20° on either side, and a screen 2 m below."""

    def light(spectrum):
        lamp = scenes.Beam(
            name="beam", position=(0.013, 1.0, 0.0), direction=DOWN, flux=1.0, spectrum=spectrum,
            profile=scenes.SlitProfile(width=0.1, height=0.1),
        )
        prism = scenes.Prism(position=(0.0, 0.0, 0.0), base=0.4, apex_deg=140.0, length=0.4)
        floor = scenes.Rectangle(position=(0.0, -2.0, 0.0), size=(1.2, 0.2))
        return compile_bench(make_bench(lamp, slab=prism, floor=floor))

    return light


def test_no_cell_is_stretched_over_an_edge(roof):
    # Each face deflects its part by about (n − 1) 20°: 10.5°, or 0.37 m at the screen, toward the
    # other side. Between both images it is dark; they hold what reaches the right face,
    # 63/100, and the left one.
    compiled = roof(scenes.Laser(wavelength_nm=500.0))
    bins = lay_bins(compiled.scene, "floor", rows=1, columns=12)
    mesh = trace_caustic_mesh(
        compiled, bins, emitter="beam", target="slab", edges_nm=[450.0, 550.0],
        branches=("refract", "refract"),
        resolution=Resolution(cells=64, wavelengths=2, lamp_points=2),
    )
    strips = mesh.irradiance[0, :, 0]
    np.testing.assert_array_equal(strips[4:8], 0.0)  # 0.4 m
    assert mesh.cut_fraction > 0.0
    # The ridge lies within a cell of 1/64 halved three times.
    assert strips[:4].sum() / strips.sum() == pytest.approx(0.63, abs=1 / 512)


def test_too_few_wavelengths_are_told(roof):
    # Dispersion moves the image by 9 mm over the band, over bins of 6 mm: 4 images leave steps.
    compiled = roof("E")
    bins = lay_bins(compiled.scene, "floor", rows=1, columns=200)

    def trace(wavelengths):
        return trace_caustic_mesh(
            compiled, bins, emitter="beam", target="slab", edges_nm=[400.0, 700.0],
            branches=("refract", "refract"),
            resolution=Resolution(cells=64, wavelengths=wavelengths, lamp_points=2),
        )

    few, many = trace(4), trace(32)
    error = relative_l2(few.irradiance, many.irradiance)
    assert error < few.wavelength_error < 20.0 * error
    # Where images are further apart than bins their edges are steps, and 8 times as many have an
    # eighth of the error; beyond that, more.
    assert many.wavelength_error < 0.25 * few.wavelength_error


def test_light_that_takes_another_way_is_not_counted(make_bench, compile_bench):
    lamp = scenes.Beam(
        name="beam", position=(0.0, 3.0, 0.0), direction=DOWN,
        profile=scenes.RoundProfile(radius=0.1), **GREEN,
    )
    floor = scenes.Rectangle(position=(0.0, -0.6, 0.0), size=(1.0, 1.0))
    compiled = compile_bench(
        make_bench(lamp, ball=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.5), floor=floor)
    )
    bins = lay_bins(compiled.scene, "floor", rows=1, columns=1)
    options = {"emitter": "beam", "target": "ball", "edges_nm": [450.0, 550.0]}
    options["resolution"] = COARSE
    for branches in ((), ("refract",), ("refract",) * 3, ("reflect",)):
        mesh = trace_caustic_mesh(compiled, bins, branches=branches, **options)
        assert mesh.irradiance.sum() == mesh.landed == 0.0
    # Two more surfaces, both of them reflections: R² (1 − R)² of the light, with R = 0.04 at the
    # axis, and nowhere in the narrow beam, at sin θ_i < 0.2, more than 2% off.
    twice = trace_caustic_mesh(
        compiled, bins, branches=("refract", "reflect", "reflect", "refract"), **options
    )
    assert twice.landed == pytest.approx(0.04**2 * 0.96**2, rel=0.02)
    every = trace_caustic_mesh(compiled, bins, branches=None, **options)
    assert every.landed == pytest.approx(0.96**2, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"emitter": "sun"}, "emitter: 'sun' .* an emitter of the scene: lamp"),
        ({"target": "wall"}, "target: 'wall'"),
        ({"edges_nm": [300.0, 500.0]}, "within the film's 350 to 750 nm"),
        ({"branches": ("bend",)}, "branches"),
    ],
)
def test_what_is_not_there_is_refused(make_bench, compile_bench, change, message):
    lamp = scenes.Point(name="lamp", position=(0.0, 1.0, 0.0), **GREEN)
    compiled = compile_bench(make_bench(lamp))
    bins = lay_bins(compiled.scene, "floor", rows=1, columns=1)
    options = {"emitter": "lamp", "target": "floor", "edges_nm": BANDS, "resolution": COARSE}
    with pytest.raises(SettingsError, match=message):
        trace_caustic_mesh(compiled, bins, **{**options, **change})


@pytest.mark.parametrize(
    "change", [{"cells": 8}, {"cells": 48}, {"wavelengths": 3}, {"lamp_points": 0}]
)
def test_a_resolution_can_be_halved(change):
    with pytest.raises(SettingsError, match=next(iter(change))):
        Resolution(**change)
