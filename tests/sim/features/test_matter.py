"""When interfaces, absorption, mirrors and metals are compiled in, and what is said of them."""

import math

import pytest

import scenes
from sim.features import plan_features
from sim.features.boundary_error import BOUNDARIES
from sim.settings import RenderSettings

ORIGIN = (0.0, 0.0, 0.0)


def glass(absorption=None, priority=0, medium="N-BK7"):
    return scenes.Dielectric(medium=medium, absorption=absorption, priority=priority)


def constant(alpha):
    return scenes.NapierianAbsorption(coefficient=alpha)


def scene_of(*materials, gap=1.0, **fields):
    """Unit balls in a row."""
    return scenes.Scene(
        objects=[
            scenes.SceneObject(
                name=f"ball {k}", material=material,
                shape=scenes.Sphere(position=((2.0 + gap) * k, 0.0, 0.0), radius=1.0),
            )
            for k, material in enumerate(materials)
        ],
        **fields,
    )  # fmt: skip


def decide(scene, name, **settings):
    plan = plan_features(scene, RenderSettings(**settings).resolved(scene))
    return next(one for one in plan.decisions if one.feature.name == name)


WHITE = scenes.Lambertian(reflectance=0.5)


@pytest.mark.parametrize(
    ("materials", "gap", "on"),
    [
        ((glass(), glass()), 1.0, False),
        ((glass(), glass()), 0.0, True),
        ((glass(), glass()), -0.5, True),
        ((glass(), WHITE), 0.0, True),
        ((WHITE, scenes.Mirror()), 0.0, False),
        ((glass(),), 0.0, False),
    ],
)
def test_interfaces_are_on_where_glass_may_touch(materials, gap, on):
    decision = decide(scene_of(*materials, gap=gap), "interfaces")
    assert decision.on == on
    assert decision.bound == (1.0 if on else 0.0)
    if on:
        assert "ball 0 and ball 1" in decision.reason
    else:
        assert decision.reason == "no solid is near another object"


def test_interfaces_name_one_pair_and_count_the_rest():
    decision = decide(scene_of(*(glass() for _ in range(4)), gap=0.0), "interfaces")
    assert decision.reason.endswith("ball 0 and ball 1, and 2 pairs more")


def test_absorption_is_left_out_as_far_as_it_takes_next_to_nothing():
    # 1 − exp(−α L) of 8 diameters of the scene, here 2 m each.
    for alpha, on in ((1e-9, False), (1e-6, True), (3.0, True)):
        decision = decide(scene_of(glass(constant(alpha))), "absorption")
        expected = -math.expm1(-alpha * BOUNDARIES * 2.0)
        assert decision.bound == pytest.approx(expected, rel=1e-12)
        assert decision.on == on
    assert not decide(scene_of(glass()), "absorption").on
    assert decide(scene_of(glass(constant(0.0))), "absorption").bound == 0.0
    assert decide(scene_of(glass(constant(1e-9))), "absorption", omission_tolerance=0.0).on


def test_ways_through_what_is_all_around_know_no_bounds():
    ambient = scenes.ConstantMedium(eta=1.0, absorption=constant(1e-9))
    decision = decide(scene_of(WHITE, ambient=ambient), "absorption")
    assert decision.on
    assert decision.bound == 1.0


def test_what_absorbs_by_wavelength_disperses():
    table = scenes.CoefficientTable(wavelength_nm=(300.0, 900.0), values=(1.0, 2.0))
    plain = scenes.ConstantMedium(eta=1.5)
    grey = scene_of(glass(constant(1.0), medium=plain))
    tinted = scene_of(glass(scenes.NapierianAbsorption(coefficient=table), medium=plain))
    assert not decide(grey, "dispersion").on
    assert decide(tinted, "dispersion").on


@pytest.mark.parametrize(
    ("material", "finishes", "dispersion"),
    [
        (scenes.Mirror(), True, False),
        (scenes.Metal(metal="gold"), True, True),
        (WHITE, False, False),
    ],
)
def test_mirrors_and_metals_ask_for_their_code(material, finishes, dispersion):
    assert decide(scene_of(material), "mirrors and metals").on == finishes
    assert decide(scene_of(material), "dispersion").on == dispersion


def test_light_that_hidden_faces_alone_have_let_pass_may_be_in_the_map():
    assert not decide(scene_of(glass(), glass()), "undispersed photons").on
    assert decide(scene_of(glass(), glass(), gap=0.0), "undispersed photons").on
