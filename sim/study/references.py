"""What a study's errors are measured against, and how that is known to be right.

The bins' reference is a caustic mesh, refined while its time lasts, or the mean of large passes of
photons, whichever states the smaller error: the mesh's comes from halving it, the photons' from
the scatter of passes, and where both are there, their distance checks one against the other.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

import scenes
from sim.errors import SettingsError
from sim.study.caustic_mesh import CausticMesh, Resolution, trace_caustic_mesh
from sim.study.glass_chain import GlassChain, bin_chain, select_chain
from sim.study.metrics import relative_l2
from sim.study.setup import SeedSource, Setup
from sim.study.workshop import Workshop

__all__ = [
    "FEWEST",
    "MESH",
    "MeshReference",
    "Reference",
    "bins_reference",
    "mean_and_noise",
    "mesh_reference",
]

FloatArray = npt.NDArray[np.float64]

PASS_PHOTONS = 1 << 20
"""Photons in a pass of a reference: long sequences are worth more than many."""

MESH = "caustic mesh"
"""Kind of a reference by a mesh."""

FEWEST = 4
"""Replicates of a reference, at least."""

COARSEST = Resolution(cells=16, wavelengths=2, lamp_points=2)


@dataclass(frozen=True, eq=False)
class Reference:
    """What is taken for the truth.

    Attributes:
        values: the bins' irradiance, or the picture's XYZ.
        kind: "caustic mesh", "photons" or "long run".
        noise: relative L2 error by chance, of the bins or of the luminance.
        bias: relative L2 error that more of the same would not take away.
        how: how its error is known, in a sentence.
        check: how it compares with another reference; empty without one.
    """

    values: FloatArray
    kind: str
    noise: float
    bias: float
    how: str
    check: str = ""

    @property
    def error(self) -> float:
        """Noise and bias together."""
        return math.hypot(self.noise, self.bias)

    @property
    def variance(self) -> float:
        """What its noise adds to every squared error."""
        return self.noise**2


@dataclass(frozen=True, eq=False)
class MeshReference:
    """A mesh as fine as its time allowed, and around which object it is laid."""

    mesh: CausticMesh
    target: str
    resolution: Resolution


def mesh_reference(
    workshop: Workshop, setup: Setup, *, goal: float, cpu_s: float
) -> MeshReference | None:
    """Refine a caustic mesh where its error is largest, until it is small or time is up.

    Args:
        workshop: which has found a chain.
        setup: with the scene, in double precision.
        goal: relative error that is small enough.
        cpu_s: time to spend, in CPU-seconds.

    Returns:
        The mesh, or None if there is no object that it can be laid around.
    """
    chain = workshop.chain
    assert chain is not None
    compiled = workshop.bench(setup).compiled

    def trace(target: str, resolution: Resolution) -> CausticMesh:
        return trace_caustic_mesh(
            compiled, chain.bins, emitter=chain.emitter, target=target, edges_nm=chain.edges_nm,
            branches=("refract",) * chain.refractions, resolution=resolution,
        )

    start = time.process_time()
    found = _first_mesh(setup.scene, trace)
    if found is None:
        return None
    best, last = found, time.process_time() - start
    while best.mesh.relative_error > goal:
        resolution, factor = _refined(best)
        if time.process_time() - start + factor * last > cpu_s:
            break
        began = time.process_time()
        best = MeshReference(trace(best.target, resolution), best.target, resolution)
        last = time.process_time() - began
    return best


def _first_mesh(
    scene: scenes.Scene, trace: Callable[[str, Resolution], CausticMesh]
) -> MeshReference | None:
    """The coarsest mesh around whichever object most light passes first."""
    best: MeshReference | None = None
    for item in scene.objects:
        if not isinstance(item.material, scenes.Dielectric) or item.name is None:
            continue
        try:
            mesh = trace(item.name, COARSEST)
        except SettingsError:  # Such as a lamp within the object's bounding sphere.
            continue
        if mesh.landed > 0.0 and (best is None or mesh.landed > best.mesh.landed):
            best = MeshReference(mesh, item.name, COARSEST)
    return best


def _refined(mesh: MeshReference) -> tuple[Resolution, float]:
    """The resolution with twice as many of what errs most, and what it costs in comparison."""
    parts = {
        "cells": mesh.mesh.mesh_error,
        "wavelengths": mesh.mesh.wavelength_error,
        "lamp_points": mesh.mesh.lamp_error,
    }
    worst = max(parts, key=lambda name: parts[name])
    finer = replace(mesh.resolution, **{worst: 2 * getattr(mesh.resolution, worst)})
    return finer, {"cells": 4.5, "wavelengths": 2.0, "lamp_points": 3.5}[worst]


def bins_reference(
    workshop: Workshop,
    setup: Setup,
    seeds: SeedSource,
    *,
    mesh: MeshReference | None,
    goal: float,
    cpu_s: float,
) -> Reference:
    """The bins' reference: mesh or photons.

    Args:
        workshop: which has found a chain.
        setup: what the reference is of; its photons are not those that are used.
        seeds: none of which an estimate uses.
        mesh: the mesh, if there is one.
        goal: relative error that is small enough.
        cpu_s: time for photons, in CPU-seconds.
    """
    chain = workshop.chain
    assert chain is not None
    by_mesh = None if mesh is None else _of_mesh(mesh)
    if by_mesh is not None and by_mesh.error <= goal:
        return by_mesh
    by_photons = _of_photons(workshop, setup, seeds, chain, goal, cpu_s)
    if by_mesh is None:
        return by_photons
    distance = relative_l2(by_mesh.values, by_photons.values)
    stated = math.hypot(by_mesh.error, by_photons.error)
    check = (
        f"Caustic mesh (error stated {by_mesh.error:.2g}) and photons ({by_photons.error:.2g}) "
        f"are {distance:.2g} apart; their errors together are {stated:.2g}."
    )
    better = by_mesh if by_mesh.error < by_photons.error else by_photons
    return replace(better, check=check)


def _of_mesh(found: MeshReference) -> Reference:
    mesh, resolution = found.mesh, found.resolution
    how = (
        f"a mesh of {resolution.cells}² cells a chart around '{found.target}', "
        f"{resolution.wavelengths} wavelengths a band and {resolution.lamp_points} points along "
        f"the lamp; halving each tells its error: cells {mesh.mesh_error:.2g}, wavelengths "
        f"{mesh.wavelength_error:.2g}, lamp {mesh.lamp_error:.2g}"
    )
    return Reference(mesh.irradiance, MESH, 0.0, mesh.relative_error, how)


def _of_photons(
    workshop: Workshop,
    setup: Setup,
    seeds: SeedSource,
    chain: GlassChain,
    goal: float,
    cpu_s: float,
) -> Reference:
    """Passes of many photons, until their mean is good or time is up."""
    photons = max(PASS_PHOTONS, int(setup.settings.photons or 1))
    large = setup.with_settings(photons=photons)
    start, passes = time.process_time(), []
    lamps = workshop.lamps(large, seeds.take())
    while True:
        batch = workshop.trace(large, lamps, seeds.take(), 0)
        passes.append(bin_chain(select_chain(batch, chain), chain))
        mean, noise = mean_and_noise(passes)
        done = noise <= goal or time.process_time() - start > cpu_s
        if len(passes) >= FEWEST and done:
            break
    how = (
        f"{len(passes)} independent passes of {photons:,} photons, with other seeds than any "
        "estimate; the scatter of the passes tells the error of their mean"
    )
    return Reference(mean, "photons", noise, 0.0, how)


def mean_and_noise(replicates: list[FloatArray]) -> tuple[FloatArray, float]:
    """The mean of replicates, and its relative L2 noise; infinite from a single one."""
    mean: FloatArray = np.mean(replicates, axis=0)
    n = len(replicates)
    if n < 2:
        return mean, math.inf
    scatter = sum(float(np.sum((one - mean) ** 2)) for one in replicates)
    return mean, math.sqrt(scatter / (n * (n - 1)) / float(np.sum(mean**2)))
