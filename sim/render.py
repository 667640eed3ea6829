"""Render a scene: the algorithm, top down.

A pass is a pure function of the compiled scene, the settings and the pass's index: it emits
photons, builds one photon map, and exposes the film once. Passes are independent and averaged,
so their spread is the picture's standard error. The gather radius shrinks from pass to pass.
"""

import threading
from collections.abc import Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np

import scenes
from scenes.emitters import DistantEmitter
from sim.canary import choose_kernels
from sim.device import start_device
from sim.errors import SettingsError
from sim.features import Features
from sim.image.camera import compile_camera
from sim.image.camera_path import make_render_camera
from sim.image.film import Film, create_film, expose
from sim.image.gather_radius import GatherRadius, choose_gather_radius
from sim.image.picture import Picture
from sim.image.sight import compose_lights
from sim.image.survey import Survey, make_measure_footprints, survey_view
from sim.launch import load_kernels
from sim.memory.estimate import require_memory
from sim.photons.energy import EnergyBooks
from sim.photons.guided_lamps import compile_guided_lamps
from sim.photons.lamps import Lamps, compile_lamps
from sim.photons.photon_map import make_collect, make_reorder
from sim.photons.photon_maps import PhotonMaps, build_photon_maps
from sim.photons.photon_path import make_trace_photons
from sim.photons.pilot import make_retrace_emission
from sim.photons.receivers import compile_receivers
from sim.photons.tracing import trace_photons
from sim.progress import ProgressCallback
from sim.resumption.checkpoint import Checkpoint
from sim.resumption.fingerprint import fingerprint_of
from sim.resumption.run_state import RunState
from sim.scene_data import CompiledScene
from sim.sensors.origin import Origin
from sim.sensors.pass_crossings import PassCrossings
from sim.sensors.readings import read_sensors
from sim.sensors.sensor_bank import SensorBank, compile_sensors
from sim.sensors.tally import SensorTally
from sim.settings import RenderSettings, ResolvedSettings
from sim.stopping import StopRule
from sim.stopwatch import Stopwatch

__all__ = ["compile_lamps_for", "kernels_of", "render"]


def render(
    scene: scenes.Scene,
    settings: RenderSettings | None = None,
    *,
    progress: ProgressCallback | None = None,
    checkpoint: Checkpoint | None = None,
) -> Picture:
    """Render `scene` to spectral radiance.

    Args:
        scene: with a camera, at least one emitter, and at least one diffuse object.
        settings: what to spend; by default the scene's own settings.
        progress: told how far the run is, some times a second.
        checkpoint: where the run's state is kept, and from where it goes on; None: nowhere.

    Returns:
        The picture: band means with their standard error, and where the energy went.

    Raises:
        scenes.SceneError: the scene lacks something that a picture needs.
        SettingsError: the gather radius, or the precision, does not do for this scene.
        DeviceError: the device does not exist.
        CapacityError: there is not enough memory for it.
        CheckpointError: the checkpoint is of another run; says what differs.
        KeyboardInterrupt: on Ctrl-C, within a fraction of a second.
    """
    scene.require_renderable()
    plan = (settings or RenderSettings()).resolved(scene)
    if checkpoint is not None:
        checkpoint.expect(fingerprint_of(scene, plan, pictured=True), plan.passes)
    watch = Stopwatch(plan, progress)
    with watch.timing("compile"):
        device = start_device(plan.device)
        choice = choose_kernels(scene, plan, device=device)
        compiled = choice.compiled
        edges_nm = np.asarray(scene.film.edges_nm, dtype=np.float64)
        assert scene.camera is not None  # require_renderable has seen to it
        kernels = kernels_of(plan.precision, compiled.features)
        load_kernels(kernels, device=device, threads=plan.threads)
        camera = compile_camera(compiled, scene.camera, scene.film)
        survey = survey_view(compiled, camera, float(0.5 * (edges_nm[0] + edges_nm[-1])))
        lamps = compile_lamps_for(compiled, survey, plan)
        receivers = compile_receivers(compiled, lamps, edges_nm)
        require_memory(compiled, lamps, plan, pictured=True)
        radius = choose_gather_radius(compiled, survey, scene.film, plan)
        film = create_film(
            edges_nm, len(lamps.spectra), device, radius_scale=radius.scale, passes=plan.passes
        )
        sensors = compile_sensors(compiled)
    studio = _Studio(compiled, lamps, receivers, camera, sensors, plan, radius, watch)
    tally = SensorTally(sensors) if sensors is not None else None
    books: list[EnergyBooks] = []
    rule = StopRule(plan, watch)
    state = RunState(books, rule, watch, film=film, tally=tally)
    first = 0 if checkpoint is None else checkpoint.begin(state)
    with closing(studio.photon_maps(first)) as photon_maps:
        for pass_index, (maps, pass_books, crossings) in enumerate(photon_maps, first):
            books.append(pass_books)
            if tally is not None and crossings is not None:
                tally.add(crossings)
            with watch.timing("gather"):
                studio.expose(film, maps, pass_index)
            ends = state.ends()
            if checkpoint is not None:
                checkpoint.offer(state)
            if ends:
                break
    energy, closed = EnergyBooks.mean(books), plan.closed(film.passes)
    origin = Origin(scene=scene, settings=closed, energy=energy)
    radiance = film.radiance()
    if not np.all(np.isfinite(radiance)):
        allowed = "'float64': the radiance of this scene is beyond the numbers of float32"
        raise SettingsError("precision", plan.precision, allowed)
    return Picture(
        spectral_radiance=radiance,
        standard_error=film.standard_error(),
        accuracy=film.accuracy(),
        edges_nm=edges_nm,
        energy=energy,
        scene=scene,
        settings=closed,
        sensors=read_sensors(tally, origin) if tally is not None else {},
        stopping=rule.outcome,
        timings=watch.timings,
        features=choice.report(),
    )


