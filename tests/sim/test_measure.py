"""Measuring: the same readings however it is run, ends where asked to, and clear errors."""

import dataclasses

import numpy as np
import pytest

import scenes
import sim

LAMP = scenes.Point(position=(0.0, 1.0, 0.0), flux=1.0, spectrum="E")
PLACE = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0))
SCENE = scenes.Scene(
    sensors=(
        scenes.IrradianceSensor(name="cells", shape=PLACE, pixels=(4, 4), bands=2),
        scenes.RaySensor(name="rays", shape=PLACE, max_rays=3000),
    ),
    emitters=(LAMP,),
)


def measure(**settings):
    return sim.measure(SCENE, sim.RenderSettings(**{"photons": 20_000, "passes": 3, **settings}))


def test_threads_change_nothing_and_seeds_do():
    one, two, other = measure(threads=1), measure(threads=2), measure(seed=7)
    for name in ("cells", "rays"):
        found, same = one.sensors[name], two.sensors[name]
        for field in dataclasses.fields(found):
            value = getattr(found, field.name)
            if isinstance(value, np.ndarray):
                np.testing.assert_array_equal(value, getattr(same, field.name))
    assert one.energy == two.energy
    assert one.sensors["cells"].flux != other.sensors["cells"].flux


def test_it_ends_at_a_target_error():
    found = measure(target_error=0.02, photons=1000, passes=None)
    assert found.stopping == "target error"
    assert 2 <= found.settings.passes < 200
    again = sim.measure(SCENE, found.settings)
    np.testing.assert_array_equal(
        again.sensors["cells"].irradiance, found.sensors["cells"].irradiance
    )


def test_progress_is_told():
    told = []
    settings = sim.RenderSettings(photons=20_000, passes=2)
    found = sim.measure(SCENE, settings, progress=told.append)
    assert told[-1].photons_done == 40_000
    assert {one.stage for one in told} >= {"compile", "trace photons", "read sensors"}
    assert set(found.timings) == {"compile", "trace photons", "read sensors"}
    assert "sensors" in found.features["on"]


def test_a_scene_without_sensors_is_an_error():
    with pytest.raises(scenes.SceneError, match="sensors: missing; a measurement needs"):
        sim.measure(SCENE.model_copy(update={"sensors": ()}))


def test_a_sensor_that_no_light_reaches_reads_zero():
    behind = PLACE.model_copy(update={"normal": (0.0, -1.0, 0.0)})
    sensors = tuple(one.model_copy(update={"shape": behind}) for one in SCENE.sensors)
    found = sim.measure(
        SCENE.model_copy(update={"sensors": sensors}), sim.RenderSettings(photons=500, passes=2)
    ).sensors
    assert np.all(found["cells"].spectral_irradiance == 0.0)
    assert np.all(found["cells"].standard_error == 0.0)
    assert (len(found["rays"]), found["rays"].total_flux) == (0, 0.0)
    assert np.isnan(found["rays"].spot().rms_radius)
    assert np.all(found["rays"].far_field([0.0, 1.0]).intensity == 0.0)
