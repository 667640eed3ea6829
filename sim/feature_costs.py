"""What features cost: kernel time with each, over the time without it, on one scene.

Two kernels are timed in turn that differ in one feature. Of a feature that the scene does not
require that is the price of carrying idle code; of one that is separable it is the price of what
it does. One that is required and not separable (the ball of `ball`) has no time without it.

One thread, CPU time (`time.process_time`), the median over repeats that are interleaved, so that
a machine that slows down slows both.
"""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import scenes
from sim.features import Build, Feature, FeaturePlan
from sim.image.camera import compile_camera
from sim.image.camera_path import make_render_camera
from sim.image.film import create_film, expose
from sim.image.gather_radius import choose_gather_radius
from sim.image.sight import compose_lights
from sim.image.survey import survey_view
from sim.launch import load_kernels
from sim.photons.lamps import Lamps, compile_lamps
from sim.photons.photon_batch import PhotonBatch
from sim.photons.photon_maps import PhotonMaps, build_photon_maps
from sim.photons.photon_path import make_trace_photons
from sim.photons.receivers import compile_receivers
from sim.photons.tracing import trace_photons
from sim.scene_data import CompiledScene, compile_scene
from sim.settings import ResolvedSettings

__all__ = ["FULL_KERNELS", "measure_costs"]

FULL_KERNELS = {"photons": "full photon kernel", "camera": "full camera kernel"}
"""Names under which the time of everything is told, over that of what the scene requires."""

PHOTONS = 100_000
PIXELS = 96 * 64
REPEATS = 7


def measure_costs(
    plan: FeaturePlan, scene: scenes.Scene, settings: ResolvedSettings, *, device: str,
    each: bool = True,
) -> dict[str, float]:
    """Kernel time with ÷ without each feature that can be timed on this scene, by name.

    And, under `FULL_KERNELS`, that of the full kernels ÷ that of those that the scene requires.

    Args:
        plan: what the scene requires.
        scene: the scene; features of the camera are measured only if it has one.
        settings: of the rendering; its photons, passes and threads do not matter.
        device: where it runs.
        each: whether features are timed one by one; else only the full kernels are.
    """
    build = (settings.precision, plan.features)
    full = (settings.precision, plan.complete("").features)
    ratios: dict[str, float] = {}
    for kernel, everything in FULL_KERNELS.items():
        if kernel == "camera" and scene.camera is None:
            continue
        switched = {
            one.feature.name: (one.on, other)
            for one in plan.decisions
            if each
            and one.feature.kernel == kernel
            and (not one.on or one.feature.separable)
            and (other := _switched(one.feature, build)) is not None
        }
        if full != build:
            switched[everything] = (False, full)
        builds = list(dict.fromkeys([build, *(other for _, other in switched.values())]))
        load_kernels([_kernel(kernel, key) for key in builds], device=device,
                     threads=settings.threads)
        bench = _Bench(scene, settings, device)
        works = bench.exposing(builds) if kernel == "camera" else bench.tracing(builds)
        for name, (on, other) in switched.items():
            here_over_there = _ratio(works[build], works[other])
            ratios[name] = here_over_there if on else 1.0 / here_over_there
    return ratios


def _switched(feature: Feature, build: Build) -> Build | None:
    """The build that differs in this feature; None for one without code of its own."""
    if feature.switch is not None:
        return feature.switch(build)
    if feature.flag is None:
        return None
    precision, features = build
    flags: dict[str, Any] = {feature.flag: not getattr(features, feature.flag)}
    return precision, replace(features, **flags)


def _kernel(kind: str, build: Build) -> Any:
    return (make_render_camera if kind == "camera" else make_trace_photons)(*build)


def _ratio(one: Callable[[], object], other: Callable[[], object]) -> float:
    """Median ratio of their CPU times, in turn; the first round only warms up."""
    ratios = []
    for _ in range(REPEATS + 1):
        times = []
        for work in (one, other):
            start = time.process_time()
            work()
            times.append(time.process_time() - start)
        ratios.append(times[0] / max(times[1], 1e-9))
    return statistics.median(ratios[1:])


@dataclass(frozen=True)
class _Bench:
    """Where pieces of a rendering are set up to be timed, with the kernels of several builds."""

    scene: scenes.Scene
    settings: ResolvedSettings
    device: str

    def tracing(self, builds: list[Build]) -> dict[Build, Callable[[], PhotonBatch]]:
        """For each build, what traces a pass of photons."""
        return {build: self._tracer(build) for build in builds}

    def exposing(self, builds: list[Build]) -> dict[Build, Callable[[], None]]:
        """For each build, what exposes a small film to one and the same pass.

        All builds must have the precision of the first, which traces the pass.
        """
        compiled, lamps = self._compiled(builds[0])
        batch = self._tracer(builds[0])()
        edges_nm = np.asarray(self.scene.film.edges_nm, dtype=np.float64)
        full = self.scene.film
        scale = (PIXELS / (full.width * full.height)) ** 0.5
        sides = {side: max(1, round(scale * getattr(full, side))) for side in ("width", "height")}
        small = full.model_copy(update=sides)
        assert self.scene.camera is not None  # the caller has seen to it
        camera = compile_camera(compiled, self.scene.camera, small)
        survey = survey_view(compiled, camera, float(edges_nm.mean()))
        # From the pixels of the whole film: as many photons as in a rendering lie in a disc.
        radius = choose_gather_radius(compiled, survey, small, self.settings)
        width = radius.median if self.settings.radius else scale * radius.median
        receivers = compile_receivers(compiled, lamps, edges_nm)
        maps = build_photon_maps(
            compiled, batch, receivers, width, seed=0, pass_index=0, threads=1
        )
        direct = self.settings.direct_light == "lamps"
        lights = compose_lights(compiled.precision, maps, receivers, lamps, direct=direct)
        film = create_film(
            edges_nm, len(lamps.spectra), self.device, radius_scale=radius.scale, passes=1
        )

        def exposer(build: Build) -> Callable[[], None]:
            built, _ = self._compiled(build)

            def work(_alive: PhotonMaps = maps) -> None:
                expose(film, built, camera, lights, seed=0, pass_index=0, threads=1)

            return work

        return {build: exposer(build) for build in builds}

    def _compiled(self, build: Build) -> tuple[CompiledScene, Lamps]:
        precision, features = build
        compiled = compile_scene(
            self.scene, precision=precision, device=self.device, features=features
        )
        edges_nm = np.asarray(self.scene.film.edges_nm, dtype=np.float64)
        direct = self.settings.direct_light == "photons"
        return compiled, compile_lamps(compiled, edges_nm, PHOTONS, direct=direct)

    def _tracer(self, build: Build) -> Callable[[], PhotonBatch]:
        compiled, lamps = self._compiled(build)
        return lambda: trace_photons(
            compiled, lamps, seed=0, pass_index=0, threads=1,
            max_interactions=self.settings.max_interactions,
            store_direct=self.settings.direct_light == "photons",
            bounces=self.settings.bounces,
        )
