"""What tests of several packages share: a small scene, and a picture that was not rendered."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

if TYPE_CHECKING:
    from scenes import Scene
    from sim import Picture

SMALL_SCENE = """\
title = "A small scene: a beam through a ball of glass onto a floor"

[film]
width = 12
height = 8
bands = 4
first_nm = 430
last_nm = 670

[camera]
position = [0.0, 2.0, 4.0]
look_at = [0.0, 0.5, 0.0]
fov_deg = 40.0

[render]
photons = 2000
passes = 2

[[objects]]
name = "ball"
shape = {type = "sphere", position = [0.0, 1.0, 0.0], radius = 0.5}
material = {type = "dielectric", medium = "N-BK7"}

[[objects]]
name = "floor"
shape = {type = "rectangle", position = [0.0, 0.0, 0.0], size = [4.0, 4.0]}
material = {type = "lambertian", reflectance = 0.8}

[[emitters]]
name = "lamp"
type = "beam"
position = [0.0, 3.0, 0.0]
direction = [0.0, -1.0, 0.0]
profile = {type = "round", radius = 0.4}
flux = 1.0
spectrum = "D65"
"""


@pytest.fixture(scope="session")
def small_scene() -> Scene:
    import scenes

    return scenes.loads(SMALL_SCENE, name="small")


@pytest.fixture
def synthetic_picture(small_scene: Scene) -> Picture:
    """A picture of made-up numbers, different in every pixel and band, not all of them in gamut."""
    from sim.image.picture import Picture
    from sim.photons.energy import EnergyBooks
    from sim.settings import RenderSettings

    film = small_scene.film
    shape = (film.height, film.width, film.bands)
    radiance = np.random.default_rng(7).exponential(1e-3, shape)
    radiance[0, 0] = [0.0, 2e-3, 0.0, 0.0]  # One band alone: outside the sRGB gamut.
    radiance[0, 1] = 0.0
    energy = EnergyBooks(emitted=1.0, deposited=0.7, absorbed=0.1, escaped=0.15, culled=0.05)
    return Picture(
        spectral_radiance=radiance,
        standard_error=0.1 * radiance,
        edges_nm=film.edges_nm,
        energy=energy,
        scene=small_scene,
        settings=RenderSettings(seed=5).resolved(small_scene),
        timings={"trace": 1.5, "gather": 0.5},
    )
