"""Kernels that leave features out make the same light as the full ones, or a canary notices."""

import dataclasses
import json
import logging

import numpy as np
import pytest

import scenes
import sim
from sim.canary import CanaryReport, choose_kernels
from sim.device import start_device
from sim.features import Features, Verdict, null, plan_features, registered, registry
from sim.image.exr_reading import read_exr

FLAGS = {one.flag for one in registered() if one.flag is not None}


def small(scene):
    """A gallery scene with a picture of few pixels."""
    film = scene.film.model_copy(update={"width": 24, "height": 16, "bands": 4})
    return scene.model_copy(update={"film": film})


def without_glass(small_scene):
    return small_scene.model_copy(update={"objects": small_scene.objects[1:]})


def matched(small_scene):
    """A ball of glass in that glass, over a block: no contrast, no flat, no Cauchy formula."""
    ball, floor = small_scene.objects
    block = scenes.Box(position=(0.0, -0.5, 0.0), size=(4.0, 1.0, 4.0))
    objects = (ball, floor.model_copy(update={"shape": block}))
    return small_scene.model_copy(update={"objects": objects, "ambient": "N-BK7"})


def constant(small_scene):
    """A ball of glass without dispersion: it shines in all bands at once."""
    ball, floor = small_scene.objects
    glass = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
    objects = (ball.model_copy(update={"material": glass}), floor)
    return small_scene.model_copy(update={"objects": objects})


CASES = {
    "ball": (lambda own: own, {}),
    "prism": (lambda _: small(scenes.load("prism")), {}),
    "lens": (lambda _: small(scenes.load("lens")), {}),
    "constant": (constant, {}),
    "without glass": (without_glass, {"direct_light": "photons"}),
    "matched": (matched, {}),
}


def settings_of(case, **settings):
    return sim.RenderSettings(photons=3000, passes=1, **CASES[case][1], **settings)


def left_out(scene, settings):
    features = plan_features(scene, settings.resolved(scene)).features
    return {flag for flag in FLAGS if not getattr(features, flag)}


@pytest.mark.parametrize("case", CASES)
def test_what_is_left_out_changes_the_last_digits_at_most(small_scene, case):
    scene = CASES[case][0](small_scene)
    assert left_out(scene, settings_of(case))
    required, full = (
        sim.render(scene, settings_of(case, features=features)) for features in ("required", "all")
    )
    # The compiler orders and fuses the instructions of another kernel in another way: some ulps,
    # over some tens of surfaces that a path meets.
    brightest = full.spectral_radiance.max()
    np.testing.assert_allclose(
        required.spectral_radiance, full.spectral_radiance, rtol=0.0, atol=1e-12 * brightest
    )
    rounding = {"rel": 1e-12, "abs": 1e-12 * full.energy.emitted}
    assert required.energy.totals == pytest.approx(full.energy.totals, **rounding)
    for one, other in zip(required.energy.by_band, full.energy.by_band, strict=True):
        assert one == pytest.approx(other, **rounding)
    assert brightest > 0.0
    asked = set(full.features["asked_for"])
    assert set(full.features["off"]) == asked
    off = required.features["off"]
    assert max(bound for name, bound in off.items() if name not in asked) <= 1e-12
    assert required.features["canary"] is None  # it would cost seconds, and tell nothing


def test_every_flag_is_left_out_by_one_of_these_scenes(small_scene):
    out = [left_out(make(small_scene), settings_of(case)) for case, (make, _) in CASES.items()]
    assert set.union(*out) == FLAGS


def choose(scene, *, check=False, **settings):
    resolved = sim.RenderSettings(photons=3000, **settings).resolved(scene)
    return choose_kernels(scene, resolved, device=start_device("cpu"), check=check)


@pytest.mark.parametrize("case", ["ball", "prism", "lens"])
def test_the_canary_finds_equal_photons_one_by_one(small_scene, case):
    report = choose(CASES[case][0](small_scene), check=True).canary
    assert report.photons == 1000
    assert report.difference < 1e-15  # of the flux: some ulps, where kernels differ in them
    assert report.allowed == 1e-12


