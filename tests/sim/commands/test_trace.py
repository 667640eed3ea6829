"""`nephroid trace` on the real tracer."""

import os

import numpy as np
import pytest
from PIL import Image

from sim.cli import main


@pytest.fixture
def bench(tmp_path, small_scene, monkeypatch):
    (tmp_path / "bench.toml").write_text(small_scene.source_text, "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_default_output_is_named_after_the_scene(bench, capfd):
    assert main(["trace", "bench.toml", "--rays", "4"]) == 0
    assert capfd.readouterr() == ("bench-rays.png: 20 rays\n", "")
    with Image.open(bench / "bench-rays.png") as image:
        assert np.asarray(image).std() > 0.0


def test_svg_wavelengths_and_view(bench, capfd):
    arguments = ["-o", "rays.svg", "--rays", "3", "--wavelengths", "450,550,650", "--view", "yz"]
    assert main(["trace", "bench.toml", *arguments]) == 0
    assert capfd.readouterr().out == "rays.svg: 9 rays\n"
    assert (bench / "rays.svg").read_text("utf-8").startswith("<?xml")


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--rays", "0"], ["rays: 0"]),
        (["--wavelengths", "150"], ["150", "N-BK7", "300"]),
        (["--wavelengths", "0.55"], ["0.55", "micrometres"]),
        (["--wavelengths", "nan"], ["list of wavelengths", "'nan'"]),
        (["--wavelengths", "550,-1"], ["list of wavelengths", "'550,-1'"]),
        (["-o", "missing/rays.png"], ["there is no folder"]),
    ],
)
def test_bad_input_is_told_and_leaves_no_file(bench, capfd, arguments, parts):
    assert main(["trace", "bench.toml", *arguments]) == 2
    error = capfd.readouterr().err
    assert error.count("nephroid: error: ") == 1
    for part in parts:
        assert part in error
    assert os.listdir(bench) == ["bench.toml"]
