"""The photon map holds a pass's photons, all of them and each once, in any order of cells."""

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.photons.lamps import compile_lamps
from sim.photons.photon_map import build_photon_map
from sim.photons.receivers import compile_receivers
from sim.photons.tracing import trace_photons
from sim.scene_data import compile_scene

RADIUS = 0.05
OBJECTS = (
    scenes.SceneObject(
        name="floor",
        shape=scenes.Rectangle(position=(100.0, 0.0, 0.0), size=(2.0, 2.0)),
        material=scenes.Lambertian(reflectance=0.5),
    ),
    scenes.SceneObject(
        name="prism",
        shape=scenes.Prism(position=(100.0, 0.5, 0.0), apex_deg=50.0, base=0.5, length=1.0),
        material=scenes.Dielectric(medium="N-BK7"),
    ),
)


def build(direction, *, threads=2, radius=RADIUS):
    """Photons of a beam, and their map; the scene is far from the origin."""
    beam = scenes.Beam(
        position=(100.0, 1.0, 0.0), direction=direction, flux=1.0, spectrum="D65",
        profile=scenes.RoundProfile(radius=0.4),
    )
    scene = scenes.Scene(objects=OBJECTS, emitters=(beam,))
    compiled = compile_scene(scene, device=start_device("cpu"))
    lamps = compile_lamps(compiled, scene.film.edges_nm, 70_000)
    receivers = compile_receivers(compiled, lamps, scene.film.edges_nm)
    batch = trace_photons(
        compiled, lamps, seed=0, pass_index=0, max_interactions=64, threads=threads
    )
    return batch, build_photon_map(compiled, batch, receivers, radius, threads=threads)


def in_order(positions):
    return positions[np.lexsort(positions.T)]


@pytest.mark.parametrize("radius", [RADIUS, 1e-4, 50.0])
def test_every_photon_is_there_once(radius):
    batch, photon_map = build((0.0, -1.0, 0.0), radius=radius)
    assert photon_map.photons == len(batch) > 70_000
    held = photon_map.data.position.numpy()[: photon_map.photons] + batch.origin
    np.testing.assert_array_equal(in_order(held), in_order(batch.to_numpy()["position"]))


def test_the_map_is_the_same_for_any_number_of_threads():
    maps = [build((0.0, -1.0, 0.0), threads=threads)[1] for threads in (1, 2, 4)]
    for name in ("position", "weight", "surface", "group", "lamp"):
        arrays = [getattr(one.data, name).numpy() for one in maps]
        np.testing.assert_array_equal(arrays[0], arrays[1])
        np.testing.assert_array_equal(arrays[0], arrays[2])


def test_a_map_without_photons_is_a_map():
    batch, photon_map = build((0.0, 1.0, 0.0))
    assert len(batch) == photon_map.photons == 0
    assert all(len(values) == 0 for values in batch.to_numpy().values())
