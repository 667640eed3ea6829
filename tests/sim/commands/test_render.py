"""`nephroid render` on the real renderer: its files, its report, and Ctrl-C."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

import scenes
import sim
from sim.cli import main
from sim.photons.energy import EnergyBooks

SMALL = ["--photons", "1500", "--passes", "2", "--seed", "3"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory, small_scene):
    """A folder with the small scene, rendered once with default outputs."""
    folder = tmp_path_factory.mktemp("render")
    (folder / "bench.toml").write_text(small_scene.source_text, "utf-8")
    before = os.getcwd()
    os.chdir(folder)
    try:
        assert main(["render", "bench.toml", *SMALL]) == 0
    finally:
        os.chdir(before)
    return folder


def test_default_outputs_are_named_after_the_scene(folder):
    assert sorted(os.listdir(folder)) == ["bench.exr", "bench.png", "bench.toml"]


def test_the_files_are_those_of_the_python_interface(folder):
    scene = scenes.load(folder / "bench.toml")
    picture = sim.render(scene, sim.RenderSettings(photons=1500, passes=2, seed=3))
    image = sim.read_exr(folder / "bench.exr")
    np.testing.assert_array_equal(
        image.spectral_radiance, picture.spectral_radiance.astype(np.float32)
    )
    assert picture.spectral_radiance.max() > 0.0
    assert json.loads(image.attribute("settings")) == picture.settings.reproducing()
    energy = EnergyBooks(**json.loads(image.attribute("energy")))
    assert energy == picture.energy
    assert len(energy.by_band) == 4
    with Image.open(folder / "bench.png") as developed:
        np.testing.assert_array_equal(np.asarray(developed), picture.srgb)


def test_the_file_reproduces_itself_from_what_it_says(folder, tmp_path, capsys):
    assert main(["info", "--scene", str(folder / "bench.exr")]) == 0
    scene = scenes.loads(capsys.readouterr().out, name="bench")
    said = json.loads(sim.read_exr(folder / "bench.exr").attribute("settings"))
    sim.render(scene, sim.RenderSettings(**said)).save_exr(tmp_path / "again.exr")
    assert (tmp_path / "again.exr").read_bytes() == (folder / "bench.exr").read_bytes()


def test_outputs_exposure_and_report(folder, tmp_path, capfd):
    exr, png = tmp_path / "out.exr", tmp_path / "elsewhere.png"
    arguments = ["-o", str(exr), "--png", str(png), "--exposure", "-2.5", "--verbose"]
    assert main(["render", str(folder / "bench.toml"), *SMALL, *arguments]) == 0
    assert sorted(os.listdir(tmp_path)) == ["elsewhere.png", "out.exr"]
    assert sim.read_exr(exr).attributes["EV"] == -2.5
    with Image.open(png) as dark, Image.open(folder / "bench.png") as automatic:
        assert np.asarray(dark).mean() < np.asarray(automatic).mean()
    captured = capfd.readouterr()
    assert f"{exr} and {png}: 12 × 8, 4 bands" in captured.out
    for heading in ("energy", "emitted", "deposited", "residual", "energy [W]", "time", "gather"):
        assert heading in captured.out
    assert "photons" in captured.err  # Progress, in plain lines, since this is no terminal.
    assert "\x1b" not in captured.err


def test_the_png_stands_beside_the_exr(folder, tmp_path):
    exr = tmp_path / "out.exr"
    assert main(["render", str(folder / "bench.toml"), *SMALL, "-o", str(exr)]) == 0
    assert sorted(os.listdir(tmp_path)) == ["out.exr", "out.png"]


@pytest.mark.parametrize(
    ("remove", "missing"),
    [("[camera]", "camera"), ("[[emitters]]", "emitters"), ("lambertian", "objects")],
)
def test_a_scene_that_cannot_be_rendered_is_told(small_scene, tmp_path, capfd, remove, missing):
    text = small_scene.source_text
    if remove == "lambertian":
        text = text.replace('{type = "lambertian", reflectance = 0.8}', '{type = "absorber"}')
    else:
        start = text.index(remove)
        end = text.find("\n\n", start)
        text = text[:start] + (text[end:] if end >= 0 else "")
    (tmp_path / "bench.toml").write_text(text, "utf-8")
    arguments = ["render", str(tmp_path / "bench.toml"), "-o", str(tmp_path / "out.exr")]
    assert main(arguments) == 2
    error = capfd.readouterr().err
    assert error.count("nephroid: error: ") == 1
    assert f"{missing}: " in error
    assert os.listdir(tmp_path) == ["bench.toml"]


def test_a_disk_that_fills_up_leaves_no_file(folder, tmp_path, capfd, monkeypatch):
    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    exr = tmp_path / "out.exr"
    # 1, not 2: what was asked for was fine, and work has been done.
    assert main(["render", str(folder / "bench.toml"), *SMALL, "-o", str(exr)]) == 1
    *_, warned, last = capfd.readouterr().err.splitlines()
    assert warned.startswith("nephroid: warning: no checkpoint: ")
    assert last == f"nephroid: error: cannot write '{exr}': No space left on device"
    assert os.listdir(tmp_path) == []


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
def test_ctrl_c_stops_a_running_render_and_leaves_no_file(folder, tmp_path):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-m", "sim.cli", "render", str(folder / "bench.toml")]
    with subprocess.Popen(
        [*command, "--photons", "2e6", "--passes", "10000"],
        cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        lines = [process.stderr.readline()]  # It is under way.
        process.send_signal(signal.SIGINT)
        lines += process.stderr.readlines()
        out = process.stdout.read()
    assert process.returncode == 130
    assert out == ""
    assert lines[0].startswith("pass 1/10000, ")
    assert lines[-1] == "nephroid: stopped\n"
    assert not any("Traceback" in line for line in lines)
    assert os.listdir(tmp_path) == []


def test_the_achieved_error_is_told_and_drawn(folder, small_scene, capsys):
    arguments = ["render", str(folder / "bench.toml"), "-o", str(folder / "open.exr")]
    asked = ["--photons", "1500", "--target-error", "90%", "--time-budget", "10min"]
    assert main([*arguments, *asked, "--error-map", str(folder / "map.png")]) == 0
    told = capsys.readouterr().out
    assert "after 4 passes: target error" in told
    assert (folder / "map.png").read_bytes().startswith(b"\x89PNG")
    image = sim.read_exr(folder / "open.exr")
    stored = json.loads(image.attribute("accuracy"))
    assert f"error: {stored['relative_error']:.2%} (noise" in told
    assert image.attribute("stopping") == "target error"
    # The settings in the file render the same picture again.
    assert json.loads(image.attribute("settings"))["passes"] == 4
    for name in ("open.exr", "open.png", "map.png"):
        (folder / name).unlink()


@pytest.mark.parametrize(
    ("option", "value", "allowed"),
    [
        ("--target-error", "0%", "above 0"), ("--target-error", "200%", "at most 1"),
        ("--time-budget", "-5s", "above 0"), ("--time-budget", "soon", "invalid duration"),
        ("--preset", "best", "choose from"),
    ],
)
def test_bad_ends_are_refused(folder, option, value, allowed, capsys):
    try:
        status = main(["render", str(folder / "bench.toml"), f"{option}={value}"])
    except SystemExit as ended:
        status = ended.code
    assert status == 2
    told = capsys.readouterr().err
    assert allowed in told
    assert "Traceback" not in told
    assert sorted(os.listdir(folder)) == ["bench.exr", "bench.png", "bench.toml"]
