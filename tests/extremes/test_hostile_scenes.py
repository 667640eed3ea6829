"""Scene files that are damaged, hostile or absurd: one error each, no hang, no flood of memory."""

import contextlib
import importlib.util
import math
import os
import sys
import time
import warnings
from pathlib import Path

import pytest

import scenes
from sim.cli import main

HERE = Path(__file__).parent
SPHERE = '[[objects]]\nshape = {{ type = "sphere", position = [{}, 0, 0], radius = 1 }}\n'
GLASS = 'material = {{ type = "dielectric", medium = {{ type = "constant", eta = {} }} }}\n'


@pytest.fixture(scope="module")
def tool():
    """The fuzzing tools; they are scripts, and no package."""
    sys.path.insert(0, str(HERE))
    names = ("fuzz_scenes", "fuzz_readers", "mutations", "scene_grammar")
    found = {}
    for name in names[:2]:
        spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
        found[name] = sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found[name])
    yield found
    sys.path.remove(str(HERE))
    for name in names:
        sys.modules.pop(name, None)


def test_fuzzed_scene_files_load_or_say_what_is_wrong(tool, tmp_path) -> None:
    # Each case is held to 5 s of CPU and 2 GB; `python tests/extremes/fuzz_scenes.py` runs 100,000.
    fuzz = tool["fuzz_scenes"].Fuzz(1, tmp_path)
    for number in range(400):
        fuzz.run(number)
    assert fuzz.defects == []
    outcomes = {outcome for _, outcome in fuzz.counts}
    assert {"refused", "loaded"} <= outcomes


@pytest.mark.parametrize("kind", ["exr", "ply", "obj", "stl", "glb", "npy", "txt", "png", "tiff"])
def test_fuzzed_files_are_read_or_refused(tool, kind) -> None:
    # `python tests/extremes/fuzz_readers.py` runs thousands of each, and more kinds.
    told = list(tool["fuzz_readers"].in_a_child(kind, 1, range(60)))
    assert [one["how"] for one in told if one["outcome"] == "defect"] == []
    assert len(told) == 60


ROUND = [
    [math.cos(2.4 * i) * math.sqrt(1 - z * z), math.sin(2.4 * i) * math.sqrt(1 - z * z), z]
    for i in range(512)
    for z in [(i - 255.5) / 256]
]
"""Corners of a ball that are all on their hull: a spiral by nearly the golden angle."""

HOSTILE = {
    "a dotted key without end": (".".join(["a"] * 100_000) + " = 1", "nested too deeply"),
    "a header without end": ("[" + ".".join(['"a"'] * 100_000) + "]", "nested too deeply"),
    "a long key": ("k" * 1_000_000 + " = 1", "unknown key"),
    "a long name of a glass": (f'ambient = "{"x" * 1_000_000}"', "unknown glass"),
    "a long name": (f'[[objects]]\nname = "{"x" * 1000}"', "a text of at most 200 characters"),
    "too large a file": ("#" * (4 * 1024 * 1024 + 1), "at most 4 MB"),
    "wrong wavelengths without end": (
        '[[emitters]]\ntype = "point"\nposition = [0, 0, 0]\nflux = 1\n'
        f'spectrum = {{ type = "table", values = [1, 1], wavelength_nm = [{"true," * 200_000}] }}',
        "must be a number",
    ),
    "objects without end": ("[[objects]]\n" * 10_000, "… and 901 more"),
    "too large a film": (
        "[film]\nwidth = 16384\nheight = 16384\nbands = 100",
        "at most 268435456 samples",
    ),
    "absurd lengths": (SPHERE.format("1e300") + 'material = { type = "absorber" }', "at most 1e"),
    "waves without end": (
        '[[objects]]\nmaterial = { type = "absorber" }\nshape = { type = "heightfield",'
        "position = [0, 0, 0], size = [1, 1], cells = [1000, 1000], waves = ["
        + "{ amplitude = 0.1, period = 1 }," * 40
        + "] }",
        "at most 33554432 samples of waves in all of the scene",
    ),
    "cells without end": (
        '[[objects]]\nmaterial = { type = "absorber" }\nshape = { type = "heightfield", depth = 1,'
        "position = [0, 0, 0], size = [1, 1], cells = [1000, 1000],"
        "waves = [{ amplitude = 0.1, period = 1 }] }",
        "at most 2097152 triangles in all of the scene",
    ),
    "corners without end": (
        "".join(
            f'[[objects]]\nmaterial = {{ type = "absorber" }}\nshape = {{ type = "polyhedron",'
            f"position = [{3 * i}, 0, 0], vertices = {ROUND} }}\n"
            for i in range(65)
        ),
        "at most 16777216 pairs of a polyhedron's corners",
    ),
    "a crowd": (
        "".join(
            SPHERE.format(0) + f'name = "{i}"\n' + GLASS.format(1.5)
            for i in range(450)
        ),
        "at most 100000 pairs",
    ),
}