@pytest.fixture
def judging(monkeypatch):
    """Make a feature be judged otherwise."""

    def judge(name, verdict):
        wrong = dataclasses.replace(registry._registered[name], judge=lambda _: verdict)
        monkeypatch.setitem(registry._registered, name, wrong)

    return judge


def test_a_breach_forces_the_full_kernel(small_scene, judging, caplog, tmp_path):
    # Without reflection at the ball some 4 % of the light that meets it, and more at its rim, goes
    # elsewhere. The bound says a part in 10⁷.
    judging("reflected branches", Verdict("reflectances are small", 1e-7))
    settings = sim.RenderSettings(passes=1)
    with caplog.at_level(logging.WARNING, logger="nephroid"):
        picture = sim.render(small_scene, settings)
    (record,) = caplog.records
    assert record.getMessage().startswith("nephroid: warning: canary: 1000 photons differ by ")
    assert "\n" not in record.getMessage()
    canary = picture.features["canary"]
    assert not canary["passed"]
    assert canary["difference"] > 0.04
    assert canary["allowed"] == pytest.approx(1e-7, rel=1e-4)
    assert set(picture.features["off"]) == set(picture.features["asked_for"])
    full = sim.render(small_scene, dataclasses.replace(settings, features="all"))
    np.testing.assert_array_equal(picture.spectral_radiance, full.spectral_radiance)
    picture.save_exr(tmp_path / "out.exr")
    assert json.loads(read_exr(tmp_path / "out.exr").attribute("features")) == picture.features


def test_a_shape_that_is_wrongly_left_out_is_noticed(small_scene, judging):
    judging("spheres", null("none, by mistake"))
    assert choose(small_scene).canary is None
    choice = choose(small_scene, check=True)
    assert not choice.canary.passed
    assert choice.canary.difference == np.inf
    # All but what bounces = 0 asks for.
    assert choice.compiled.features == Features(media_count=2, interreflection=False)
    assert choice.report()["canary"]["difference"] == "other surfaces"
    json.dumps(choice.report(), allow_nan=False)


def test_the_canary_follows_light_from_diffuse_surface_to_surface(small_scene, judging):
    # The floor's light comes back from the ball and through it: it is there, and the same by both.
    choice = choose(small_scene, check=True, bounces=2)
    assert choice.compiled.features.interreflection
    assert choice.canary.passed
    judging("interreflection", null("none, by mistake"))
    wrong = choose(small_scene, check=True, bounces=2)
    assert not wrong.canary.passed
    assert wrong.compiled.features.interreflection


def test_an_omission_within_its_bound_passes(small_scene):
    # A glass whose index varies by Δ = 1e-10/1.5: wavelengths part by about as much, far less than
    # the bound for the worst ray, some 80 √Δ. What differs more is roulette, which the canary
    # plays for a hundredth of the bound; few photons come to that.
    table = scenes.TableMedium(wavelength_nm=(300.0, 900.0), eta=(1.5, 1.5 + 1e-10))
    ball, floor = small_scene.objects
    glass = ball.model_copy(update={"material": scenes.Dielectric(medium=table)})
    scene = small_scene.model_copy(update={"objects": (glass, floor)})
    choice = choose(scene, omission_tolerance=1e-2)
    assert not choice.compiled.features.dispersion
    assert not choice.compiled.data.bodies.numpy()["dispersive"].any()
    assert choice.canary.passed
    assert 0.0 < choice.canary.difference < 0.01 * choice.plan.bound
    assert 1e-5 < choice.plan.bound < 1e-3
    # The others that are left out have bounds of rounding.
    assert choice.report()["off"]["dispersion"] == pytest.approx(choice.plan.bound, abs=1e-11)
    # At the default tolerance it is refused.
    assert choose(scene).compiled.features.dispersion


def test_a_difference_is_what_is_allowed_or_a_breach():
    assert CanaryReport(1000, 1e-7, 1e-7).passed
    assert not CanaryReport(1000, 1.1e-7, 1e-7).passed
    assert not CanaryReport(1000, float("inf"), 1e-7).passed
    assert not CanaryReport(1000, float("nan"), 1e-7).passed
