"""Kernel rate of the photon tracer, against a scalar C program and over two threads.

The same photons of a gallery scene are traced by Nephroid on one thread, by `photon_tracer.c` on
one, and by Nephroid on two, in turn; what counts is the ratios of their rates.

One thread is timed by the process's CPU time, two against one by the clock on the wall, so the
second ratio wants a machine with nothing else to do: it cannot exceed the cores that the system
granted the two threads meanwhile, which are measured too. Nothing is asserted about speed; but
the deposits and the energy books of the two programs must be the same to rounding, since only
equal work compares. `photon_tracer.c` averages s and p, so that Nephroid is made to do so beside
it; two threads are measured as a rendering runs, and so is what polarisation costs. The C program
has no lenses, metals, absorption and the like: scenes with those go without it.
"""

import math
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from history import Measure, median_measure

import scenes
from sim.device import start_device
from sim.features import plan_features
from sim.image.camera import compile_camera
from sim.image.survey import survey_view
from sim.photons import tracing
from sim.photons.guided_lamps import compile_guided_lamps
from sim.photons.lamps import Lamps
from sim.photons.photon_path import COLOURS
from sim.sampling.counter import fold_key
from sim.sampling.sobol import DIMENSIONS, sobol_tables
from sim.scene_data import CompiledScene, compile_scene
from sim.settings import RenderSettings

HERE = Path(__file__).resolve().parent
SEED, PASS, MAX_INTERACTIONS = 0, 0, 256
CFLAGS = ("-O3", "-march=native")
EQUAL_WORK = 1e-9
"""Relative. The programs round differently: some 10⁶ numbers of relative error 1e-15 each."""

OF_C, TWO_THREADS = "photons: rate over C's, one thread", "photons: two threads over one"
POLARISED = "photons: CPU time with polarisation over without"
NANOSECONDS = "photons: CPU-ns a photon, one thread"
CORES = "photons: cores that two threads had"

FloatArray = npt.NDArray[np.float64]


def columns(rows: npt.NDArray[Any], count: int, *names: str) -> FloatArray:
    """The first `count` rows of a structured array, the named fields side by side."""
    parts = [rows[name] for name in names]
    flat = [part.reshape(len(part), math.prod(part.shape[1:]))[:count] for part in parts]
    return np.hstack(flat).astype(np.float64)


def sections(compiled: CompiledScene, lamps: Lamps) -> list[FloatArray]:
    """What the C program reads, in its order; every section (rows, columns)."""
    features, data, shine = compiled.features, compiled.data, lamps.data
    bodies, media = len(compiled.scene.objects), features.media_count
    emitters, targets = shine.emitters.numpy(), shine.targets.numpy()
    polyhedra = data.polyhedra.numpy()
    planes = int(polyhedra["count"][: data.polyhedron_count].sum())
    return [
        columns(data.spheres.numpy(), data.sphere_count, "centre", "radius", "prim"),
        columns(
            data.flats.numpy(), data.flat_count,
            "centre", "frame", "half_u", "half_v", "radius2", "prim",
        ),
        columns(data.planes.numpy(), planes, "normal", "offset"),
        columns(polyhedra, data.polyhedron_count, "centre", "first", "count", "prim"),
        columns(
            data.bodies.numpy(), bodies,
            "material", "medium_inside", "dispersive",
        ),
        np.hstack([columns(data.media.numpy(), media, "formula"), data.coefficients.numpy()]),
        shine.cdf.numpy().reshape(-1, 1),
        columns(
            emitters, len(emitters), "kind", "round", "centre", "frame", "half_u", "half_v",
            "radius", "sin2_half", "flux", "first_target", "target_count", "first_segment",
            "segment_count", "first_cdf",
        ),
        columns(
            targets, len(targets), "kind", "centre", "frame", "half_u", "half_v", "radius",
            "pivot", "first_cdf", "photons",
        ),
        columns(
            shine.segments.numpy(), len(shine.segments), "wavelength_nm", "width_nm",
            "density_low", "density_high",
        ),
        stream_rows(lamps),
        sobol_tables().astype(np.float64).reshape(1, -1),
        np.array(
            [
                [
                    MAX_INTERACTIONS,
                    tracing.BRANCH_THRESHOLD,
                    tracing._SLOTS_PER_PHOTON,
                    int(COLOURS),
                    0,  # of what has met no glass, nothing is stored
                ]
            ]
        ),
    ]


def stream_rows(lamps: Lamps) -> FloatArray:
    """One row a stream: emitter, target, photons, key (two halves), scramble of each dimension."""
    seeds = lamps.data.seeds.numpy().reshape(-1, DIMENSIONS)
    rows = []
    for row, stream in enumerate(lamps.streams):
        key = fold_key(SEED, PASS, row)
        head = [stream.emitter, stream.target, stream.photons, key >> 32, key & 0xFFFFFFFF]
        rows.append([*head, *seeds[row]])
    return np.array(rows, dtype=np.float64)


