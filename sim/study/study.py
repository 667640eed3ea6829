"""The study: calibrate, run every point, find the references, and compare."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

import scenes
import sim.study.standard_axes as standard
from sim.photons.photon_batch import PhotonBatch
from sim.settings import RenderSettings
from sim.study.comparison import compare_point, compared
from sim.study.expected_slope import sampled_dimensions
from sim.study.glass_chain import GlassChain, find_chain
from sim.study.outcome import LADDER, PLAIN_LADDER, Outcome, PhotonNoise
from sim.study.picture_reference import picture_reference
from sim.study.plan import CENTRE, Plan, Point, make_points, photon_scale, turns_of_points, work_of
from sim.study.references import Reference, bins_reference, mesh_reference
from sim.study.sample import Sample
from sim.study.setup import RESULTS, ResultKind, SeedSource, Setup
from sim.study.workshop import Workshop

__all__ = ["Tell", "run_study"]

FloatArray = npt.NDArray[np.float64]

Tell = Callable[[str], None]
"""Told, in a few words, what the study does."""

SMALLEST_GOAL = 1e-6


@dataclass
class _Bundle:
    """A point with its replicates."""

    point: Point
    samples: list[Sample] = field(default_factory=list)


def run_study(scene: scenes.Scene, plan: Plan, *, seed: int, threads: int, tell: Tell) -> Outcome:
    """Measure what each choice costs and what it gains.

    Args:
        scene: with a camera, an emitter and a receiver.
        plan: what to spend.
        seed: the first of the seeds; every run takes one of its own.
        threads: CPU threads.
        tell: hears of progress.

    Raises:
        scenes.SceneError: the scene lacks what a picture needs.
        SettingsError: the camera sees no receiver, and the scene sets no gather radius.
    """
    scene.require_renderable()
    start = time.process_time()
    workshop = Workshop(threads=threads, rows=plan.rows)
    seeds = SeedSource(seed)
    tell("compile")
    centre = Setup(scene, RenderSettings(threads=threads).resolved(scene))
    workshop.load([centre])
    workshop.radius(centre)  # refuses a view of no receiver now, not after the first points
    workshop.chain = find_chain(
        scene, _pilot(workshop, centre, seeds.take()), cells=plan.cells, bands=plan.bands
    )
    results: tuple[ResultKind, ...] = RESULTS if workshop.chain else ("picture",)
    default = centre.settings
    centre, scale = _calibrated(workshop, centre, plan, results, seeds, tell)
    points = make_points(centre, plan, results)
    mesh = None
    if workshop.chain is not None:
        tell("caustic mesh")
        mesh = mesh_reference(workshop, centre, goal=1e-4, cpu_s=plan.mesh_s)
        if mesh is None:
            points = [point for point in points if point.setup.estimator != "mesh"]
        else:
            workshop.target = mesh.target
            workshop.mesh_nodes = mesh.resolution.wavelengths, mesh.resolution.lamp_points
    _warm(workshop, points, seeds, tell)
    bundles = _run_points(workshop, points, plan, seeds, tell)
    photon_noise = _photon_noise(workshop, points, plan, seeds, tell)
    references: dict[ResultKind, Reference] = {}
    tell("reference of the picture")
    goal = _goal(bundles, "picture")
    references["picture"] = picture_reference(
        workshop, centre, seeds, goal=goal, cpu_s=plan.picture_s
    )
    if workshop.chain is not None:
        tell("reference of the bins")
        references["bins"] = bins_reference(
            workshop, centre, seeds, mesh=mesh, goal=_goal(bundles, "bins"), cpu_s=plan.bins_s
        )
    tell("compare")
    rows = [
        compare_point(
            bundle.point, bundle.samples, result, references[result], workshop.chain, scene
        )
        for result in results
        for bundle in bundles
        if result in bundle.point.results
    ]
    exposed = len(workshop.exposed_rows(scene.film)) / scene.film.height
    return Outcome(
        scene=scene.source_name, title=scene.title, plan=plan,
        cpu_s=time.process_time() - start, scale=scale,
        default_photons=int(default.photons or 1), default_passes=int(default.passes or 1),
        coverage=exposed, bins_text=_bins_text(workshop.chain), rows=tuple(rows),
        references=references, photon_noise=photon_noise,
        dimensions=_dimensions(scene, workshop.chain),
    )


def _pilot(workshop: Workshop, centre: Setup, seed: int) -> PhotonBatch:
    """Photons that show where light goes, and are not used again."""
    return workshop.trace(centre, workshop.lamps(centre, seed), seed, 0)


def _calibrated(
    workshop: Workshop, centre: Setup, plan: Plan, results: tuple[ResultKind, ...],
    seeds: SeedSource, tell: Tell,
) -> tuple[Setup, float]:
    """The centre with as many of the scene's photons as the time allows, and how many."""
    tell("calibrate")
    few = standard.at_photons(centre, 1 / 64)
    workshop.run(few, seeds.take(), results)  # What is done only once is done now.
    seconds = []
    for setup in (few, centre):
        began = time.process_time()
        workshop.run(setup, seeds.take(), results)
        seconds.append(time.process_time() - began)
    points = make_points(centre, plan, results)
    scale = photon_scale(plan, work_of(points), len(points), seconds[0], seconds[1] - seconds[0])
    return standard.at_photons(centre, scale), scale


