"""In which media sensors lie, and what coloured ones leave for them."""

import numpy as np
import pytest

import scenes
from sim.sensors.media import media_at

ALPHA_PER_M = 20.0
HEIGHT = 0.2
"""Of a slab of dark glass, its lower face at y = 0 [m]."""


def slab(eta):
    """A slab that absorbs."""
    medium = scenes.ConstantMedium(eta=eta)
    absorption = scenes.NapierianAbsorption(coefficient=ALPHA_PER_M)
    return scenes.SceneObject(
        name="slab",
        shape=scenes.Box(position=(0.0, 0.5 * HEIGHT, 0.0), size=(1.0, HEIGHT, 1.0)),
        material=scenes.Dielectric(medium=medium, absorption=absorption),
    )


def level(height, *, normal=(0.0, 1.0, 0.0), side=0.2, name=""):
    shape = scenes.Rectangle(position=(0.0, height, 0.0), size=(side, side), normal=normal)
    return scenes.IrradianceSensor(name=name or f"level {height:g}", shape=shape, pixels=(2, 2))


BALL = scenes.SceneObject(
    name="ball", shape=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.1),
    material=scenes.Dielectric(medium="N-BK7"),
)
POOL = scenes.SceneObject(
    name="pool",
    shape=scenes.HeightField(
        position=(0.0, 0.0, 0.0), size=(1.0, 1.0), heights=((0.0, 0.1), (0.0, 0.1)), depth=0.2
    ),
    material=scenes.Dielectric(medium="water"),
)
"""Its surface rises from y = 0 to 0.1 along x."""
BUBBLE = scenes.SceneObject(
    name="bubble", shape=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.05),
    material=scenes.Dielectric(medium="air", priority=1),
)


@pytest.mark.parametrize(
    ("objects", "sensor", "media"),
    [
        ((BALL,), level(0.5), ("reference",)),
        ((BALL,), level(0.0, side=0.1), ("N-BK7",)),
        ((BALL,), level(0.0, side=0.5), ("N-BK7", "reference")),
        ((BALL, BUBBLE), level(0.0, side=0.05), ("air",)),
        ((BUBBLE, BALL), level(0.0, side=0.12), ("air", "N-BK7")),
        ((POOL,), level(0.02), ("water",)),
        ((POOL,), level(0.09), ("reference",)),
        ((POOL,), level(0.049, side=0.9), ("water", "reference")),
        ((POOL,), level(-0.3), ("reference",)),
        ((POOL,), level(0.02, side=3.0), ("water", "reference")),
    ],
)
def test_the_media_have_names(objects, sensor, media):
    assert media_at(scenes.Scene(objects=objects, sensors=(sensor,)), sensor) == media


def test_flush_with_a_face_it_is_what_the_front_looks_into():
    box = BALL.model_copy(
        update={"shape": scenes.Box(position=(0.0, 0.0, 0.0), size=(0.2, 0.2, 0.2))}
    )
    for normal, medium in (((0.0, 1.0, 0.0), "reference"), ((0.0, -1.0, 0.0), "N-BK7")):
        sensor = level(0.1, normal=normal)
        assert media_at(scenes.Scene(objects=(box,), sensors=(sensor,)), sensor) == (medium,)


def test_an_ambient_medium_is_named():
    sensor = level(0.5)
    assert media_at(scenes.Scene(ambient="water", sensors=(sensor,)), sensor) == ("water",)
    assert media_at(scenes.Scene(ambient="air", sensors=(sensor,)), sensor) == ("air",)


DEPTHS = (0.0, 0.05, 0.1, HEIGHT)


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_sensors_in_dark_glass_get_what_it_leaves(trace_crossings, precision):
    # Index 1 reflects nothing: after the depth d, Φ exp(−α d) is left (Beer and Lambert), and
    # below the slab as much as at its lower face.
    sensors = tuple(level(HEIGHT - depth) for depth in (*DEPTHS, HEIGHT + 0.1))
    lamp = scenes.Beam(
        position=(0.0, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=1.0, spectrum="E",
        profile=scenes.RoundProfile(radius=0.05),
    )
    scene = scenes.Scene(objects=(slab(1.0),), emitters=(lamp,), sensors=sensors)
    batch = trace_crossings(scene, photons=1000, precision=precision)
    bins = scene.film.bands * 4
    flux = batch.crossings.flux.reshape(len(sensors), bins).sum(axis=1) / batch.books.emitted
    left = np.exp(-ALPHA_PER_M * np.array([*DEPTHS, HEIGHT]))
    # ulps of α d and of the exponential, and of the heights.
    np.testing.assert_allclose(flux, left, rtol=1e-12 if precision == "float64" else 3e-6)
