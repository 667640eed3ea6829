"""Kernels compiled for what a scene requires trace what the full ones trace."""

from dataclasses import replace

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.features import Features
from sim.photons.lamps import compile_lamps
from sim.photons.tracing import trace_photons
from sim.scene_data import compile_scene


def plain():
    """A ball over a floor: nothing touches, absorbs or mirrors."""
    return scenes.Scene(
        objects=(
            scenes.SceneObject(
                name="ball", shape=scenes.Sphere(position=(0, 1, 0), radius=0.5),
                material=scenes.Dielectric(medium="N-BK7"),
            ),
            scenes.SceneObject(
                name="floor", shape=scenes.Rectangle(position=(0, 0, 0), size=(4, 4)),
                material=scenes.Lambertian(reflectance=0.5),
            ),
        ),
        emitters=(scenes.Point(position=(0.2, 3, 0.1), flux=1.0, spectrum="D65"),),
    )  # fmt: skip


def bench():
    """Coloured liquid in glass with a bubble, flush on a floor, beside gold and a mirror."""
    dyed = scenes.NapierianAbsorption(
        coefficient=scenes.CoefficientTable(wavelength_nm=(300.0, 900.0), values=(0.1, 4.0))
    )
    table = scenes.ReflectanceTable(wavelength_nm=(400.0, 700.0), values=(0.3, 0.9))
    parts = (
        ("glass", scenes.Box(position=(0, 0.5, 0), size=(1, 1, 1)),
         scenes.Dielectric(medium="N-BK7")),
        ("liquid", scenes.Box(position=(0, 0.6, 0), size=(0.8, 0.8, 0.8)),
         scenes.Dielectric(medium="water", absorption=dyed, priority=1)),
        ("bubble", scenes.Sphere(position=(0, 0.6, 0), radius=0.2),
         scenes.Dielectric(medium="air", priority=2)),
        ("gold", scenes.Sphere(position=(1.2, 0.5, 0), radius=0.4), scenes.Metal(metal="gold")),
        ("mirror", scenes.Rectangle(position=(-1.2, 0.6, 0), size=(1, 1), normal=(1, 0.2, 0)),
         scenes.Mirror(reflectance=table)),
        ("floor", scenes.Rectangle(position=(0, 0, 0), size=(5, 5)),
         scenes.Lambertian(reflectance=0.5)),
    )  # fmt: skip
    objects = [
        scenes.SceneObject(name=name, shape=shape, material=paint) for name, shape, paint in parts
    ]
    lamp = scenes.Point(position=(0.2, 3, 0.1), flux=1.0, spectrum="D65")
    return scenes.Scene(objects=objects, emitters=(lamp,))


def pond():
    """Waves on water that lies on its bed, of triangles both."""
    wave = scenes.Wave(amplitude=0.03, period=0.7, direction_deg=20)
    grid = {"position": (0, 0.5, 0), "size": (2, 2), "cells": (24, 24), "waves": [wave]}
    bed = scenes.HeightField(position=(0, 0, 0), size=(2, 2), heights=((0.0,) * 3,) * 3)
    objects = (
        scenes.SceneObject(
            name="water", shape=scenes.HeightField(depth=0.5, **grid),
            material=scenes.Dielectric(medium="water"),
        ),
        scenes.SceneObject(name="bed", shape=bed, material=scenes.Lambertian(reflectance=0.5)),
    )  # fmt: skip
    lamp = scenes.Point(position=(0.2, 3, 0.1), flux=1.0, spectrum="D65")
    return scenes.Scene(objects=objects, emitters=(lamp,))


@pytest.mark.parametrize(
    ("make", "lacks"),
    [
        (plain, ("interfaces", "absorption", "finishes", "polyhedra", "lenses", "tabulated",
                 "meshes")),
        (bench, ("lenses", "meshes", "tabulated", "air_conversion")),
        (pond, ("spheres", "flats", "polyhedra", "lenses", "absorption", "finishes")),
    ],
)
def test_photons_are_the_full_kernels(make, lacks):
    scene, device = make(), start_device("cpu")
    batches = []
    for full in (False, True):
        compiled = compile_scene(scene, device=device)
        if full:
            everything = replace(Features(), media_count=compiled.features.media_count)
            assert not any(getattr(compiled.features, flag) for flag in lacks)
            assert all(getattr(everything, flag) for flag in lacks)
            compiled = compile_scene(scene, device=device, features=everything)
        lamps = compile_lamps(compiled, scene.film.edges_nm, 20_000)
        batches.append(trace_photons(
            compiled, lamps, seed=3, pass_index=0, max_interactions=256, threads=2
        ))  # fmt: skip
    ours, theirs = (batch.to_numpy() for batch in batches)
    assert len(ours["flux"]) == len(theirs["flux"]) > 5000
    for name in ("object", "face", "side", "refractions", "reflections", "dispersed"):
        np.testing.assert_array_equal(ours[name], theirs[name])
    # Compilers may join products and sums otherwise where there is more code around them: a few
    # ulps, which curved surfaces enlarge from one to the next.
    np.testing.assert_allclose(ours["position"], theirs["position"], rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours["flux"], theirs["flux"], rtol=1e-9)
    for batch in batches:
        assert abs(batch.books.residual) < 1e-12
    for column in ("emitted", "deposited", "absorbed", "escaped"):
        one, other = (getattr(batch.books, column) for batch in batches)
        assert one == pytest.approx(other, rel=1e-9)
