"""Kernel rate of the photon tracer, against a scalar C program and over two threads.

``python tests/benchmarks/run.py [SCENE …]`` traces the same photons of a gallery scene with
Nephroid on one thread, with `photon_tracer.c` on one, and with Nephroid on two, in turn, and
prints the ratios of their rates: medians over the repetitions, and the least and the greatest.

One thread is timed by the process's CPU time, two against one by the clock on the wall, so the
second ratio wants a machine with nothing else to do: it cannot exceed the cores that the system
granted the two threads, which are printed below it. Nothing is asserted about speed; but the
deposits and the energy books of the two programs must be the same to rounding, since only equal
work compares. `photon_tracer.c` has no lenses: there it is skipped.

``--record`` adds the medians to `history.csv` beside this file, to compare against later.
"""

import argparse
import csv
import datetime
import math
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))

import scenes  # noqa: E402
from sim.device import start_device  # noqa: E402
from sim.image.camera import compile_camera  # noqa: E402
from sim.image.survey import survey_view  # noqa: E402
from sim.photons import tracing  # noqa: E402
from sim.photons.guided_lamps import compile_guided_lamps  # noqa: E402
from sim.photons.lamps import Lamps  # noqa: E402
from sim.photons.photon_path import COLOURS  # noqa: E402
from sim.sampling.counter import fold_key  # noqa: E402
from sim.sampling.sobol import DIMENSIONS, sobol_tables  # noqa: E402
from sim.scene_data import CompiledScene, compile_scene  # noqa: E402
from sim.version import VERSION  # noqa: E402

SCENES = ("ball", "prism", "lens")
HISTORY = HERE / "history.csv"
HISTORY_COLUMNS = (
    "date", "version", "machine", "scene", "photons", "ns_a_photon", "of_c", "two_threads"
)
SEED, PASS, MAX_INTERACTIONS = 0, 0, 256
CFLAGS = ("-O3", "-march=native")
EQUAL_WORK = 1e-9
"""Relative. The programs round differently: some 10⁶ numbers of relative error 1e-15 each."""

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
        columns(data.bodies.numpy(), bodies, "material", "medium_inside", "dispersive"),
        np.hstack([columns(data.media.numpy(), media, "formula"), data.coefficients.numpy()]),
        shine.cdf.numpy().reshape(-1, 1),
        columns(
            emitters, len(emitters), "kind", "round", "centre", "frame", "half_u", "half_v",
            "radius", "sin2_half", "flux", "first_target", "target_count", "first_segment",
            "segment_count", "first_cdf",
        ),
        columns(
            targets, len(targets), "kind", "centre", "frame", "half_u", "half_v", "radius",
            "first_cdf", "photons",
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
    """One pass of Nephroid's tracer over a gallery scene."""

    def __init__(self, name: str, photons: int) -> None:
        scene = scenes.load(name)
        self.compiled = compile_scene(scene, device=start_device("cpu"))
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


def summary(ratios: Sequence[float]) -> str:
    """Median (least to greatest)."""
    return f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"


def can_follow(compiled: CompiledScene) -> bool:
    """Whether `photon_tracer.c` can trace the scene: the bare features alone."""
    features = compiled.features
    return not (
        features.lenses or features.tabulated or features.air_conversion or features.interfaces
        or features.absorption or features.finishes
    )


def record(row: Sequence[object]) -> None:
    """Add a row to the history."""
    is_new = not HISTORY.exists()
    with HISTORY.open("a", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        if is_new:
            writer.writerow(HISTORY_COLUMNS)
        writer.writerow(row)


def compare(
    name: str, photons: int, repetitions: int, compiler: str | None, *, keep: bool
) -> None:
    """Run the contestants in turn, and print what their rates make of each other."""
    nephroid = Nephroid(name, photons)
    if not can_follow(nephroid.compiled):
        compiler = None
    totals = nephroid.totals()
    against_c: list[float] = []
    threads: list[float] = []
    cost: list[float] = []
    cores: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        rival = Rival(compiler, Path(folder), nephroid, name) if compiler else None
        for _ in range(repetitions):
            cpu = seconds(time.process_time, lambda: nephroid.trace(threads=1))
            cost.append(1e9 * cpu / nephroid.photons)
            if rival:
                spent, *result = rival.run()
                check_equal_work(name, totals, np.array(result))
                against_c.append(spent / cpu)
            one = seconds(time.perf_counter, lambda: nephroid.trace(threads=1))
            cpu = time.process_time()
            two = seconds(time.perf_counter, lambda: nephroid.trace(threads=2))
            cores.append((time.process_time() - cpu) / two)
            threads.append(one / two)
    print(f"{name}: {nephroid.photons} photons, {totals[0]:.0f} deposits")
    print(f"  Nephroid, 1 thread             {summary(cost)} ns of CPU time a photon")
    print(f"  Nephroid / C, 1 thread         {summary(against_c) if against_c else 'skipped'}")
    print(f"  Nephroid, 2 threads / 1 thread {summary(threads)}")
    print(f"    cores it had meanwhile       {summary(cores)}", flush=True)
    if keep:
        of_c = f"{statistics.median(against_c):.3f}" if against_c else ""
        medians = f"{statistics.median(cost):.0f}", of_c, f"{statistics.median(threads):.3f}"
        today = datetime.datetime.now(tz=datetime.UTC).date().isoformat()
        record([today, VERSION, platform.machine(), name, nephroid.photons, *medians])


def check_equal_work(name: str, ours: FloatArray, theirs: FloatArray) -> None:
    """Stop unless the deposits' number and flux and the books agree.

    What is small beside the emitted flux, such as the balance of roulette, counts beside it.
    """
    scale = np.array([ours[0], *np.maximum(np.abs(ours[1:]), 1e-3 * ours[2])])
    if ours[0] != theirs[0] or np.any(np.abs(ours - theirs) > EQUAL_WORK * scale):
        raise SystemExit(f"{name}: not the same work:\n  Nephroid {ours}\n  C        {theirs}")


def main() -> None:
    """Run the benchmark from the command line."""
    parser = argparse.ArgumentParser(description=__doc__, add_help=True)
    parser.add_argument("scenes", nargs="*", default=SCENES, metavar="SCENE")
    parser.add_argument("--photons", type=int, default=1_000_000)
    parser.add_argument("--repetitions", type=int, default=9)
    parser.add_argument("--record", action="store_true", help="add the medians to history.csv")
    options = parser.parse_args()
    compiler = os.environ.get("CC") or shutil.which("cc")
    if compiler is None:
        print("No C compiler (cc, or the variable CC): Nephroid / C is skipped.")
    for name in options.scenes:
        compare(
            name, options.photons, options.repetitions, compiler, keep=options.record
        )


if __name__ == "__main__":
    main()
