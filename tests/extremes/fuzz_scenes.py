"""Fuzz scene files: ``python tests/extremes/fuzz_scenes.py --cases 100000 --seed 0``.

Every case is a file, made from the gallery's scenes or grown from the schema, and mutated. It must
load, or be refused with a `SceneError` whose problems have a place and a reason; no other
exception, no 5 s of CPU time, no 2 GB of memory. What loads goes through the cheap part of what
follows: settings, bands, what a picture requires, the features, and in a sample of the cases the
arrays for the kernels. Every case follows from the seed and its number; ``--only N`` repeats one.
"""

from __future__ import annotations

import argparse
import collections
import faulthandler
import os
import random
import signal
import sys
import tempfile
import time
import tomllib
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
import tomli_w
from mutations import mutate_bytes, mutate_tables
from scene_grammar import grow_scene

import scenes

__all__ = ["CPU_SECONDS", "Fuzz", "companions", "limited", "peak_gb"]

CPU_SECONDS = 5.0
GIGABYTES = 2.0
KINDS = ("bytes", "tables", "grown", "grown and mutated")


class TooSlowError(BaseException):
    """A case took more than its time; no `except Exception` may swallow it."""


def _too_slow(_signal: int, _frame: Any) -> None:
    raise TooSlowError


@contextmanager
def limited(seconds: float = CPU_SECONDS) -> Iterator[None]:
    """A block that is interrupted when it has taken so many seconds, of CPU or on the wall."""
    signal.signal(signal.SIGPROF, _too_slow)
    signal.signal(signal.SIGALRM, _too_slow)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, 12 * seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)


def peak_gb(*, reset: bool = False) -> float:
    """Most memory this process has had resident since the last reset [GB]; NaN if not known."""
    try:
        if reset:
            Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return float("nan")
    return int(status.partition("VmHWM:")[2].split()[0]) / 1e6


