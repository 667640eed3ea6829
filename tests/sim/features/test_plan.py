"""What a scene requires of the code that is compiled for it, and what may be left out."""

import dataclasses

import pytest

import scenes
import sim
from sim.features import (
    Feature,
    Features,
    Subject,
    Verdict,
    find_features,
    judge_features,
    needed,
    null,
    plan_features,
    register,
    registered,
    registry,
)
from spectra import Cauchy, Medium, Tabulated, glass

NOTHING = Features(
    spheres=False, flats=False, polyhedra=False, lenses=False, sellmeier=False, cauchy=False,
    tabulated=False, air_conversion=False, boundaries=False, reflected_branches=False,
    dispersion=False, beams=False, sphere_lamps=False, rectangle_lamps=False,
    distant_lamps=False, masks=False, thin_lens=False, visible_lamps=False, pixel_filter=False,
    interfaces=False, absorption=False, finishes=False, meshes=False, interreflection=False,
    sensors=False, polarisers=False, polarisation=False, stokes=False, camera_stokes=False,
)  # fmt: skip
AMBIENT = Medium("reference", Cauchy((1.0,)), (0.0, 1e9), "", "air")
TABLE = Medium("table", Tabulated((400.0, 700.0), (1.5, 1.4)), (400.0, 700.0), "", "air")
ORIGIN = (0.0, 0.0, 0.0)


def scene_of(*shapes, material=None, **fields):
    material = material or scenes.Absorber()
    objects = [scenes.SceneObject(shape=one, material=material) for one in shapes]
    return scenes.Scene(objects=objects, **fields)


SHAPES = {
    "spheres": [scenes.Sphere(position=ORIGIN, radius=1.0)],
    "flats": [
        scenes.Rectangle(position=ORIGIN, size=(1.0, 1.0)),
        scenes.Disk(position=ORIGIN, normal=(0.0, 1.0, 0.0), radius=1.0),
        scenes.Plane(position=ORIGIN, normal=(0.0, 1.0, 0.0)),
    ],
    "polyhedra": [
        scenes.Box(position=ORIGIN, size=(1.0, 1.0, 1.0)),
        scenes.Prism(position=ORIGIN, apex_deg=60.0, base=1.0, length=1.0),
        scenes.Polyhedron(
            position=ORIGIN,
            vertices=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        ),
    ],
    "meshes": [
        scenes.HeightField(position=ORIGIN, size=(1.0, 1.0), heights=((0.0, 0.0), (0.0, 0.0))),
    ],
    "lenses": [
        scenes.Lens(
            position=ORIGIN, thickness=0.1, aperture=0.5,
            first=scenes.LensSurface(radius=1.0), second=scenes.LensSurface(radius=-1.0),
        )
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("flag", "shape"), [(flag, shape) for flag, shapes in SHAPES.items() for shape in shapes]
)
def test_a_shape_asks_for_its_own_code_only(flag, shape):
    found = find_features(scene_of(shape), [AMBIENT], [0])
    assert found == dataclasses.replace(NOTHING, cauchy=True, **{flag: True})


def test_an_empty_scene_asks_for_no_shape():
    assert find_features(scene_of(), [AMBIENT], [0]) == dataclasses.replace(NOTHING, cauchy=True)


@pytest.mark.parametrize(
    ("medium", "flag"), [(glass("F2"), "sellmeier"), (AMBIENT, "cauchy"), (TABLE, "tabulated")]
)
def test_a_medium_asks_for_its_own_formula_only(medium, flag):
    found = find_features(scene_of(), [medium], [0])
    assert found == dataclasses.replace(NOTHING, **{flag: True})


@pytest.mark.parametrize("powers", [[0, 1], [0, -1]])
def test_air_is_converted_where_any_medium_needs_it(powers):
    found = find_features(scene_of(), [AMBIENT, glass("water")], powers)
    assert found.air_conversion
    assert found.media_count == 2


def test_equal_features_are_one_key():
    # Kernels are cached by them.
    a, b = (find_features(scene_of(*SHAPES["flats"]), [AMBIENT], [0]) for _ in range(2))
    assert {a: 1}[b] == 1


def judge(scene, **settings):
    return plan_features(scene, sim.RenderSettings(**settings).resolved(scene))


def decision(plan, name):
    (one,) = [one for one in plan.decisions if one.feature.name == name]
    return one


@pytest.fixture
def registering(monkeypatch):
    """`register`, for the time of one test."""
    monkeypatch.setattr(registry, "_registered", dict(registry._registered))
    return register


def dummy(name, verdict):
    return Feature(name=name, what="nothing", judge=lambda _: verdict)


BALL, FLOOR = SHAPES["spheres"][0], SHAPES["flats"][0]
CONSTANT = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
BK7 = scenes.Dielectric(medium="N-BK7")


@pytest.mark.parametrize(
    ("fields", "flags"),
    [
        ({"material": BK7}, (True, True, True)),
        ({"material": CONSTANT}, (True, True, False)),
        ({"material": scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.0))},
         (True, False, False)),
        # The same glass inside and outside: η = n/n = 1, at every wavelength, to the last bit.
        ({"material": BK7, "ambient": "N-BK7"}, (True, False, True)),
        # Air disperses, and comes in where an index is relative to it and the ambient is vacuum.
        ({"material": CONSTANT, "ambient": "vacuum"}, (True, True, True)),
        ({}, (False, False, False)),
    ],
)  # fmt: skip
def test_light_at_boundaries_is_as_the_media_ask(fields, flags):
    features = judge(scene_of(BALL, **fields)).features
    found = features.boundaries, features.reflected_branches, features.dispersion
    assert found == flags


