"""The command `nephroid`: what it prints, how it fails, and that it fails in one message."""

import dataclasses
import json
import os
import subprocess
import sys

import pytest

import scenes
from sim.cli import main
from sim.version import VERSION


def fails(capfd, arguments, *parts):
    """Hold a command to exit status 2 and one message on stderr that has all of `parts`."""
    assert main(arguments) == 2
    captured = capfd.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("nephroid: error: ")
    assert captured.err.count("nephroid: error:") == 1
    assert "Traceback" not in captured.err
    for part in parts:
        assert part in captured.err


def test_help_lists_every_command(capfd):
    assert main(["--help"]) == 0
    shown = capfd.readouterr().out
    for command in ("render", "trace", "explain", "scenes", "glass", "spectrum", "info", "schema"):
        assert f"\n    {command} " in shown


def test_version(capfd):
    assert main(["--version"]) == 0
    assert capfd.readouterr().out == f"nephroid {VERSION}\n"


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ([], ["COMMAND", "see 'nephroid --help'"]),
        (["rendr"], ["invalid choice: 'rendr'", "render"]),
        (["render"], ["scene", "see 'nephroid render --help'"]),
        (["render", "prism", "--photons", "many"], ["--photons", "whole number", "'many'"]),
        (["render", "prism", "--photons", "1.5"], ["--photons", "'1.5'"]),
        (["render", "prism", "--photons", "inf"], ["--photons", "'inf'"]),
        (["render", "prism", "--precision", "half"], ["--precision", "float32", "float64"]),
        (["render", "prism", "--exposure", "nan"], ["--exposure", "'nan'"]),
        (["render", "prism", "-o", "out.png"], ["'out.png' does not end in .exr"]),
        (["render", "prism", "--png", "out.exr"], ["'out.exr' does not end in .png"]),
        (["trace", "prism", "-o", "out.pdf"], ["'out.pdf' does not end in .png or .svg"]),
        (["trace", "prism", "--wavelengths", "red"], ["--wavelengths", "'red'"]),
        (["render", "prism", "--frobnicate"], ["--frobnicate"]),
    ],
)
def test_bad_arguments(capfd, arguments, parts):
    fails(capfd, arguments, *parts)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--photons", "0"], ["photons: 0", "allowed"]),
        (["--photons", "-5"], ["photons: -5"]),
        (["--passes", "0"], ["passes: 0"]),
        (["--radius", "nan"], ["radius: nan"]),
        (["--radius", "0.1", "--radius-pixels", "2"], ["radius_pixels: 2.0", "radius in metres"]),
        (["--threads", "0"], ["threads: 0"]),
        (["--device", "gpu"], ["device: 'gpu'", "cuda:0"]),
        (["-o", "missing/out.exr"], ["'missing/out.exr'", "there is no folder"]),
        (["--png", "missing/out.png"], ["'missing/out.png'", "there is no folder"]),
        (["-o", "folder.exr"], ["'folder.exr'", "it is a folder"]),
    ],
)
def test_bad_settings_and_outputs_are_told_before_rendering(
    capfd, tmp_path, monkeypatch, arguments, parts
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.exr").mkdir()
    fails(capfd, ["render", "prism", *arguments], *parts)
    assert os.listdir(tmp_path) == ["folder.exr"]


@pytest.mark.parametrize("command", ["render", "trace"])
@pytest.mark.parametrize(
    ("scene", "parts"),
    [
        ("prsm", ["unknown scene", "prism"]),
        ("no_such.toml", ["no_such.toml", "no such file"]),
        ("bad.toml", ["bad.toml", "raduis", "radius", "BK9", "N-BK7"]),
        ("binary.toml", ["binary.toml"]),
        ("folder.toml", ["folder.toml"]),
    ],
)
def test_bad_scenes(capfd, tmp_path, monkeypatch, command, scene, parts):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "bad.toml").write_text(
        '[[objects]]\nshape = {type = "sphere", position = [0, 0, 0], raduis = 1}\n'
        'material = {type = "dielectric", medium = "BK9"}\n'
    )
    fails(capfd, [command, scene], *parts)
    assert sorted(os.listdir(tmp_path)) == ["bad.toml", "binary.toml", "folder.toml"]


def test_scenes_lists_the_gallery(capfd):
    assert main(["scenes"]) == 0
    lines = capfd.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(scenes.gallery())
    for name, line in zip(scenes.gallery(), lines, strict=True):
        assert line.endswith(scenes.load(name).title)


