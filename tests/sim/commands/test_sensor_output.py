"""The files of sensors, and what is printed about them."""

from pathlib import Path

import numpy as np
import pytest

import scenes
import sim
from sim.cli import main
from sim.commands.sensor_output import sensor_paths

SCENE = """\
[[emitters]]
type = "point"
position = [0, 1, 0]
flux = 1.0
spectrum = "E"

[[sensors]]
name = "the floor"
type = "irradiance"
shape = {type = "disk", position = [0, 0, 0], normal = [0, 1, 0], radius = 0.5}
pixels = [4, 4]

[[sensors]]
type = "rays"
shape = {type = "rectangle", position = [0, 0, 0], size = [1, 1]}
"""

SMALL = ["--photons", "1000", "--passes", "2"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "bench.toml").write_text(SCENE, "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_without_a_camera_only_sensors_are_written(folder, capsys):
    assert main(["render", "bench.toml", *SMALL, "--verbose"]) == 0
    names = {one.name for one in folder.iterdir()}
    assert names == {
        "bench.toml", "bench.the-floor.exr", "bench.the-floor.npz", "bench.sensors-1.npz"
    }
    printed = capsys.readouterr().out
    assert "bench.the-floor.exr and bench.the-floor.npz: 4 × 4 cells, 31 bands; " in printed
    assert "bench.sensors-1.npz: " in printed
    assert "escaped" in printed
    measured = sim.measure(
        scenes.load(folder / "bench.toml"), sim.RenderSettings(photons=1000, passes=2)
    ).sensors["the floor"]
    with np.load(folder / "bench.the-floor.npz") as held:
        np.testing.assert_array_equal(held["irradiance"], measured.irradiance)
    assert main(["info", "bench.the-floor.exr"]) == 0
    assert "band means of irradiance, W m^-2 nm^-1" in capsys.readouterr().out


def test_books_of_a_sensor_with_bands_of_its_own_are_those_of_the_film(folder, capsys):
    # As many as the film has, of other places, would be told from theirs by nothing.
    film = "[film]\nbands = 2\nfirst_nm = 450\nlast_nm = 650\n\n"
    for bands in (3, 2):
        own = SCENE.replace("pixels = [4, 4]", f"pixels = [4, 4]\nbands = {bands}")
        (folder / "bench.toml").write_text(film + own, "utf-8")
        assert main(["render", "bench.toml", *SMALL]) == 0
        assert main(["info", "bench.the-floor.exr"]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert [line.split()[:2] for line in lines[-2:]] == [["450", "nm"], ["650", "nm"]]


def test_a_picture_still_needs_a_camera(folder, capsys):
    assert main(["render", "bench.toml", *SMALL, "--png", "bench.png"]) != 0
    assert "camera: missing; a picture needs" in capsys.readouterr().err
    assert [one.name for one in folder.iterdir()] == ["bench.toml"]


def test_files_that_cannot_be_written_are_found_before_any_work(folder, capsys):
    (folder / "bench.sensors-1.npz").mkdir()
    assert main(["render", "bench.toml", *SMALL]) != 0
    assert "bench.sensors-1.npz" in capsys.readouterr().err
    assert not (folder / "bench.the-floor.exr").exists()


def test_names_make_file_names_that_do_not_collide():
    place = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0))
    names = ("a/b", "a b", "A-B", "../up", "größe", "…")
    scene = scenes.Scene(
        sensors=tuple(scenes.RaySensor(name=name, shape=place) for name in names)
    )
    paths = sensor_paths(scene, Path("some") / "out.v2.exr")
    assert [one.name for one in paths.values()] == [
        "out.v2.a-b", "out.v2.a-b-2", "out.v2.A-B-3", "out.v2.up", "out.v2.größe", "out.v2.sensor",
    ]
    assert {one.parent for one in paths.values()} == {Path("some")}
