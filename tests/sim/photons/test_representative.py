"""Rays for diagrams start on the lamps and go where these shine."""

import numpy as np

import scenes
from sim.photons.representative import representative_rays


def test_rays_start_and_go_as_photons_do(small_scene):
    beam = small_scene.emitters[0]
    origins, directions = representative_rays(small_scene, 50)
    assert origins.shape == directions.shape == (50, 3)
    np.testing.assert_allclose(origins[:, 1], beam.position[1], rtol=1e-12)
    assert np.hypot(origins[:, 0], origins[:, 2]).max() <= beam.profile.radius * (1.0 + 1e-12)
    np.testing.assert_allclose(directions, np.tile([0.0, -1.0, 0.0], (50, 1)), atol=1e-12)


def test_other_seeds_give_other_rays_and_the_same_the_same(small_scene):
    first, again, other = (representative_rays(small_scene, 20, seed)[0] for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_every_lamp_gets_its_share(small_scene):
    lamp = scenes.SphereLamp(position=(9.0, 9.0, 9.0), radius=0.5, flux=1.0, spectrum="D65")
    scene = small_scene.model_copy(update={"emitters": (*small_scene.emitters, lamp)})
    origins, directions = representative_rays(scene, 60)
    from_lamp = np.abs(np.linalg.norm(origins - lamp.position, axis=1) - lamp.radius) < 1e-9
    assert 10 < from_lamp.sum() < 50
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=1e-12)
