"""The photon map's grid with every photon in one cell, one a cell, or all in one place."""

import functools

import numpy as np
import pytest
import warp as wp
from scipy.spatial import cKDTree

import scenes
from sim.device import start_device
from sim.photons.energy import EnergyBooks
from sim.photons.lamps import compile_lamps
from sim.photons.photon_batch import PhotonBatch, allocate_photons
from sim.photons.photon_map import build_photon_map, make_map_structs
from sim.photons.receivers import compile_receivers
from sim.precision import precision_types
from sim.scene_data import compile_scene

COUNT = 512


@functools.cache
def make_count(precision):
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3
    map_type = make_map_structs(precision).Map

    @wp.kernel(module=f"tests_extreme_grid_{precision}", enable_backward=False)
    def count(photons: map_type, places: wp.array(dtype=vec3), out: wp.array(dtype=int)):
        """Photons within the radius of each place, as a gather finds them."""
        i = wp.tid()
        query = wp.hash_grid_query(photons.grid, places[i], photons.radius)
        candidate = wp.int32(0)
        found = wp.int32(0)
        inverse = real(1.0) / (photons.radius * photons.radius)
        while wp.hash_grid_query_next(query, candidate):
            offset = photons.position[candidate] - places[i]
            if wp.dot(offset, offset) * inverse < real(1.0):
                found += 1
        out[i] = found

    return count


@pytest.fixture(scope="module")
def stage():
    """A floor, and what else a map is built with, by precision."""
    floor = scenes.SceneObject(
        name="floor", shape=scenes.Rectangle(position=(0, 0, 0), size=(2.0, 2.0)),
        material=scenes.Lambertian(reflectance=0.5),
    )  # fmt: skip
    lamp = scenes.Point(position=(0, 1, 0), flux=1.0, spectrum="E")
    scene = scenes.Scene(objects=(floor,), emitters=(lamp,))
    found = {}
    for precision in ("float64", "float32"):
        compiled = compile_scene(scene, precision=precision, device=start_device("cpu"))
        lamps = compile_lamps(compiled, scene.film.edges_nm, 100)
        found[precision] = compiled, compile_receivers(compiled, lamps, scene.film.edges_nm)
    return found


def mapped(stage, precision, places, radius):
    """A map of photons at these places (n, 3), and what it counts around each of them."""
    compiled, receivers = stage[precision]
    n = len(places)
    photons = allocate_photons(precision, "cpu", n)
    for name in ("direction", "flux", "surface", "history", "emitter"):
        getattr(photons, name).zero_()
    photons.wavelength_nm.fill_(550.0)
    photons.position.assign(places.astype(precision))
    zero = EnergyBooks(0.0, 0.0, 0.0, 0.0, 0.0)
    batch = PhotonBatch(photons, np.arange(n, dtype=np.int32), zero, np.zeros(3))
    built = build_photon_map(compiled, batch, receivers, radius, threads=2)
    assert built.photons == n
    vec3 = precision_types(precision).vec3
    out = wp.zeros(n, dtype=int, device="cpu")
    rounded = wp.array(places.astype(precision), dtype=vec3, device="cpu")
    wp.launch(make_count(precision), dim=n, inputs=[built.data, rounded, out], device="cpu")
    # In the grid's order each photon is there once.
    held = np.sort(built.data.position.numpy().view(precision).reshape(n, 3), axis=0)
    np.testing.assert_array_equal(held, np.sort(places.astype(precision), axis=0))
    return out.numpy()


def by_tree(places, radius, precision):
    """How many lie within the radius of each, the fewest and the most as rounding has it."""
    exact = places.astype(precision).astype(np.float64)
    tree = cKDTree(exact)
    slack = 8.0 * float(np.finfo(precision).eps)
    return [
        np.array([len(one) for one in tree.query_ball_point(exact, radius * (1.0 + sign * slack))])
        for sign in (-1.0, 1.0)
    ]


def scattered(size, seed=61):
    places = np.random.default_rng(seed).uniform(-0.5, 0.5, (COUNT, 3)) * size
    places[:, 1] = 0.0
    return places


@pytest.mark.parametrize(
    "radius", [1e-7, 1e-5, 1e-3, 0.03, 0.3, 1.4, 2.0, 1e3]
)
def test_neighbours_are_found_from_one_photon_a_cell_to_all_in_one(stage, precision, radius):
    places = scattered(1.0)
    found = mapped(stage, precision, places, radius)
    fewest, most = by_tree(places, radius, precision)
    assert np.all((found >= fewest) & (found <= most))
    assert found.min() >= 1


def test_radii_of_an_ulp_find_each_photon_itself(stage, precision):
    # Cells without number: coordinates that are past 2³¹ of them are clamped, and are still found.
    radius = 2.0 * float(np.finfo(precision).eps)
    places = scattered(1.0)
    found = mapped(stage, precision, places, radius)
    fewest, most = by_tree(places, radius, precision)
    assert np.all((found >= np.maximum(fewest, 1)) & (found <= most))


@pytest.mark.parametrize("radius", [1e-9, 1e-3, 1.0])
@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (0.7, 0.0, -0.3), (-0.999, 0.0, 0.999)])
def test_all_photons_in_one_place_are_all_found(stage, precision, radius, place):
    found = mapped(stage, precision, np.tile(np.array(place), (COUNT, 1)), radius)
    np.testing.assert_array_equal(found, COUNT)


@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_small_and_large_maps_are_found_alike(stage, precision, size):
    near = mapped(stage, precision, scattered(1.0), 0.1)
    found = mapped(stage, precision, scattered(1.0) * size, 0.1 * size)
    # Rounding may leave one on the other side of a radius now and then.
    assert np.count_nonzero(found != near) <= 2
