"""Fuzz the readers of files: ``python tests/extremes/fuzz_readers.py --cases 5000 --seed 0``.

Small right files of every kind (spectral EXR, meshes, heights, masks) have their bytes mutated.
Each must be read, or be refused with the error of its kind; no other exception, no crash of the
process, no 5 s of CPU time, no 2 GB. Cases run in a child process, which native code may take down.
"""

from __future__ import annotations

import argparse
import collections
import io
import json
import os
import random
import struct
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import numpy as np
from fuzz_scenes import CPU_SECONDS, GIGABYTES, TooSlowError, limited, peak_gb
from mutations import mutate_bytes

import scenes

__all__ = ["KINDS", "right_file", "run_cases"]

MESHES = ("ply", "ascii.ply", "obj", "stl", "ascii.stl", "glb")
GRIDS = ("npy", "txt")
IMAGES = ("png", "16.png", "gif", "tiff", "bmp", "ppm", "jpeg", "webp")
KINDS = ("exr", *MESHES, *GRIDS, *IMAGES)

PIECES = [
    *(struct.pack("<i", n) for n in (0, 1, -1, 255, 65535, 2**31 - 1, -(2**31), 10**6, 2**28)),
    *(struct.pack(">I", n) for n in (1, 2**31 - 1, 10**5)),
    *(struct.pack("<q", n) for n in (-1, 2**62, 10**12)), struct.pack("<f", float("nan")),
    b"1000000000000", b"-1", b"1e999", b"nan", b"0", b" ", b"\n", b"\x00", b"\xff" * 8, b"../",
    b'"', b"{", b"]", b"f 1 2 3 4 5 6\n", b"f -1 -2 -3\n", b"v 1 2 3\n", b"mtllib /dev/zero\n",
    b"f 1//1 2//2 3//3\n", b"f 99999999 1 2\n", b"element vertex 1000000000\n", b"list", b"uint64",
    b"9" * 400,
]  # fmt: skip


def right_file(kind: str) -> bytes:
    """The content of a small file with which nothing is wrong."""
    if kind == "exr":
        return _exr()
    if kind in MESHES:
        import trimesh

        mesh = trimesh.creation.box((1.0, 2.0, 3.0))
        ending = kind.rpartition(".")[2]
        if kind.startswith("ascii"):
            how = {"encoding": "ascii"} if ending == "ply" else {}
            exported = mesh.export(file_type="stl_ascii" if ending == "stl" else ending, **how)
        else:
            exported = mesh.export(file_type=ending)
        return exported if isinstance(exported, bytes) else exported.encode()
    heights = np.linspace(0.0, 0.1, 12).reshape(3, 4)
    file = io.BytesIO()
    if kind == "npy":
        np.save(file, heights)
    elif kind == "txt":
        np.savetxt(file, heights)
    else:
        from PIL import Image

        deep = kind == "16.png"
        grey = np.arange(96, dtype=np.uint16 if deep else np.uint8).reshape(8, 12)
        Image.fromarray(grey).save(file, format=kind.rpartition(".")[2])
    return file.getvalue()


def _exr() -> bytes:
    from sim.image.exr import encode_channels
    from sim.image.exr_layout import EMISSIVE_UNITS, error_channel, radiance_channel

    plane = np.arange(24, dtype=np.float32).reshape(4, 6)
    names = [name(nm) for nm in (450.0, 550.0) for name in (radiance_channel, error_channel)]
    channels = dict.fromkeys((*names, "R", "G", "B"), plane)
    attributes = {"nephroid_scene": "title = 'a'", "nephroid_settings": '{"photons": 1}'}
    return bytes(encode_channels(channels, attributes, units=EMISSIVE_UNITS, exposure_stops=0.0))


