"""Sensors take nothing away: photons and their books are the same, to the bit."""

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.photons.lamps import compile_lamps
from sim.photons.tracing import trace_photons
from sim.scene_data import compile_scene
from sim.sensors.sensor_bank import compile_sensors


def with_sensors(scene):
    """Sensors all over the small scene: before, in, behind and around the ball."""
    flat = scenes.Rectangle(position=(0.0, 1.0, 0.0), size=(2.0, 2.0))
    sensors = [
        scenes.IrradianceSensor(
            name=f"level {height}", pixels=(5, 3), sides="both",
            shape=flat.model_copy(update={"position": (0.0, height, 0.0)}),
        )
        for height in (0.0, 0.25, 0.5, 1.0, 1.5, 2.0)
    ]
    upright = scenes.Disk(position=(0.5, 1.0, 0.0), normal=(1.0, 0.0, 0.0), radius=2.0)
    sensors.append(scenes.RaySensor(name="upright", shape=upright, sides="both"))
    return scene.model_copy(update={"sensors": tuple(sensors)})


@pytest.fixture(scope="module", params=["float64", "float32"])
def batches(request, small_scene):
    """The same photons without and with sensors."""
    found = []
    bare = compile_scene(small_scene, precision=request.param, device=start_device("cpu"))
    lamps = compile_lamps(bare, small_scene.film.edges_nm, 5000)
    for scene in (small_scene, with_sensors(small_scene)):
        compiled = compile_scene(scene, precision=request.param, device="cpu")
        assert compiled.features.sensors == bool(scene.sensors)
        found.append(
            trace_photons(
                compiled, lamps, seed=1, pass_index=0, max_interactions=64, threads=2,
                sensors=compile_sensors(compiled),
            )
        )
    return found


def test_books_and_photons_are_the_same(batches):
    bare, measured = batches
    assert measured.books == bare.books
    photons = measured.to_numpy()
    for name, column in bare.to_numpy().items():
        np.testing.assert_array_equal(photons[name], column)


def test_and_the_sensors_have_counted(batches):
    bare, measured = batches
    assert bare.crossings is None
    assert len(measured.crossings.rays["flux"]) > 100
    # A level of 2 m is crossed by the whole beam on its way, and by what the ball reflects.
    flux = measured.crossings.flux.reshape(6, -1).sum(axis=1)
    assert bare.books.emitted < flux[5] < 1.3 * bare.books.emitted
    assert np.all(flux > 0.0)
