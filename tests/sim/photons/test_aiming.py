"""What photons are aimed at where there are sensors."""

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.photons.aiming import SENSOR_SHARE, Guide, plan_photons
from sim.photons.lamp_structs import AIM_AREA, AIM_BASE
from sim.photons.lamps import compile_lamps
from sim.scene_data import compile_scene

LAMP = scenes.Point(position=(0.0, 1.0, 0.0), flux=1.0, spectrum="E")
BEAM = scenes.Beam(
    position=(0.0, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=1.0, spectrum="E",
    profile=scenes.RoundProfile(radius=0.1),
)
DISK = scenes.Disk(position=(2.0, 0.0, 0.0), normal=(1.0, 0.0, 0.0), radius=0.25)


def compiled(lamp, sensors):
    scene = scenes.Scene(emitters=(lamp,), sensors=sensors)
    return compile_scene(scene, device=start_device("cpu"))


SENSORS = (scenes.RaySensor(shape=DISK),)


def guided(lamp, sensors=SENSORS):
    """Lamps with a guide that was made for a picture, and knows of the lamp's base alone."""
    scene = compiled(lamp, sensors)
    plain = plan_photons(compiled(lamp, ()), [(lamp, 1.0)], None, direct=True)
    base = tuple(one for one in plain.aims[0] if one.kind == AIM_BASE)
    guide = Guide((1.0,), (base,))
    return compile_lamps(scene, scene.scene.film.edges_nm, 1000, guide=guide)


def test_a_guide_spares_a_part_for_sensors():
    lamps = guided(LAMP)
    base, sensor = lamps.aims[0]
    assert (base.kind, sensor.kind) == (int(AIM_BASE), int(AIM_AREA))
    photons = [one.photons for one in lamps.streams]
    assert photons[1] == pytest.approx(SENSOR_SHARE * 1000, abs=1)
    assert sum(photons) == 1000
    # The square around the disk.
    np.testing.assert_allclose(sensor.centre, compiled(LAMP, SENSORS).to_local(DISK.position))
    np.testing.assert_allclose(sensor.half, DISK.radius)
    np.testing.assert_allclose(sensor.frame[2], DISK.normal)


def test_a_beam_aims_itself():
    # It has one stream: a second one would emit its flux twice.
    assert len(guided(BEAM).streams) == 1


def test_without_sensors_a_guide_stays_as_it_is():
    assert len(guided(LAMP, ()).streams) == 1


def test_what_is_for_pictures_alone_does_not_aim_at_sensors():
    scene = compiled(LAMP, SENSORS)
    for direct, kinds in ((True, [AIM_BASE, AIM_AREA]), (False, [AIM_BASE])):
        plan = plan_photons(scene, [(LAMP, 1.0)], None, direct=direct)
        assert [one.kind for one in plan.aims[0]] == [int(kind) for kind in kinds]
