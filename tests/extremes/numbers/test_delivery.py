"""What photons really get: the numbers that the other tests look at, every one of them.

A photon of a slit beam shows all five: its place on the slit is (2 u₀ − 1, 2 u₁ − 1) half widths,
its wavelength 400 nm + 300 nm u₂ of an even spectrum, its direction that of (u₃, u₄) in a cone. A
sensor behind the slit has them to the last digits, in the order of emission.
"""

import itertools

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.photons.lamps import compile_lamps
from sim.photons.tracing import trace_photons
from sim.scene_data import compile_scene
from sim.sensors.sensor_bank import compile_sensors

PHOTONS = 10_000
HALF_U, HALF_V = 0.3, 0.2
"""Half the slit [m]."""

CONE_DEG = 20.0
DISTANCE = 0.05
"""From the slit to the sensor [m]."""


def make_scene():
    """Two slit beams one behind the other, so two streams, and a sensor that both cross."""
    even = scenes.SpectrumTable(wavelength_nm=(400.0, 700.0), values=(1.0, 1.0))
    beams = tuple(
        scenes.Beam(
            position=(0.0, 0.0, height), direction=(0.0, 0.0, -1.0), flux=1.0, spectrum=even,
            divergence_deg=CONE_DEG,
            profile=scenes.SlitProfile(width=2 * HALF_U, height=2 * HALF_V, up=(0.0, 1.0, 0.0)),
        )
        for height in (DISTANCE, 2.0 * DISTANCE)
    )
    place = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0), normal=(0.0, 0.0, 1.0))
    floor = scenes.SceneObject(
        name="floor", material=scenes.Absorber(),
        shape=scenes.Rectangle(position=(0.0, 0.0, -1.0), size=(5.0, 5.0), normal=(0.0, 0.0, 1.0)),
    )
    return scenes.Scene(
        objects=(floor,), emitters=beams, film=scenes.Film(first_nm=425.0, last_nm=675.0, bands=6),
        sensors=(scenes.RaySensor(name="rays", shape=place),),
    )


def in_cone(u3, u4):
    """Directions about z: a disk by Shirley & Chiu (1997), s = 1 − cos θ uniform in r²."""
    a, b = 2.0 * u3 - 1.0, 2.0 * u4 - 1.0
    wide = np.abs(a) > np.abs(b)
    r = np.where(wide, a, b)
    angle = np.pi / 4.0 * np.where(wide, b, a) / r
    x = r * np.where(wide, np.cos(angle), np.sin(angle))
    y = r * np.where(wide, np.sin(angle), np.cos(angle))
    s = 2.0 * r**2 * np.sin(np.radians(CONE_DEG) / 2.0) ** 2
    sine = np.sqrt(s * (2.0 - s)) / np.abs(r)
    return np.stack([x * sine, y * sine, 1.0 - s], axis=1)


ROUNDING = 2e-15
"""Some ten roundings of 1.1e-16, of numbers below 1."""


@pytest.mark.parametrize(
    ("seed", "pass_index", "threads"), [(0, 0, 1), (7, 1000, 2), (7, -1, 3), (2**63 - 1, 3, 2)]
)
def test_photons_get_the_numbers_of_their_stream(draw_numbers, seed, pass_index, threads):
    compiled = compile_scene(make_scene(), device=start_device("cpu"))
    lamps = compile_lamps(compiled, np.array([400.0, 700.0]), 2 * PHOTONS)
    assert [stream.photons for stream in lamps.streams] == [PHOTONS, PHOTONS]
    batch = trace_photons(
        compiled, lamps, seed=seed, pass_index=pass_index, max_interactions=64, threads=threads,
        sensors=compile_sensors(compiled), range_size=1000,
    )
    rays, frames = batch.crossings.rays, lamps.data.emitters.numpy()["frame"]
    assert len(rays["flux"]) == 2 * PHOTONS
    streams = [(seed, pass_index, row) for row in range(2)]
    numbers = draw_numbers("sobol", streams, np.arange(PHOTONS))
    for row, (u, frame) in enumerate(zip(numbers, frames, strict=True)):
        mine = slice(row * PHOTONS, (row + 1) * PHOTONS)
        assert np.all(rays["emitter"][mine] == row)
        way = rays["direction"][mine]
        # About −z the frame (Duff et al. 2017) is (x, −y, −z).
        local = in_cone(u[:, 3], u[:, 4])
        np.testing.assert_allclose(way, local * [1.0, -1.0, -1.0], rtol=0, atol=ROUNDING)
        start = rays["position"][mine] + way * ((row + 1) * DISTANCE / way[:, 2:])
        start[:, 2] = 0.0
        place = frame[0] * ((2.0 * u[:, :1] - 1.0) * HALF_U)
        place += frame[1] * ((2.0 * u[:, 1:2] - 1.0) * HALF_V)
        np.testing.assert_allclose(start, place, rtol=0, atol=ROUNDING)
        expected_nm = 400.0 + 300.0 * u[:, 2]
        np.testing.assert_allclose(rays["wavelength_nm"][mine], expected_nm, rtol=ROUNDING)


def test_no_two_streams_of_a_scene_share_a_scramble():
    compiled = compile_scene(make_scene(), device=start_device("cpu"))
    lamps = compile_lamps(compiled, np.array([400.0, 700.0]), 64)
    words = []
    for seed, pass_index in itertools.product((0, 1), (-1, 0, 1)):
        lamps.seed(compiled.device, seed, pass_index)
        words += lamps.data.seeds.numpy().tolist()
    assert len(set(words)) == len(words) == 2 * 3 * 2 * 5
