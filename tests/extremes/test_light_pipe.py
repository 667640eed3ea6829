"""Ten thousand total reflections and more, in a light pipe: no leak, no gain, no drift."""

import math

import numpy as np
import pytest

import scenes
from sim import analytic

ETA = 1.5
BOUNCES = 10_000
THETA = math.radians(30.0)
"""Of light to the pipe's axis: at the sides it is reflected totally, at 60° > 41.8°, at the ends
it comes at 30° and gets out."""
LENGTH = BOUNCES / math.tan(THETA)
"""So long that light crosses the pipe, of width 1, that many times on its way to the end."""


def box(size, position=(0.0, 0.0, 0.0)):
    return scenes.SceneObject(
        name="box",
        shape=scenes.Box(position=position, size=size),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA)),
    )


def test_a_ray_goes_round_65536_times_and_is_the_same(follow, precision, eps):
    # A direction with no component beyond cos 41.8° = 0.745 along any normal is reflected for ever,
    # and only its signs change. As many surfaces as a path may meet.
    limit = 2**16
    way = np.array([0.6, -0.5, math.sqrt(1.0 - 0.61)])
    (path,) = follow(
        [box((1.0, 1.2, 0.9))], (0.1, 0.2, 0.05), way, precision=precision,
        max_interactions=limit, polarisation=scenes.Polarisation(angle_deg=30.0),
    )  # fmt: skip
    assert path.events == ("total internal reflection",) * (limit - 1) + ("limit",)
    np.testing.assert_array_equal(path.reflectances, 1.0)
    np.testing.assert_array_equal(path.absorptances, 0.0)
    norms = np.linalg.norm(path.directions, axis=1)
    np.testing.assert_allclose(norms, 1.0, rtol=0, atol=4 * eps[precision])
    # A reflection along an axis changes one sign; to mend the length changes the others, by less
    # than ε each time, in one direction at the worst.
    drift = np.abs(np.abs(path.directions) - np.abs(way)).max()
    assert drift <= eps[precision] * limit
    assert np.max(np.abs(path.points) - (0.5, 0.6, 0.45)) <= 4 * eps[precision]
    # Total reflection turns linear light elliptic and loses none of its polarisation: the Stokes
    # vector's length is rounded by some ε a time, and so is the frame's.
    degree = np.linalg.norm(path.polarisations, axis=1)
    assert np.max(np.abs(degree - 1.0)) <= 8 * eps[precision] * limit
    frames = np.linalg.norm(path.frames, axis=1)
    np.testing.assert_allclose(frames, 1.0, rtol=0, atol=4 * eps[precision])
    across = np.sum(path.frames * path.directions, axis=1)
    assert np.max(np.abs(across)) <= 8 * eps[precision] * math.sqrt(limit)


def light_through_a_pipe():
    """A lamp in a long rod of lossless glass, and a wall behind each of its ends."""
    walls = [
        scenes.SceneObject(
            name=name,
            shape=scenes.Rectangle(position=(x, 0, 0), size=(1e3, 1e3), normal=normal),
            material=scenes.Lambertian(reflectance=0.5),
        )
        for name, x, normal in (
            ("left", -0.5 * LENGTH - 2.0, (1, 0, 0)), ("right", 0.5 * LENGTH + 2.0, (-1, 0, 0)),
        )
    ]  # fmt: skip
    lamp = scenes.Beam(
        position=(-0.5 * LENGTH + 1.0, 0.0, 0.1),
        direction=(math.cos(THETA), math.sin(THETA), 0.0), flux=1.0, spectrum="E",
        profile=scenes.RoundProfile(radius=0.05),
    )  # fmt: skip
    rod = box((LENGTH, 1.0, 1.0))
    return scenes.Scene(objects=(rod, *walls), emitters=(lamp,))


def test_photons_come_out_of_a_pipe_after_ten_thousand_reflections(trace_passes, precision, eps):
    photons = 64
    traced = trace_passes(
        light_through_a_pipe(), photons=photons, precision=precision, max_interactions=2**16
    )
    (books,), (stored,) = traced.books, traced.photons
    unit = eps[precision]
    # No leak through the sides, no gain: each photon's own books are sums of a dozen terms.
    assert books.escaped == 0.0
    assert books.absorbed == 0.0
    assert books.deposited + books.culled == pytest.approx(books.emitted, rel=16 * unit)
    # Each end lets T through and reflects R, by s and p apart: to the right T/(1 − R²), to the left
    # T R/(1 − R²), together 1. What goes round a second time, R² = 0.16 % of it, plays roulette for
    # 1 %, so that a photon is off by at most 1 %, in the root mean square by 1 % √0.16.
    reflectances = analytic.fresnel_reflectance(math.cos(THETA), ETA, 1.0)
    right = float(np.mean([(1 - r) / (1 - r * r) for r in reflectances]))
    sigma = 0.01 * math.sqrt(0.16 / photons)
    shares = [stored["flux"][stored["object"] == k].sum() / books.emitted for k in (1, 2)]
    assert shares[1] == pytest.approx(right, abs=5 * sigma + 16 * unit)
    assert shares[0] == pytest.approx(1.0 - right, abs=5 * sigma + 16 * unit)
    # Directions behind the end: sinθ_e = η sinθ. Each reflection turns them by ε at the worst;
    # they are stored in float32.
    sine = np.abs(stored["direction"][:, 1])
    slack = ETA * unit * BOUNCES + 4 * eps["float32"]
    np.testing.assert_allclose(sine, ETA * math.sin(THETA), rtol=0, atol=slack)
    np.testing.assert_allclose(stored["direction"][:, 2], 0.0, atol=slack)
    # The counts of a photon's history are full, and have not run over into one another.
    assert np.all(stored["reflections"] == 1023)
    assert np.all(stored["refractions"] == 1)
    assert np.all(stored["bounces"] == 0)