def _warm(workshop: Workshop, points: list[Point], seeds: SeedSource, tell: Tell) -> None:
    """Compile every kernel and run it once, so that no measurement pays for it."""
    tell("compile")
    workshop.load(point.setup for point in points)
    seen = set()
    for point in points:
        setup = point.setup
        key = (id(setup.scene), setup.settings.precision, setup.method, setup.estimator)
        if key not in seen and setup.estimator != "mesh":
            seen.add(key)
            photons = min(2000, int(setup.settings.photons or 1))
            small = setup.with_settings(photons=photons, passes=1)
            workshop.run(small, seeds.take(), point.results)


def _run_points(
    workshop: Workshop, points: list[Point], plan: Plan, seeds: SeedSource, tell: Tell
) -> list[_Bundle]:
    """Every point, as often as planned, each time with a seed of its own."""
    bundles = {id(point): _Bundle(point) for point in points}
    turns = list(turns_of_points(plan.replicates, points))
    for done, (replicate, point) in enumerate(turns):
        name = f"replicate {replicate + 1}: {point.axis} {point.value}"
        tell(f"run {done + 1} of {len(turns)}, {name}")
        sample = workshop.run(point.setup, seeds.take(), point.results)
        bundles[id(point)].samples.append(sample)
    return list(bundles.values())


def _photon_noise(
    workshop: Workshop, points: list[Point], plan: Plan, seeds: SeedSource, tell: Tell
) -> list[PhotonNoise]:
    """Noise of the picture's luminance along the photons' ladders, with the camera held still.

    All of these runs share the camera's random numbers, and with them its noise, so that what is
    left between them is the photons'.
    """
    camera_seed = seeds.take()
    replicates = plan.replicates
    found = []
    for point in points:
        if point.axis not in (CENTRE, LADDER, PLAIN_LADDER) or "picture" not in point.results:
            continue
        tell(f"photons' part of the noise: {point.axis} {point.value}")
        colours = []
        for _ in range(replicates):
            sample = workshop.run(point.setup, seeds.take(), ("picture",), camera_seed=camera_seed)
            colours.append(compared(sample, "picture"))
        mean = np.mean(colours, axis=0)
        square = float(np.sum(mean**2))
        if square == 0.0:  # So few photons that no pixel has met one.
            continue
        off = np.array([np.sum((one - mean) ** 2) for one in colours]) / square
        found.append(
            PhotonNoise(
                point.axis == PLAIN_LADDER, int(point.setup.settings.photons or 1),
                int(point.setup.settings.passes or 1), off * replicates / (replicates - 1.0),
            )
        )
    return sorted(found, key=lambda one: (one.plain, one.photons))


def _dimensions(scene: scenes.Scene, chain: GlassChain | None) -> dict[ResultKind, int]:
    """What theory expects slopes by: of the bins' lamp, and of the picture's hardest one."""
    shining = [
        one.name for one in scene.emitters
        if one.emission().band_flux(scene.film.edges_nm).any()
    ]
    found: dict[ResultKind, int] = {
        "picture": max(sampled_dimensions(scene, name) for name in shining)
    }
    if chain is not None:
        found["bins"] = sampled_dimensions(scene, chain.emitter)
    return found


def _goal(bundles: list[_Bundle], result: ResultKind) -> float:
    """A tenth of the smallest noise of any point, which no reference is needed to know."""
    smallest = min(
        (_noise(bundle, result) for bundle in bundles if result in bundle.point.results
         and len(bundle.samples) > 1),
        default=1.0,
    )
    return max(0.1 * smallest, SMALLEST_GOAL)


def _noise(bundle: _Bundle, result: ResultKind) -> float:
    values = [compared(sample, result) for sample in bundle.samples]
    mean = np.mean(values, axis=0)
    square = float(np.sum(mean**2))
    return float(np.sqrt(np.sum(np.var(values, axis=0, ddof=1)) / square)) if square else 1.0


def _bins_text(chain: GlassChain | None) -> str:
    if chain is None:
        return "No lamp's light reaches a rectangle through glass by refraction alone."
    bins, edges = chain.bins, chain.edges_nm
    return (
        f"Light of '{chain.emitter}' on '{chain.receiver}' after {chain.refractions} refractions "
        f"and nothing else, in {bins.columns} × {bins.rows} bins of "
        f"{1e3 * bins.bin_size[0]:.3g} × {1e3 * bins.bin_size[1]:.3g} mm and "
        f"{len(edges) - 1} bands from {edges[0]:g} to {edges[-1]:g} nm"
    )