def kernels_of(precision: str, features: Features) -> list[Any]:
    """What a rendering launches, the largest kernel first."""
    special = (make_render_camera, make_trace_photons, make_measure_footprints)
    return [
        *(make(precision, features) for make in special),
        make_collect(precision),
        make_reorder(precision),
        make_retrace_emission(precision, features),
    ]


def compile_lamps_for(
    compiled: CompiledScene, survey: Survey, plan: ResolvedSettings
) -> Lamps:
    """The lamps, with photons for what they have to show: all light, or what has met glass.

    Raises:
        SettingsError: there would have to be photons without end.
    """
    edges_nm = np.asarray(compiled.scene.film.edges_nm, dtype=np.float64)
    _refuse_endless_light(compiled.scene, plan)
    if plan.direct_light == "photons":
        return compile_lamps(compiled, edges_nm, plan.photons, view=survey)
    return compile_guided_lamps(
        compiled, edges_nm, plan.photons, view=survey, seed=plan.seed,
        max_interactions=plan.max_interactions, bounces=plan.bounces, threads=plan.threads,
    )


def _refuse_endless_light(scene: scenes.Scene, plan: ResolvedSettings) -> None:
    """Photons from afar come to a sphere around the scene; an endless plane lies beyond it too.

    Shadow rays from the plane to the sky have no such limit.
    """
    distant = [one.name for one in scene.emitters if isinstance(one, DistantEmitter)]
    endless = [one.name for one in scene.objects if isinstance(one.shape, scenes.Plane)]
    if distant and endless:
        reason = f"for {distant[0]} is infinitely far away, and {endless[0]} has no end"
        if plan.direct_light == "photons":
            raise SettingsError("direct_light", "photons", f'"lamps", {reason}')
        if plan.bounces > 0:
            raise SettingsError("bounces", plan.bounces, f"0, {reason}")




_Pass = tuple[PhotonMaps, EnergyBooks, PassCrossings | None]
"""One pass: its photons in maps, where its energy went, and what sensors have seen of it."""


@dataclass(frozen=True)
class _Studio:
    """All that the passes of one run share."""

    compiled: CompiledScene
    lamps: Lamps
    receivers: Any
    camera: Any
    sensors: SensorBank | None
    plan: ResolvedSettings
    radius: GatherRadius
    watch: Stopwatch

    def photon_maps(self, first: int = 0) -> Generator[_Pass, None, None]:
        """Each pass from the `first` on, in order.

        The next map is made while the caller gathers from this one: building a grid is serial,
        and would leave the other cores idle.
        """
        if first >= self.plan.passes:
            return
        stop = threading.Event()
        with ThreadPoolExecutor(1) as workshop:
            try:
                coming = workshop.submit(self._photon_map, first, stop)
                for pass_index in range(first, self.plan.passes):
                    ready = coming.result()
                    if pass_index + 1 < self.plan.passes:
                        coming = workshop.submit(self._photon_map, pass_index + 1, stop)
                    yield ready
            finally:
                stop.set()

    def _photon_map(self, pass_index: int, stop: threading.Event) -> _Pass:
        """Emit and trace the photons of one pass, and map them."""
        with self.watch.timing("trace photons"):
            batch = trace_photons(
                self.compiled,
                self.lamps,
                seed=self.plan.seed,
                pass_index=pass_index,
                max_interactions=self.plan.max_interactions,
                threads=self.plan.threads,
                store_direct=self.plan.direct_light == "photons",
                sensors=self.sensors,
                bounces=self.plan.bounces,
                stop=stop,
                on_done=self.watch.count_photons,
            )
        radius = self.radius.of_pass(pass_index, self.plan.alpha)
        with self.watch.timing("build photon map"):
            maps = build_photon_maps(
                self.compiled, batch, self.receivers, radius, seed=self.plan.seed,
                pass_index=pass_index, threads=self.plan.threads, stop=stop,
            )
        return maps, batch.books, batch.crossings

    def expose(self, film: Film, maps: PhotonMaps, pass_index: int) -> None:
        """Expose the film to one pass."""
        self.watch.pass_index = pass_index
        lights = compose_lights(
            self.plan.precision,
            maps,
            self.receivers,
            self.lamps,
            direct=self.plan.direct_light == "lamps",
        )
        expose(
            film,
            self.compiled,
            self.camera,
            lights,
            seed=self.plan.seed,
            pass_index=pass_index,
            threads=self.plan.threads,
            on_done=self.watch.report,
        )
