"""Costs: which features can be timed on a scene, with which two builds. No time is asserted."""

import dataclasses

import pytest

import sim
from sim import feature_costs
from sim.device import start_device
from sim.features import Cost, Feature, plan_features, registered


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(feature_costs, "PHOTONS", 500)
    monkeypatch.setattr(feature_costs, "PIXELS", 60)
    monkeypatch.setattr(feature_costs, "REPEATS", 3)


def narrowed(scene, *names, **settings):
    """Settings, and a plan of the named features alone: all others are on."""
    resolved = sim.RenderSettings(**settings).resolved(scene)
    plan = plan_features(scene, resolved)
    some = tuple(one for one in plan.decisions if one.feature.name in names)
    assert len(some) == len(names)
    return dataclasses.replace(plan, decisions=some), resolved


def test_separable_features_are_timed_and_other_required_ones_are_not(small_scene, few):
    names = ("reflected branches", "direct light", "spheres", "boundaries")
    plan, settings = narrowed(small_scene, *names, threads=2)
    ratios = feature_costs.measure_costs(
        plan, small_scene, settings, device=start_device("cpu")
    )
    # A sphere is there, and glass, and light takes no other way without them.
    assert ratios.keys() == {"reflected branches", "direct light"}
    assert all(ratio > 0.0 for ratio in ratios.values())


def test_without_a_camera_its_features_are_not_timed(small_scene, few):
    scene = small_scene.model_copy(update={"camera": None})
    plan, settings = narrowed(scene, "direct light")
    assert feature_costs.measure_costs(plan, scene, settings, device="cpu") == {}


def test_ratios_are_with_over_without(small_scene, few, monkeypatch):
    # The build at hand has no tables and has reflected branches.
    scene = small_scene.model_copy(update={"camera": None})
    plan, settings = narrowed(scene, "tables", "reflected branches")
    timed = []

    def ratio(one, other):
        timed.append((one, other))
        return 4.0

    monkeypatch.setattr(feature_costs, "_ratio", ratio)
    monkeypatch.setattr(feature_costs, "load_kernels", lambda *_, **__: None)
    ratios = feature_costs.measure_costs(plan, scene, settings, device=start_device("cpu"))
    # The full kernels differ in the tables alone here, and take as long.
    full = feature_costs.FULL_KERNELS["photons"]
    assert {name: ratios[name] for name in ("tables", "reflected branches", full)} == {
        "tables": 0.25, "reflected branches": 4.0, full: 0.25
    }  # fmt: skip
    assert timed[0][0] is timed[1][0]


@pytest.mark.parametrize("feature", registered(), ids=lambda one: one.name)
def test_switching_twice_changes_nothing(feature):
    build = ("float64", sim.features.Features(media_count=2))
    other = feature_costs._switched(feature, build)
    assert other != build
    assert feature_costs._switched(feature, other) == build


def test_a_feature_without_code_of_its_own_has_no_time():
    idea = Feature(name="idea", what="none", judge=lambda _: None)
    assert feature_costs._switched(idea, ("float64", sim.features.Features())) is None


def test_every_feature_has_a_recorded_cost_or_is_everywhere():
    # Flat receivers, glass and its formulas are in every gallery scene: nothing to compare with.
    without = {one.name for one in registered() if one.cost is None}
    assert without <= {"flats", "boundaries", "Sellmeier", "Cauchy"}
    assert all(isinstance(one.cost, Cost) for one in registered() if one.name not in without)
