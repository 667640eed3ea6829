"""Measure the trade of speed for accuracy in a scene, and write a report.

Varies one thing at a time around the scene's own settings (photons, passes, gather radius, bands,
precision, sampling, aiming, Fresnel's formulas, dispersion …), runs each several times, and
compares with a reference. The folder gets study.csv and study.html, a page that needs nothing
else. Errors are relative L2: of spectral irradiance in bins on a flat receiver, and of the
picture's luminance; choices for the picture are compared by its error as --target-error counts it,
which a few burnt-out pixels do not rule. Time is CPU time.
"""

from __future__ import annotations

import argparse
import dataclasses
import functools
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.arguments import add_scene_arguments, count, load_scene

if TYPE_CHECKING:
    from scenes import Scene

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "measure the trade of speed for accuracy in a scene"

_FILES = ("study.csv", "study.html")
_SECONDS_BETWEEN_LINES = 2.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    add_scene_arguments(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER",
                        help="folder for study.csv and study.html (default: SCENE-study, here)")
    parser.add_argument("--quick", action="store_true",
                        help="about 2 minutes on 2 free cores, once compiled, instead of 20")
    parser.add_argument("--axes", metavar="NAME,…",
                        help="only these axes, such as photons,passes (default: all)")
    parser.add_argument("--seed", type=count, default=0, metavar="N",
                        help="the first of the seeds; every run has its own (default: 0)")
    parser.add_argument("--threads", type=count, metavar="N",
                        help="CPU threads (default: all cores)")


def run(arguments: argparse.Namespace) -> None:
    """Study, then write both files; outputs, settings and scene are checked before."""
    from sim.atomic_file import check_writable, write_whole
    from sim.interruption import run_interruptibly
    from sim.settings import RenderSettings

    settings = RenderSettings(seed=arguments.seed, threads=arguments.threads)
    scene = load_scene(arguments)
    scene.require_renderable()
    folder = arguments.output or Path(f"{scene.source_name}-study")
    paths = [folder / name for name in _FILES]
    folder.mkdir(exist_ok=True)
    for path in paths:
        check_writable(path)
    threads = settings.resolved(scene).threads or 1
    names = _axes(arguments.axes)
    work = functools.partial(_studied, scene, arguments.quick, names, arguments.seed, threads)
    for path, data in zip(paths, run_interruptibly(work), strict=True):
        write_whole(path, data)
    print(f"{' and '.join(str(path) for path in paths)}")


def _axes(text: str | None) -> tuple[str, ...] | None:
    """Names of the axes asked for; None for all."""
    import sim.study.standard_axes  # noqa: F401 - it registers the engine's axes
    from sim.errors import SettingsError
    from sim.study.axes import axes

    if text is None:
        return None
    known = [axis.name for axis in axes()]
    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in known:
            raise SettingsError("axes", name, ", ".join(known))
    return names


def _studied(
    scene: Scene, quick: bool, names: tuple[str, ...] | None, seed: int, threads: int
) -> tuple[bytes, bytes]:
    """The content of both files."""
    from sim.study.plan import FULL, QUICK
    from sim.study.report import encode_html
    from sim.study.study import run_study
    from sim.study.table import encode_csv

    plan = QUICK if quick else FULL
    if names is not None:
        plan = dataclasses.replace(plan, axes=names)
    outcome = run_study(scene, plan, seed=seed, threads=threads, tell=_Lines())
    return encode_csv(outcome), encode_html(outcome)


class _Lines:
    """Writes what the study does to stderr, one line every two seconds at most."""

    def __init__(self) -> None:
        self._start = time.perf_counter()
        self._last = -_SECONDS_BETWEEN_LINES
        self._stage = ""

    def __call__(self, text: str) -> None:
        seconds = time.perf_counter() - self._start
        stage = text.partition(" ")[0]
        if stage != self._stage or seconds - self._last >= _SECONDS_BETWEEN_LINES:
            self._stage, self._last = stage, seconds
            print(f"{seconds:5.0f} s  {text}", file=sys.stderr, flush=True)