def companions(folder: Path) -> None:
    """Files that scenes name: meshes, heights, masks, and what must not be opened."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += [f"f {a} {b} {c}" for a, b, c in faces + 1]
    (folder / "one.obj").write_text("\n".join(lines), encoding="ascii")
    (folder / "cube.obj").write_text("\n".join(lines[:-1]), encoding="ascii")
    import trimesh

    mesh = trimesh.Trimesh(corners, faces)
    for kind in ("ply", "stl", "glb"):
        (folder / f"one.{kind}").write_bytes(mesh.export(file_type=kind))
    np.save(folder / "heights.npy", np.arange(12.0).reshape(3, 4) * 1e-3)
    (folder / "heights.txt").write_text("0 1 0\n1 0 1\n", encoding="ascii")
    from PIL import Image

    Image.fromarray(np.arange(48, dtype=np.uint8).reshape(6, 8)).save(folder / "mask.png")
    os.mkfifo(folder / "pipe")
    (folder / "folder").mkdir()
    (folder / "outside.obj").symlink_to("/etc/passwd")


class Fuzz:
    """Cases by number, what became of them, and every defect.

    Attributes:
        counts: cases by kind and outcome.
        defects: what went wrong: the case's number and how.
    """

    def __init__(self, seed: int, folder: Path) -> None:
        self.seed, self.folder = seed, folder
        companions(folder)
        texts = [scenes.gallery_path(name).read_bytes() for name in scenes.gallery()]
        # The pool's quarter of a million triangles take longer to compile than all other scenes.
        texts = [text.replace(b"cells = [240, 240]", b"cells = [24, 24]") for text in texts]
        self._texts = [text for text in texts if len(text) < 20_000]
        self._tables = [tomllib.loads(text.decode()) for text in self._texts]
        self.counts: collections.Counter[tuple[str, str]] = collections.Counter()
        self.defects: list[tuple[int, str]] = []
        self.slowest, self.largest_gb = (0.0, -1), (0.0, -1)

    def content(self, number: int) -> tuple[str, bytes]:
        """The kind of a case, and its file's bytes."""
        rng = random.Random(f"{self.seed}/{number}")
        kind = KINDS[number % len(KINDS)]
        if kind == "bytes":
            text = rng.choice(self._texts)
            if rng.random() < 0.3:
                text = tomli_w.dumps(grow_scene(rng)).encode()
            return kind, mutate_bytes(text, rng)
        data = rng.choice(self._tables) if kind == "tables" else grow_scene(rng)
        if kind != "grown":
            data = mutate_tables(data, rng)
        return kind, tomli_w.dumps(data).encode("utf-8", errors="surrogatepass")

    def run(self, number: int, *, compiled: bool = False) -> None:
        """One case."""
        kind, content = self.content(number)
        path = self.folder / "scene.toml"
        path.write_bytes(content)
        if number % 50 == 0:  # it takes longer than most cases
            peak_gb(reset=True)
        start = time.process_time()
        try:
            with limited(), warnings.catch_warnings():
                warnings.simplefilter("error")
                warnings.simplefilter("ignore", getattr(scenes, "SceneWarning", UserWarning))
                outcome = self._outcome(path, compiled)
        except TooSlowError:
            self.defects.append((number, f"more than {CPU_SECONDS:g} s\n{traceback.format_exc()}"))
            outcome = "too slow"
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            self.defects.append((number, traceback.format_exc()))
            outcome = "crashed"
        seconds, gigabytes = time.process_time() - start, peak_gb()
        if gigabytes > GIGABYTES:
            self.defects.append((number, f"{gigabytes:.1f} GB"))
        self.slowest = max(self.slowest, (seconds, number))
        self.largest_gb = max(self.largest_gb, (gigabytes, number))
        self.counts[kind, outcome] += 1

    def _outcome(self, path: Path, compiled: bool) -> str:
        from sim.errors import NephroidError

        try:
            scene = scenes.load(path)
        except scenes.SceneError as error:
            assert error.problems, "no problem is named"
            for problem in error.problems:
                assert problem.message, "a problem without a reason"
            lines = str(error)
            assert lines.count("\n") <= 1000, "a message without end"
            assert max(map(len, lines.split("\n"))) <= 4000, "a line without end"
            return "refused"
        try:
            return "compiled" if self._follows(scene, compiled) else "loaded"
        except scenes.SceneError:
            return "loaded, not renderable"
        except NephroidError:
            return "loaded, settings refused"

    def _follows(self, scene: scenes.Scene, compiled: bool) -> bool:
        """What is done with a scene before any kernel is compiled; whether arrays were made."""
        from sim.features import plan_features
        from sim.settings import RenderSettings

        settings = RenderSettings(threads=1).resolved(scene)
        assert np.isfinite(scene.film.edges_nm).all()
        assert (np.diff(scene.film.edges_nm) > 0.0).all()
        again = scenes.loads(scene.to_toml(), folder=self.folder)
        assert again.model_dump() == scene.model_dump(), "what is written is not what was read"
        plan_features(scene, settings)
        if compiled:
            from sim.device import start_device
            from sim.scene_data import compile_scene

            compile_scene(scene, device=start_device("cpu"))
        scene.require_renderable()
        return compiled


def main() -> int:
    """Run the cases and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--only", type=int, help="print this case's file and run it alone")
    parser.add_argument("--sample", type=int, default=20, help="compile one case in so many")
    parser.add_argument("--stop", type=int, default=200, help="after so many defects")
    options = parser.parse_args()
    faulthandler.enable()
    with tempfile.TemporaryDirectory() as folder:
        fuzz = Fuzz(options.seed, Path(folder))
        if options.only is not None:
            sys.stdout.buffer.write(fuzz.content(options.only)[1] + b"\n")
            fuzz.run(options.only, compiled=True)
        else:
            for number in range(options.first, options.first + options.cases):
                fuzz.run(number, compiled=number // len(KINDS) % options.sample == 0)
                if number % 5000 == 4999:
                    print(f"… {number + 1}: {len(fuzz.defects)} defects", file=sys.stderr)
                if len(fuzz.defects) >= options.stop:
                    break
    for number, how in fuzz.defects[: options.stop]:
        print(f"case {number}: {how}")
    for (kind, outcome), count in sorted(fuzz.counts.items()):
        print(f"{kind:<20} {outcome:<26} {count:>7}")
    print(f"{sum(fuzz.counts.values())} cases, {len(fuzz.defects)} defects;"
          f" the slowest {fuzz.slowest[0]:.2f} s (case {fuzz.slowest[1]}),"
          f" the largest {fuzz.largest_gb[0]:.2f} GB (case {fuzz.largest_gb[1]})")
    return 1 if fuzz.defects else 0


if __name__ == "__main__":
    sys.exit(main())