@pytest.mark.parametrize(
    ("fields", "direct_light", "flags"),
    [
        ({"material": BK7}, "lamps", (True, False)),
        ({"material": BK7}, "photons", (False, True)),
        ({"material": CONSTANT}, "lamps", (True, True)),
        ({"material": CONSTANT}, "photons", (False, True)),
        # Any boundary with water disperses.
        ({"material": CONSTANT, "ambient": "water"}, "lamps", (True, False)),
    ],
)
def test_direct_and_undispersed_light_are_as_the_settings_ask(fields, direct_light, flags):
    features = judge(scene_of(BALL, **fields), direct_light=direct_light).features
    assert (features.direct_light, features.undispersed_photons) == flags


PLACE = {"position": (0.0, 5.0, 0.0), "flux": 1.0, "spectrum": "E"}
LAMPS = {
    "beams": scenes.Beam(
        direction=(0.0, -1.0, 0.0), profile=scenes.RoundProfile(radius=0.3), **PLACE
    ),
    "sphere_lamps": scenes.SphereLamp(radius=0.1, **PLACE),
    "rectangle_lamps": scenes.RectangleLamp(size=(1.0, 1.0), normal=(0.0, -1.0, 0.0), **PLACE),
    "neither": scenes.Point(**PLACE),
}


@pytest.mark.parametrize("flag", LAMPS)
def test_a_lamp_asks_for_its_own_shadow_rays_only(flag):
    scene = scene_of(FLOOR, emitters=[LAMPS[flag]])
    some, none = (judge(scene, direct_light=how).features for how in ("lamps", "photons"))
    lamps = [name for name in LAMPS if name != "neither"]
    assert {name: getattr(some, name) for name in lamps} == {name: name == flag for name in lamps}
    assert not any(getattr(none, name) for name in lamps)


def test_without_settings_nothing_that_they_decide_is_left_out():
    features = find_features(scene_of(BALL, material=BK7), [AMBIENT, glass("N-BK7")], [0, 0])
    assert features.direct_light
    assert features.undispersed_photons