@pytest.mark.parametrize(("text", "words"), HOSTILE.values(), ids=HOSTILE)
def test_a_hostile_file_ends_in_one_short_error(text, words) -> None:
    start = time.process_time()
    with pytest.raises(scenes.SceneError) as caught:
        scenes.loads(text)
    message = str(caught.value)
    assert words in message
    assert len(message) < 20_000
    assert max(map(len, message.splitlines())) < 1500
    # Not a measure of speed: the bound that is promised, a hundred times what these take.
    assert time.process_time() - start < 5.0


def test_of_many_clashes_some_are_told() -> None:
    text = "".join(SPHERE.format(0) + GLASS.format(1.5 + i / 1e3) for i in range(30))
    with pytest.raises(scenes.SceneError) as caught:
        scenes.loads(text)
    assert len(caught.value.problems) == 20


def test_a_percentage_is_guessed() -> None:
    text = SPHERE.format(0) + 'material = { type = "lambertian", reflectance = 80 }'
    with pytest.raises(scenes.SceneError, match=r"did you mean 0\.8 \(it looks like a percentage"):
        scenes.loads(text)


@pytest.fixture
def pipe(tmp_path):
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)
    return path


@pytest.mark.parametrize("command", ["explain", "info"])
@pytest.mark.parametrize("name", ["pipe", "/dev/zero", "."])
def test_what_is_no_file_is_not_waited_for(command, name, pipe, capfd) -> None:
    path = str(pipe) if name == "pipe" else name
    assert main([command, path]) == 2
    told = capfd.readouterr().err
    assert "Is a directory" in told if name == "." else "a pipe, a device or a socket" in told


def mesh_scene(folder: Path, file: str) -> Path:
    (folder / "scenes").mkdir()
    (folder / "part.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    path = folder / "scenes" / "bench.toml"
    path.write_text(
        f'[[objects]]\nshape = {{ type = "mesh", position = [0, 0, 0], file = "{file}" }}\n'
        'material = { type = "absorber" }\n[[emitters]]\ntype = "point"\nposition = [0, 1, 1]\n'
        'flux = 1\nspectrum = "D65"\n'
    )
    return path


def test_files_outside_are_read_where_that_is_allowed(tmp_path, capfd) -> None:
    path = mesh_scene(tmp_path, "../part.obj")
    with pytest.raises(scenes.SceneError, match=r"unless --allow-outside; is '\.\./part\.obj'"):
        scenes.load(path)
    assert main(["explain", str(path)]) == 2
    assert "objects[0].shape.file" in capfd.readouterr().err
    assert len(scenes.load(path, allow_outside=True).objects) == 1
    assert main(["explain", str(path), "--allow-outside"]) == 0


def test_a_device_is_no_mesh_even_where_all_is_allowed(tmp_path) -> None:
    path = mesh_scene(tmp_path, "/dev/zero")
    with pytest.raises(scenes.SceneError, match="there is no file"):
        scenes.load(path, allow_outside=True)


def test_the_fuzz_itself_notices_a_crash(tool, tmp_path, monkeypatch) -> None:
    def crash(*_arguments, **_options):
        raise IndexError("a reader's own")

    fuzz = tool["fuzz_scenes"].Fuzz(1, tmp_path)
    monkeypatch.setattr(scenes, "load", crash)
    with contextlib.suppress(IndexError), warnings.catch_warnings():
        fuzz.run(0)
    assert [number for number, _ in fuzz.defects] == [0]