def read(kind: str, path: Path) -> None:
    """Read a file as the program does."""
    if kind == "exr":
        from sim.cli import main

        assert main(["info", str(path)]) in (0, 2)
    elif kind in MESHES:
        scenes.Mesh(position=(0, 0, 0), file=str(path), normals="smooth").openness  # noqa: B018
    elif kind in GRIDS:
        scenes.HeightField(position=(0, 0, 0), size=(1, 1), file=str(path)).openness  # noqa: B018
    else:
        scenes.Mask(file=str(path))


def content(kind: str, right: bytes, seed: int, number: int) -> bytes:
    """A case's file."""
    return mutate_bytes(right, random.Random(f"{seed}/{kind}/{number}"), PIECES)


def run_cases(
    kind: str, seed: int, numbers: range, tell: Callable[[dict[str, Any]], None], folder: Path
) -> None:
    """Run cases one after the other; tells of each before and after."""
    right = right_file(kind)
    path = folder / f"case.{kind.rpartition('.')[2]}"
    for number in numbers:
        path.write_bytes(content(kind, right, seed, number))
        tell({"begun": number})
        if number % 20 == 0:
            peak_gb(reset=True)
        start = time.process_time()
        outcome, how = "read", ""
        try:
            with limited(), warnings.catch_warnings():
                warnings.simplefilter("error")
                read(kind, path)
        except scenes.SceneError as error:
            outcome = "refused"
            if len(str(error)) > 3000:
                outcome, how = "defect", "a message without end"
        except TooSlowError:
            outcome, how = "defect", f"more than {CPU_SECONDS:g} s\n{traceback.format_exc()}"
        except BaseException:
            outcome, how = "defect", traceback.format_exc()
        if peak_gb() > GIGABYTES:
            outcome, how = "defect", f"{peak_gb():.1f} GB"
        seconds = time.process_time() - start
        tell({"ended": number, "outcome": outcome, "how": how, "seconds": seconds})


def in_a_child(kind: str, seed: int, numbers: range) -> Iterator[dict[str, Any]]:
    """What a child process tells; when it dies, another goes on behind the case that killed it."""
    first = numbers.start
    while first < numbers.stop:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            _child(kind, seed, range(first, numbers.stop), reading, writing)
        os.close(writing)
        begun = first
        with os.fdopen(reading, encoding="utf-8") as lines:
            for line in lines:
                told = json.loads(line)
                begun = told.get("begun", begun)
                if "outcome" in told:
                    yield told
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if status == 0:
            return
        yield {"ended": begun, "outcome": "defect", "how": f"the process died: {status}",
               "seconds": 0.0}  # fmt: skip
        first = begun + 1


def _child(kind: str, seed: int, numbers: range, reading: int, writing: int) -> None:
    os.close(reading)
    status = 1
    try:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        sys.stdout, sys.stderr = open(1, "w"), open(2, "w")
        with os.fdopen(writing, "w", encoding="utf-8") as pipe:

            def tell(what: dict[str, Any]) -> None:
                print(json.dumps(what), file=pipe, flush=True)

            with tempfile.TemporaryDirectory() as folder:
                run_cases(kind, seed, numbers, tell, Path(folder))
        status = 0
    finally:
        os._exit(status)


def main() -> int:
    """Run the cases and print what became of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=1000, help="of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--keep", type=Path, help="folder for the files that are defects")
    options = parser.parse_args()
    defects = 0
    for kind in options.kinds.split(","):
        counts: collections.Counter[str] = collections.Counter()
        slowest = 0.0
        for told in in_a_child(kind, options.seed, range(options.cases)):
            counts[told["outcome"]] += 1
            slowest = max(slowest, told["seconds"])
            if told["outcome"] == "defect":
                print(f"{kind} {told['ended']}: {told['how']}")
                if options.keep is not None:
                    name = f"{told['ended']}.{kind}"
                    case = content(kind, right_file(kind), options.seed, told["ended"])
                    (options.keep / name).write_bytes(case)
        defects += counts["defect"]
        print(f"{kind:<10} {dict(counts)}, the slowest {slowest:.2f} s", flush=True)
    return 1 if defects else 0


if __name__ == "__main__":
    sys.exit(main())