def test_every_flag_is_registered_exactly_once():
    flags = [field.name for field in dataclasses.fields(Features) if field.type is bool]
    assert sorted(one.flag for one in registered() if one.flag is not None) == sorted(flags)
    assert all(getattr(Features(), flag) for flag in flags)  # unknown means on


def test_a_name_or_a_flag_is_not_registered_twice(registering):
    spheres = next(one for one in registered() if one.flag == "spheres")
    with pytest.raises(ValueError, match="named 'spheres' is registered already"):
        registering(spheres)
    with pytest.raises(ValueError, match="'more spheres': 'spheres' has the flag 'spheres'"):
        registering(dataclasses.replace(spheres, name="more spheres"))


def test_a_new_feature_takes_part_in_everything(registering):
    registering(dummy("fluorescence", Verdict("α L is at most 3e-7", 3e-7)))
    plan = judge(scene_of(BALL, material=BK7))
    assert not decision(plan, "fluorescence").on
    # … and some 1e-12 of Stokes vectors, which a ball does not need.
    assert plan.bound == pytest.approx(3e-7, abs=1e-11)
    assert plan.report()["off"]["fluorescence"] == 3e-7
    assert plan.report()["bound"] == plan.bound


def test_what_is_not_known_is_on(registering):
    registering(dummy("ripples", None))
    one = decision(judge(scene_of(BALL)), "ripples")
    assert one.on
    assert one.reason == "not known to be useless"


def test_an_omission_is_refused_where_the_sum_would_pass_the_tolerance(registering):
    # 3e-7 + 4e-7 ≤ 1e-6 < 3e-7 + 4e-7 + 5e-7: the largest one is switched on instead.
    for name, bound in (("a", 5e-7), ("b", 3e-7), ("c", 4e-7)):
        registering(dummy(name, Verdict("small", bound)))
    plan = judge(scene_of(BALL))
    assert [decision(plan, name).on for name in "abc"] == [True, False, False]
    assert plan.bound == pytest.approx(7e-7, rel=1e-15)
    assert "refused" in decision(plan, "a").reason
    assert judge(scene_of(BALL), omission_tolerance=1.3e-6).bound == pytest.approx(1.2e-6)
    assert judge(scene_of(BALL), omission_tolerance=0).bound == 0.0


def test_what_the_user_chose_is_neither_refused_nor_summed():
    plan = judge(scene_of(BALL, material=BK7), precision="float32")
    one = decision(plan, "double precision")
    assert not one.on
    assert 0.0 < one.bound <= 1.0
    assert plan.bound <= 1e-11  # of Stokes vectors, which a ball does not need
    assert plan.report()["asked_for"] == ["double precision"]
    assert not decision(plan.complete("why not"), "double precision").on


def test_what_the_user_chose_takes_no_room_from_the_rest(registering):
    registering(dummy("chosen", Verdict("asked for", 4e-7, chosen=True)))
    registering(dummy("small", Verdict("small", 9e-7)))
    plan = judge(scene_of(BALL))
    assert not decision(plan, "chosen").on
    assert not decision(plan, "small").on
    assert plan.bound == 9e-7


def test_all_features_can_be_asked_for(registering):
    registering(dummy("small", Verdict("small", 1e-9)))
    plan = judge(scene_of(), features="all")
    assert plan.features == Features(media_count=1)
    assert all(one.on for one in plan.decisions)
    assert plan.bound == 0.0


@pytest.mark.parametrize("verdict", [needed("so"), null("so")])
def test_reasons_are_handed_on(registering, verdict):
    registering(dummy("dummy", verdict))
    one = decision(judge(scene_of(BALL), omission_tolerance=0.1), "dummy")
    assert (one.on, one.reason) == (verdict.bound == 1.0, "so")


def test_a_subject_needs_no_settings():
    plan = judge_features(Subject(scene_of(BALL), (AMBIENT,), (0,)))
    assert plan.tolerance == plan.bound == 0.0
