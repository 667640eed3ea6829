"""Render settings: what is refused, and where defaults come from."""

import dataclasses
import json
import math

import numpy as np
import pytest

import scenes
from sim.errors import SettingsError
from sim.settings import DEFAULTS, OPEN_PASSES, PRESETS, RenderSettings


@pytest.mark.parametrize(
    ("field", "value"),
    [
        *[("photons", value) for value in (0, -1, 1.5, 1e6, True, "many", 2**32 + 1)],
        *[("passes", value) for value in (0, -3, 2.0, math.nan)],
        *[("radius", value) for value in (0.0, -1.0, math.nan, math.inf, "0.1", True)],
        *[("alpha", value) for value in (0.0, 1.01, math.nan, -0.5)],
        *[("preset", value) for value in ("best", "", 1)],
        *[("target_error", value) for value in (0.0, -0.01, 1.5, math.nan, "1%")],
        *[("time_budget", value) for value in (0.0, -1.0, math.inf, math.nan, "60s")],
        *[("direct_light", value) for value in ("rays", None)],
        *[("polarisation", value) for value in ("Stokes", None)],
        *[("max_interactions", value) for value in (0, 2**20)],
        *[("seed", value) for value in (-1, 2**63, None)],
        *[("threads", value) for value in (0, 4096)],
        *[("device", value) for value in ("gpu", "cuda", "cuda:x", "", None, "cpu ")],
        *[("precision", value) for value in ("double", "float16", 64)],
        *[("features", value) for value in ("none", None, True, "full")],
        *[("omission_tolerance", value) for value in (-1e-9, 0.6, math.nan, "0", False, None)],
    ],
)
def test_bad_values_are_refused_by_name(field, value):
    with pytest.raises(SettingsError) as caught:
        RenderSettings(**{field: value})
    assert caught.value.field == field
    assert caught.value.value is value
    assert str(caught.value).startswith(f"{field}: {value!r} is not allowed; allowed: ")


def test_numpy_numbers_become_plain_ones():
    settings = RenderSettings(photons=np.int64(7), radius=np.float32(0.5), seed=np.uint8(3))
    assert (type(settings.photons), type(settings.radius), type(settings.seed)) == (int, float, int)
    assert json.loads(json.dumps(settings.reproducing()))["photons"] == 7


def test_nothing_tolerated_is_a_tolerance():
    assert RenderSettings(omission_tolerance=0).omission_tolerance == 0.0
    assert RenderSettings().omission_tolerance == 1e-6


def test_settings_are_keyword_only_and_frozen():
    with pytest.raises(TypeError):
        RenderSettings(1000)
    with pytest.raises(dataclasses.FrozenInstanceError):
        RenderSettings().photons = 1


def test_open_settings_come_from_the_scene_then_from_the_defaults(small_scene):
    resolved = RenderSettings(passes=3).resolved(small_scene)
    assert resolved.passes == 3  # Given.
    assert resolved.photons == 2000  # The scene's.
    assert resolved.max_interactions == DEFAULTS["max_interactions"]
    assert resolved.radius is None  # From the camera, later.
    assert resolved.threads >= 1
    assert isinstance(resolved, RenderSettings)
    left_open = {name for name, value in dataclasses.asdict(resolved).items() if value is None}
    assert left_open == {"radius", "preset", "target_error", "time_budget"}


def test_a_radius_in_the_scene_is_in_metres():
    scene = scenes.loads('title = "t"\nlength_unit = "mm"\n[render]\nradius = 5.0\n')
    assert RenderSettings().resolved(scene).radius == 0.005
    assert RenderSettings(radius=1.0).resolved(scene).radius == 1.0


def test_a_radius_in_pixels_that_is_asked_for_is_had_whatever_the_scene_says():
    scene = scenes.loads('title = "t"\n[render]\nradius = 5.0\n')

    def radii(**settings):
        resolved = RenderSettings(**settings).resolved(scene)
        again = RenderSettings(**resolved.reproducing()).resolved(scene)
        assert again == resolved.resolved(scene) == resolved
        return resolved.radius, resolved.radius_pixels

    assert radii() == (5.0, None)
    assert radii(radius=1.0) == (1.0, None)
    assert radii(radius_pixels=3.0) == (None, 3.0)
    plain = RenderSettings().resolved(scenes.loads('title = "t"\n'))
    assert (plain.radius, plain.radius_pixels) == (None, DEFAULTS["radius_pixels"])


def test_two_radii_are_refused():
    with pytest.raises(SettingsError, match="none beside a radius in metres"):
        RenderSettings(radius=1.0, radius_pixels=2.0)


def test_a_scene_without_render_table_takes_the_defaults():
    resolved = RenderSettings().resolved(scenes.loads('title = "t"\n'))
    assert {name: getattr(resolved, name) for name in DEFAULTS} == DEFAULTS


@pytest.mark.parametrize(("device", "precision"), [("cpu", "float64"), ("cuda:1", "float32")])
def test_precision_follows_the_device(small_scene, device, precision):
    assert RenderSettings(device=device).resolved(small_scene).precision == precision
    given = RenderSettings(device=device, precision="float32")
    assert given.resolved(small_scene).precision == "float32"


def test_resolving_twice_changes_nothing(small_scene):
    once = RenderSettings(photons=11).resolved(small_scene)
    assert once.resolved(small_scene) == once


def test_threads_do_not_count_as_what_reproduces_a_picture(small_scene):
    one, two = (RenderSettings(threads=n).resolved(small_scene) for n in (1, 2))
    assert one.reproducing() == two.reproducing()
    assert RenderSettings(**one.reproducing(), threads=1).resolved(small_scene) == one


def test_presets_are_in_terms_of_the_scenes_own_numbers(small_scene):
    standard, reference = (
        RenderSettings(preset=name).resolved(small_scene) for name in ("standard", "reference")
    )
    assert (standard.photons, standard.passes) == (2000, 2)
    factors = PRESETS["reference"]
    assert reference.photons == 2000 * factors.get("photons", 1.0)
    assert reference.passes == 2 * factors.get("passes", 1.0)
    assert reference.passes > standard.passes
    # What is given by number wins.
    assert RenderSettings(preset="reference", photons=7).resolved(small_scene).photons == 7


@pytest.mark.parametrize(("passes", "most"), [(None, OPEN_PASSES), (7, 8), (1, 4), (12, 12)])
def test_an_open_end_takes_whole_rounds_of_two(small_scene, passes, most):
    # So that the passes there were make the same rounds when they are given by number.
    open_end = RenderSettings(passes=passes, target_error=0.1).resolved(small_scene)
    assert open_end.is_open
    assert open_end.passes == most
    closed = open_end.closed(6)
    assert (closed.passes, closed.is_open) == (6, False)