class Nephroid:
    """One pass of Nephroid's tracer over a gallery scene, with what the scene requires."""

    def __init__(self, name: str, photons: int, *, polarisation: str = "auto") -> None:
        scene = scenes.load(name)
        settings = RenderSettings(polarisation=polarisation).resolved(scene)
        self.compiled = compile_scene(
            scene, device=start_device("cpu"), features=plan_features(scene, settings).features
        )
        edges_nm = np.asarray(scene.film.edges_nm, dtype=np.float64)
        camera = compile_camera(self.compiled, scene.camera, scene.film)
        survey = survey_view(self.compiled, camera, float(edges_nm.mean()))
        self.lamps = compile_guided_lamps(
            self.compiled, edges_nm, photons, view=survey, seed=SEED,
            max_interactions=MAX_INTERACTIONS, threads=1,
        )
        self.photons = sum(stream.photons for stream in self.lamps.streams)

    def trace(self, threads: int) -> tracing.PhotonBatch:
        """Trace the pass."""
        return tracing.trace_photons(
            self.compiled, self.lamps, seed=SEED, pass_index=PASS,
            max_interactions=MAX_INTERACTIONS, threads=threads, store_direct=False,
        )

    def totals(self) -> FloatArray:
        """Deposits, their flux, and the books, as `Rival` prints them."""
        batch = self.trace(threads=1)
        flux, books = batch.to_numpy()["flux"], batch.books
        return np.array(
            [len(batch), flux.sum(), books.emitted, books.deposited, books.absorbed,
             books.escaped, books.culled]
        )


class Rival:
    """The C program, compiled, with its input."""

    def __init__(self, compiler: str, folder: Path, nephroid: Nephroid, name: str) -> None:
        self.program, self.input = folder / "photon_tracer", folder / f"{name}.bin"
        source = HERE / "photon_tracer.c"
        subprocess.run(
            [*compiler.split(), *CFLAGS, "-o", str(self.program), str(source), "-lm"], check=True
        )
        nephroid.lamps.seed(nephroid.compiled.device, SEED, PASS)
        with self.input.open("wb") as file:
            for section in sections(nephroid.compiled, nephroid.lamps):
                file.write(np.array(section.shape, dtype=np.int64).tobytes())
                file.write(np.ascontiguousarray(section).tobytes())

    def run(self) -> FloatArray:
        """CPU seconds, then deposits, their flux, and the books, of a second, warm run."""
        done = subprocess.run(
            [str(self.program), str(self.input), "2"], check=True, capture_output=True, text=True
        )
        return np.array(done.stdout.splitlines()[-1].split(), dtype=np.float64)


def seconds(clock: Callable[[], float], work: Callable[[], object]) -> float:
    """What `work` takes by `clock`."""
    start = clock()
    work()
    return clock() - start


def can_follow(compiled: CompiledScene) -> bool:
    """Whether `photon_tracer.c` can trace the scene."""
    features = compiled.features
    return not any(
        getattr(features, flag)
        for flag in (
            "lenses", "meshes", "tabulated", "air_conversion", "interfaces", "absorption",
            "finishes", "polarisers", "polarisation", "interreflection", "sensors",
            "distant_lamps", "masks",
        )
    )


def compare(name: str, photons: int, repetitions: int) -> list[Measure]:
    """Run the contestants in turn; what their rates make of each other."""
    nephroid = Nephroid(name, photons)
    averaged = Nephroid(name, photons, polarisation="averaged")
    nephroid.trace(threads=1)  # compiles
    totals = averaged.totals()
    compiler = os.environ.get("CC") or shutil.which("cc")
    rivals = compiler is not None and can_follow(averaged.compiled)
    found: dict[str, list[float]] = {NANOSECONDS: [], POLARISED: [], TWO_THREADS: [], CORES: []}
    if rivals:
        found[OF_C] = []
    with tempfile.TemporaryDirectory() as folder:
        rival = Rival(str(compiler), Path(folder), averaged, name) if rivals else None
        for _ in range(repetitions):
            cpu = seconds(time.process_time, lambda: nephroid.trace(threads=1))
            found[NANOSECONDS].append(1e9 * cpu / nephroid.photons)
            plain = seconds(time.process_time, lambda: averaged.trace(threads=1))
            found[POLARISED].append(cpu / plain)
            if rival:
                spent, *result = rival.run()
                check_equal_work(name, totals, np.array(result))
                found[OF_C].append(spent / plain)
            one = seconds(time.perf_counter, lambda: nephroid.trace(threads=1))
            cpu = time.process_time()
            two = seconds(time.perf_counter, lambda: nephroid.trace(threads=2))
            found[CORES].append((time.process_time() - cpu) / two)
            found[TWO_THREADS].append(one / two)
    asked = {OF_C: ">= 0.7", TWO_THREADS: ">= 1.7"}
    return [
        median_measure(measure, name, values, asked.get(measure, ""), f"{photons} photons")
        for measure, values in found.items()
    ]


def check_equal_work(name: str, ours: FloatArray, theirs: FloatArray) -> None:
    """Stop unless the deposits' number and flux and the books agree.

    What is small beside the emitted flux, such as the balance of roulette, counts beside it.
    """
    scale = np.array([ours[0], *np.maximum(np.abs(ours[1:]), 1e-3 * ours[2])])
    if ours[0] != theirs[0] or np.any(np.abs(ours - theirs) > EQUAL_WORK * scale):
        raise SystemExit(f"{name}: not the same work:\n  Nephroid {ours}\n  C        {theirs}")
