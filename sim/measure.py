"""Measure a scene: photons for its sensors alone, without a camera.

A pass is a pure function of the compiled scene, the settings and the pass's index. Passes are
independent and averaged, so their spread is the standard error of every bin.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

import scenes
from sim.canary import choose_kernels
from sim.device import start_device
from sim.launch import load_kernels
from sim.memory.estimate import require_memory
from sim.photons.energy import EnergyBooks
from sim.photons.lamps import compile_lamps
from sim.photons.photon_path import make_trace_photons
from sim.photons.tracing import trace_photons
from sim.progress import ProgressCallback
from sim.resumption.checkpoint import Checkpoint
from sim.resumption.fingerprint import fingerprint_of
from sim.resumption.run_state import RunState
from sim.sensors.origin import Origin
from sim.sensors.readings import Readings, read_sensors
from sim.sensors.sensor_bank import compile_sensors
from sim.sensors.tally import SensorTally
from sim.settings import RenderSettings, ResolvedSettings
from sim.stopping import StopRule
from sim.stopwatch import Stopwatch

__all__ = ["Measurement", "measure"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """What the sensors of a scene have measured.

    Attributes:
        sensors: Readings by the names of their sensors.
        energy: Where the emitted flux went [W].
        scene: The scene.
        settings: The settings that measure it again, resolved: with the passes that there were.
        stopping: Why there were no more: "all passes", "target error" or "time budget".
        timings: Seconds that each stage took.
        features: What the kernels could do and could not, and what that can cost, ready for JSON.
    """

    sensors: Readings
    energy: EnergyBooks
    scene: scenes.Scene
    settings: ResolvedSettings
    stopping: str = "all passes"
    timings: dict[str, float] = field(default_factory=dict)
    features: dict[str, Any] = field(default_factory=dict)


def measure(
    scene: scenes.Scene,
    settings: RenderSettings | None = None,
    *,
    progress: ProgressCallback | None = None,
    checkpoint: Checkpoint | None = None,
) -> Measurement:
    """Measure what the sensors of `scene` receive; a camera is not needed, nor used.

    Sensors count light on any way from a lamp, straight or through glass, and off as many diffuse
    surfaces as the setting `bounces` says.

    Args:
        scene: with at least one sensor and one emitter.
        settings: what to spend; by default the scene's own settings. A target error is that of
            the irradiance of all cells, and of the flux through sensors that keep rays.
        progress: told how far the run is, some times a second.
        checkpoint: where the run's state is kept, and from where it goes on; None: nowhere.

    Returns:
        The readings, with their standard errors, and where the energy went.

    Raises:
        scenes.SceneError: the scene lacks something that a measurement needs.
        DeviceError: the device does not exist.
        CapacityError: there is not enough memory for it.
        CheckpointError: the checkpoint is of another run; says what differs.
        KeyboardInterrupt: on Ctrl-C, within a fraction of a second.
    """
    scene.require_measurable()
    plan = (settings or RenderSettings()).resolved(scene)
    if checkpoint is not None:
        checkpoint.expect(fingerprint_of(scene, plan, pictured=False), plan.passes)
    watch = Stopwatch(plan, progress)
    with watch.timing("compile"):
        device = start_device(plan.device)
        choice = choose_kernels(scene, plan, device=device)
        compiled = choice.compiled
        kernel = make_trace_photons(plan.precision, compiled.features)
        load_kernels([kernel], device=device, threads=plan.threads)
        edges_nm = np.asarray(scene.film.edges_nm, dtype=np.float64)
        lamps = compile_lamps(compiled, edges_nm, plan.photons)
        require_memory(compiled, lamps, plan, pictured=False)
        bank = compile_sensors(compiled)
        assert bank is not None  # require_measurable has seen to it
    tally, rule = SensorTally(bank), StopRule(plan, watch)
    books: list[EnergyBooks] = []
    state = RunState(books, rule, watch, tally=tally)
    first = 0 if checkpoint is None else checkpoint.begin(state)
    for pass_index in range(first, plan.passes):
        watch.pass_index = pass_index
        with watch.timing("trace photons"):
            batch = trace_photons(
                compiled,
                lamps,
                seed=plan.seed,
                pass_index=pass_index,
                max_interactions=plan.max_interactions,
                threads=plan.threads,
                store_direct=False,
                sensors=bank,
                bounces=plan.bounces,
                on_done=watch.count_photons,
            )
        with watch.timing("read sensors"):
            assert batch.crossings is not None
            tally.add(batch.crossings)
        books.append(batch.books)
        ends = state.ends()
        if checkpoint is not None:
            checkpoint.offer(state)
        if ends:
            break
    energy, closed = EnergyBooks.mean(books), plan.closed(len(books))
    return Measurement(
        sensors=read_sensors(tally, Origin(scene=scene, settings=closed, energy=energy)),
        energy=energy,
        scene=scene,
        settings=closed,
        stopping=rule.outcome,
        timings=watch.timings,
        features=choice.report(),
    )
