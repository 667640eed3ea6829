"""What a disc gathers is added up in double precision, however many photons lie on it."""

import functools

import numpy as np
import pytest
import warp as wp

import scenes
from sim.device import start_device
from sim.image.gather import make_gather
from sim.image.sight import compose_lights, make_lights_struct, make_sight_struct
from sim.photons.lamps import compile_lamps
from sim.photons.photon_batch import PhotonBatch, allocate_photons
from sim.photons.photon_map import build_photon_map
from sim.photons.photon_maps import PhotonMaps
from sim.photons.receivers import compile_receivers
from sim.scene_data import compile_scene
from sim.scene_structs import make_scene_structs

PHOTONS = 300_000
FLUX, REFLECTANCE, RADIUS = 0.7, 0.5, 0.5
FLOOR = 1


def make_scene():
    """A floor under dispersive glass: what is seen through it is gathered band by band."""
    glass = scenes.SceneObject(
        name="glass", material=scenes.Dielectric(medium="F2"),
        shape=scenes.Box(position=(0.0, 1.0, 0.0), size=(3.0, 0.1, 3.0)),
    )
    floor = scenes.SceneObject(
        name="floor", material=scenes.Lambertian(reflectance=REFLECTANCE),
        shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(4.0, 4.0)),
    )
    lamp = scenes.Point(position=(0.0, 2.0, 0.0), flux=FLUX, spectrum="E")
    film = scenes.Film(first_nm=500.0, last_nm=600.0, bands=1)
    return scenes.Scene(objects=(glass, floor), emitters=(lamp,), film=film)


@functools.cache
def make_look(features):
    """Kernel: gather at one point of the floor, in band 0."""
    structs = make_scene_structs("float32")
    scene_type, interaction_type = structs.Scene, structs.Interaction
    lights_type, sight_type = make_lights_struct("float32"), make_sight_struct("float32")
    gather = make_gather("float32", features)

    @wp.kernel(module="unique", enable_backward=False)
    def look(
        scene: scene_type, lights: lights_type, point: wp.vec3, normal: wp.vec3,
        out_sums: wp.array2d(dtype=wp.float64),
    ):
        met = interaction_type()
        met.prim = FLOOR
        met.point = point
        met.normal = normal
        sight = sight_type()
        sight.radius_scale = wp.float32(1.0)
        gather(scene, lights, met, sight, wp.float32(1.0), out_sums)

    return look


@pytest.mark.parametrize("spread", [0.0, RADIUS])
def test_single_precision_gathers_many_photons_without_a_bias(spread):
    # L = Σ k Φ ρ/π over the disc, k = 2/(π r²) (1 − d²/r²). Each term has some ten roundings of
    # 6e-8, which do not grow with how many terms there are.
    scene = make_scene()
    compiled = compile_scene(scene, precision="float32", device=start_device("cpu"))
    edges_nm = np.asarray(scene.film.edges_nm)
    lamps = compile_lamps(compiled, edges_nm, 64)
    receivers = compile_receivers(compiled, lamps, edges_nm)
    centre = compiled.to_local(np.zeros(3))
    place = np.random.default_rng(1).uniform(-spread, spread, (PHOTONS, 3)) * [1.0, 0.0, 1.0]
    position = (centre + place).astype(np.float32)
    photons = allocate_photons("float32", "cpu", PHOTONS)
    photons.position = wp.array(position, dtype=wp.vec3, device="cpu")
    photons.wavelength_nm.fill_(550.0)
    photons.flux.fill_(FLUX / PHOTONS)
    photons.surface.fill_(FLOOR << 14)
    photons.history.fill_(1 << 30 | 2)  # refracted twice, by a dispersive medium
    photons.emitter.zero_()
    batch = PhotonBatch(photons, np.arange(PHOTONS, dtype=np.int32), None, compiled.origin)
    maps = PhotonMaps(build_photon_map(compiled, batch, receivers, RADIUS, threads=2))
    lights = compose_lights("float32", maps, receivers, lamps, direct=False)
    sums = wp.zeros((1, 3), dtype=wp.float64, device="cpu")
    inputs = [compiled.data, lights, wp.vec3(*centre), wp.vec3(0.0, 1.0, 0.0), sums]
    wp.launch(make_look(compiled.features), dim=1, inputs=inputs, device="cpu")
    d2 = np.sum((position.astype(float) - centre.astype(np.float32)) ** 2, axis=1)
    kernel = 2.0 / (np.pi * RADIUS**2) * np.maximum(1.0 - d2 / RADIUS**2, 0.0)
    expected = np.sum(kernel) * FLUX / PHOTONS * REFLECTANCE / np.pi
    assert sums.numpy()[0, 0] == pytest.approx(expected, rel=1e-6)
