"""What two runs differ in, by field path; files count by their content."""

import json

import numpy as np
import pytest
from PIL import Image

import scenes
import sim
from sim.resumption import fingerprint as module
from sim.resumption.fingerprint import fingerprint_of, list_differences

TETRAHEDRON = "v 0 0 0\nv {size} 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def fingerprint(scene, pictured=True, **settings):
    return fingerprint_of(scene, sim.RenderSettings(**settings).resolved(scene), pictured=pictured)


def paths(one, other):
    return [path for path, _, _ in list_differences(one, other)]


def test_the_same_run_has_the_same(small_scene):
    again = scenes.loads(small_scene.source_text, name="other name")
    assert list_differences(fingerprint(small_scene), fingerprint(again)) == []
    json.dumps(fingerprint(small_scene), allow_nan=False)


def test_words_threads_and_ends_may_differ(small_scene):
    text = small_scene.source_text.replace("A small scene", "Another title") + "# a comment\n"
    text = text.replace("passes = 2", "passes = 3")  # odd or below 4, both
    one = fingerprint(small_scene, threads=1)
    assert paths(one, fingerprint(scenes.loads(text), threads=2)) == []
    assert paths(
        fingerprint(small_scene, passes=4, target_error=0.1),
        fingerprint(small_scene, passes=400, time_budget=9.0, preset="draft", photons=2000),
    ) == []  # fmt: skip


@pytest.mark.parametrize(
    ("settings", "path", "stored", "asked"),
    [
        ({"seed": 1}, "settings.seed", "0", "1"),
        ({"photons": 1999}, "settings.photons", "2000", "1999"),
        ({"radius_pixels": 3}, "settings.radius_pixels", "2.0", "3.0"),
        ({"precision": "float32"}, "settings.precision", "float64", "float32"),
        ({"passes": 4}, "settings.passes", "odd, or fewer than 4", "even, and 4 or more"),
    ],
)
def test_settings_that_decide_are_told(small_scene, settings, path, stored, asked):
    found = list_differences(fingerprint(small_scene), fingerprint(small_scene, **settings))
    assert found == [(path, stored, asked)]


def test_a_radius_in_metres_stands_in_the_place_of_one_in_pixels(small_scene):
    assert list_differences(fingerprint(small_scene), fingerprint(small_scene, radius=0.1)) == [
        ("settings.radius", "None", "0.1"), ("settings.radius_pixels", "2.0", "None")
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("before", "after", "difference"),
    [
        ("N-BK7", "SF11", ("scene.objects.0.material.medium", "N-BK7", "SF11")),
        ("radius = 0.5", "radius = 0.25", ("scene.objects.0.shape.radius", "0.5", "0.25")),
        ("width = 12", "width = 13", ("scene.film.width", "12", "13")),
        ("flux = 1.0", "flux = 2.0", ("scene.emitters.0.flux", "1.0", "2.0")),
    ],
)
def test_what_the_scene_differs_in_is_told(small_scene, before, after, difference):
    other = scenes.loads(small_scene.source_text.replace(before, after))
    assert list_differences(fingerprint(small_scene), fingerprint(other)) == [difference]


def test_versions_are_told(small_scene, monkeypatch):
    one = fingerprint(small_scene)
    monkeypatch.setattr(module, "VERSION", "9.9.9")
    assert list_differences(one, fingerprint(small_scene)) == [
        ("program.version", one["program"]["version"], "9.9.9")
    ]
    assert paths(one, fingerprint(small_scene, pictured=False))[-1] != "scene"


def test_files_count_by_their_content(small_scene, tmp_path):
    text = small_scene.source_text.replace(
        'shape = {type = "sphere", position = [0.0, 1.0, 0.0], radius = 0.5}',
        'shape = {type = "mesh", file = "a.obj", position = [0.0, 1.0, 0.0]}',
    ).replace(
        '{type = "round", radius = 0.4}',
        '{type = "slit", width = 0.8, height = 0.8, mask = {file = "a.png"}}',
    )
    text += (
        '[[objects]]\nname = "water"\nmaterial = {type = "absorber"}\n'
        'shape = {type = "heightfield", position = [9, 9, 9], size = [1, 1], file = "a.npy"}\n'
    )

    def write(size=1.0, grey=200, height=0.0):
        (tmp_path / "a.obj").write_text(TETRAHEDRON.format(size=size))
        Image.fromarray(np.uint8([[grey, 255]])).save(tmp_path / "a.png")
        np.save(tmp_path / "a.npy", np.array([[0.0, 0.0], [0.0, height]]))
        return fingerprint(scenes.loads(text, folder=tmp_path))

    one = write()
    assert paths(one, write()) == []
    assert paths(one, write(size=2.0)) == ["scene.objects.0.shape.file"]
    assert paths(one, write(height=0.5)) == ["scene.objects.2.shape.file"]
    assert paths(one, write(grey=100)) == ["scene.emitters.0.profile.mask.file"]


def test_long_lists_are_known_by_their_digest(small_scene):
    def reflecting(value):
        floor = small_scene.objects[1]
        knots = [(400.0 + i, 0.5 if i else value) for i in range(50)]
        spectrum = dict(zip(("wavelength_nm", "value"), map(list, zip(*knots, strict=True)),
                            strict=True))
        return small_scene.model_copy(update={"objects": (
            small_scene.objects[0],
            floor.model_copy(update={"material": spectrum}),
        )})  # fmt: skip

    one, other = fingerprint(reflecting(0.5)), fingerprint(reflecting(0.4))
    assert paths(one, other) == ["scene.objects.1.material.value"]
    assert len(json.dumps(one)) < 5000


def test_another_number_of_objects_is_told_as_such(small_scene):
    fewer = small_scene.model_copy(update={"objects": small_scene.objects[1:]})
    assert list_differences(fingerprint(small_scene), fingerprint(fewer)) == [
        ("scene.objects", "2 of them", "1 of them")
    ]