def test_schema_is_json(capfd):
    assert main(["schema"]) == 0
    assert json.loads(capfd.readouterr().out) == scenes.schema()


def test_info_tells_what_a_file_holds(capfd, tmp_path, synthetic_picture):
    path = tmp_path / "out.exr"
    synthetic_picture.save_exr(path)
    assert main(["info", str(path)]) == 0
    shown = capfd.readouterr().out
    for text in (
        "12 × 8 pixels", "4, centred on 430 to 670 nm", "W m^-2 sr^-1 nm^-1", VERSION,
        "CIE 1931 2 degree", "deposited           0.7 W", "photons             2000",
        "max_interactions    256",
    ):  # fmt: skip
        assert text in shown


def test_info_tells_what_was_left_out(capfd, tmp_path, synthetic_picture):
    features = {"on": ["flats", "lenses"], "off": {"spheres": 0.0, "small": 1e-7}, "asked_for": []}
    picture = dataclasses.replace(synthetic_picture, features=features)
    picture.save_exr(tmp_path / "out.exr")
    assert main(["info", str(tmp_path / "out.exr")]) == 0
    lines = capfd.readouterr().out.splitlines()
    at = lines.index("  features")
    assert lines[at + 1].split(maxsplit=1) == ["on", "flats, lenses"]
    assert lines[at + 2].split(maxsplit=1) == ["off", "spheres 0, small 1e-07"]
    assert lines[at + 3] == "  accuracy"


def test_info_gives_the_scene_back(capfd, tmp_path, synthetic_picture):
    path = tmp_path / "out.exr"
    synthetic_picture.save_exr(path)
    assert main(["info", "--scene", str(path)]) == 0
    assert capfd.readouterr().out == synthetic_picture.scene.source_text


def test_info_on_bad_files(capfd, tmp_path, synthetic_picture):
    path = tmp_path / "out.exr"
    fails(capfd, ["info", str(path)], str(path), "No such file")
    fails(capfd, ["info", str(tmp_path)], str(tmp_path), "directory")
    path.write_text("not an EXR")
    fails(capfd, ["info", str(path)], str(path), "not an OpenEXR file")
    synthetic_picture.save_exr(path)
    path.write_bytes(path.read_bytes()[:-200])
    fails(capfd, ["info", str(path)], str(path), "damaged or cut off")


def test_a_bug_is_not_passed_off_as_bad_input(monkeypatch):
    def broken():
        raise ValueError("a bug")

    monkeypatch.setattr(scenes, "schema", broken)
    with pytest.raises(ValueError, match="a bug"):
        main(["schema"])


def test_running_out_of_memory_is_told(capfd, monkeypatch):
    def greedy():
        raise MemoryError("Unable to allocate 8 TiB")

    monkeypatch.setattr(scenes, "schema", greedy)
    fails(capfd, ["schema"], "not enough memory: Unable to allocate 8 TiB")


def test_ctrl_c_is_one_line_and_status_130(capfd, monkeypatch):
    def interrupted():
        raise KeyboardInterrupt

    monkeypatch.setattr(scenes, "schema", interrupted)
    assert main(["schema"]) == 130
    assert capfd.readouterr() == ("", "nephroid: stopped\n")


def test_a_reader_that_stops_reading_is_no_error():
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-m", "sim.cli", "schema"]
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 0


def run_from_shell(arguments, **streams):
    """The command as a process of its own: its exit status and what is read from its pipes."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    environment.pop("PYTHONUNBUFFERED", None)
    command = [sys.executable, "-m", "sim.cli", *arguments]
    return subprocess.run(command, env=environment, text=True, check=False, **streams)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is full")
def test_a_full_disk_behind_the_output_is_told():
    with open("/dev/full", "w") as full:
        done = run_from_shell(["schema"], stdout=full, stderr=subprocess.PIPE)
        assert (done.returncode, done.stderr) == (2, "nephroid: error: No space left on device\n")
        # A few lines wait in a buffer until the end.
        done = run_from_shell(["scenes"], stdout=full, stderr=subprocess.PIPE)
        assert (done.returncode, done.stderr) == (2, "nephroid: error: No space left on device\n")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is full")
def test_a_message_that_cannot_be_written_changes_no_status(tmp_path):
    with open("/dev/full", "w") as full:
        for arguments, status in ((["info", str(tmp_path / "none.exr")], 2), (["schema"], 0)):
            done = run_from_shell(arguments, stdout=subprocess.DEVNULL, stderr=full)
            assert done.returncode == status
