"""A run that memory will not hold does not begin, and is told what would fit."""

import re

import pytest

import sim
from sim.cli import main
from sim.memory import estimate as module
from sim.memory.prospect import foresee_memory

PLENTY = 1 << 50


def prospect(scene, pictured=True, **settings):
    plan = sim.RenderSettings(**settings).resolved(scene)
    return foresee_memory(scene, plan, pictured=pictured)


@pytest.fixture
def memory(monkeypatch):
    """Make it seem that there is so much [bytes]."""

    def limit(count):
        monkeypatch.setattr(module, "available_memory", lambda: count)

    return limit


def test_where_there_is_plenty_no_photon_is_traced_for_it(small_scene, memory, monkeypatch):
    monkeypatch.setattr(module, "estimate_memory", lambda *_, **__: 1 / 0)
    for count in (PLENTY, None):
        memory(count)
        sim.render(small_scene, sim.RenderSettings(photons=100, passes=1))


def test_photons_that_do_not_fit_are_refused_and_fewer_that_do_are_named(small_scene, memory):
    memory(100_000_000)
    with pytest.raises(sim.CapacityError) as caught:
        sim.render(small_scene, sim.RenderSettings(photons=10_000_000, passes=2))
    text = str(caught.value)
    assert re.search(r"needs about [\d.]+ GB \(program .*, film .*, photons .* million", text)
    photons, passes = map(int, re.search(r"lower photons to (\d+) \(and raise passes to (\d+)",
                                         text).groups())  # fmt: skip
    assert photons * passes == pytest.approx(2e7, rel=0.05)
    fits = prospect(small_scene, photons=photons, passes=passes)
    assert 0.6 * 100e6 < fits.total - fits.program <= 100e6


def test_a_film_that_does_not_fit_is_refused(small_scene, memory):
    film = small_scene.film.model_copy(update={"width": 4000, "height": 4000})
    large = small_scene.model_copy(update={"film": film})
    memory(1_000_000_000)
    with pytest.raises(sim.CapacityError, match=r"lower film\.width, film\.height or film\.bands"):
        sim.render(large, sim.RenderSettings(photons=100, passes=1))


def test_the_command_refuses_in_one_line(small_scene, memory, tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bench.toml").write_text(small_scene.source_text, "utf-8")
    memory(100_000_000)
    assert main(["render", "bench.toml", "--photons", "1e7"]) == 2
    *_, last = capfd.readouterr().err.splitlines()
    assert last.startswith("nephroid: error: this run needs about ")
    assert [path.name for path in tmp_path.iterdir()] == ["bench.toml"]


def test_explain_tells_it(small_scene, tmp_path, capsys):
    (tmp_path / "bench.toml").write_text(small_scene.source_text, "utf-8")
    assert main(["explain", str(tmp_path / "bench.toml")]) == 0
    assert "memory: the film takes 0 MB; " in capsys.readouterr().out
    assert main(["explain", "--memory", str(tmp_path / "bench.toml")]) == 0
    assert re.search(r"^memory: a run takes about [\d.]+ [MG]B \(program .* are there$",
                     capsys.readouterr().out, re.MULTILINE)  # fmt: skip


def test_what_it_grows_with(small_scene):
    one = prospect(small_scene, photons=20_000, passes=1)
    twice = prospect(small_scene, photons=40_000, passes=1)
    assert twice.photons == pytest.approx(2 * one.photons, rel=0.05)
    # Two passes are under way at once: the map that is gathered from comes on top.
    both = prospect(small_scene, photons=20_000, passes=2)
    assert 1.2 < both.photons / one.photons < 1.6
    film = small_scene.film.model_copy(update={"width": 24})
    wider = small_scene.model_copy(update={"film": film})
    assert prospect(wider, photons=20_000, passes=1).film == 2 * one.film


def test_sensors_count(small_scene):
    import scenes

    place = scenes.Disk(position=(0.0, 0.2, 0.0), normal=(0.0, 1.0, 0.0), radius=0.5)
    bins = scenes.IrradianceSensor(name="bins", shape=place, pixels=(1000, 1000))
    rays = scenes.RaySensor(name="rays", shape=place, max_rays=1000)
    seen = small_scene.model_copy(update={"sensors": (bins, rays)})
    found = prospect(seen, pictured=False, photons=10_000, passes=4)
    assert found.film == 0
    assert found.sensors > 1000 * 1000 * 4 * 8 * 2


def test_rays_that_a_sensor_keeps_of_many_passes_are_foreseen(small_scene, memory):
    import scenes

    place = scenes.Disk(position=(0.0, 0.2, 0.0), normal=(0.0, 1.0, 0.0), radius=0.5)
    rays = scenes.RaySensor(name="rays", shape=place, max_rays=10_000_000)
    seen = small_scene.model_copy(update={"sensors": (rays,)})
    memory(200_000_000)  # for 10 million rays it would be 1.7 GB

    def end(progress):
        assert progress.stage == "compile", "the run has begun"

    with pytest.raises(sim.CapacityError, match="lower max_rays"):
        sim.measure(seen, sim.RenderSettings(photons=1000, passes=100_000), progress=end)


def test_of_a_scene_without_a_camera_no_film_is_told(small_scene, tmp_path, capsys):
    text = small_scene.source_text
    start = text.index("[camera]")
    end = text.find("\n\n", start)
    (tmp_path / "bench.toml").write_text(text[:start] + (text[end:] if end >= 0 else ""), "utf-8")
    assert main(["explain", str(tmp_path / "bench.toml")]) == 0
    (line,) = [one for one in capsys.readouterr().out.splitlines() if one.startswith("memory: ")]
    assert "film" not in line
    assert "--memory tells what a run takes" in line
