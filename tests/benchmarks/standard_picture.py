"""The lens in 1920 × 1080 at the preset `standard`, as the command renders it: time and memory."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from history import Measure

import scenes

SCENE, WIDTH, HEIGHT = "lens", 1920, 1080
COMMAND = "from sim.cli import run_from_shell; run_from_shell()"


def render() -> list[Measure]:
    """Seconds of wall and CPU time and peak memory of the whole process.

    The kernels' cache is used as it is found.
    """
    scene = scenes.load(SCENE)
    film = scene.film.model_copy(update={"width": WIDTH, "height": HEIGHT})
    text = scene.model_copy(update={"film": film}).to_toml()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "large.toml").write_text(text, encoding="utf-8")
        before = _children_cpu_s()
        start = time.perf_counter()
        subprocess.run(
            [sys.executable, "-c", COMMAND, "render", "large.toml", "--preset", "standard"],
            cwd=folder, check=True, env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )
        wall_s, cpu_s = time.perf_counter() - start, _children_cpu_s() - before
    gigabytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**20
    note = f"{cpu_s:.0f} s of CPU time, {os.cpu_count()} cores"
    return [
        Measure("1080p at standard: seconds", SCENE, wall_s, wall_s, wall_s, "<= 120", note),
        Measure("1080p at standard: GB at most", SCENE, gigabytes, gigabytes, gigabytes, "<= 3"),
    ]


def _children_cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
