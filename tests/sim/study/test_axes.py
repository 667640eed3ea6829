import dataclasses

import numpy as np
import pytest

import scenes
import sim.study.standard_axes as standard
from sim.errors import SettingsError
from sim.method import Method
from sim.settings import RenderSettings
from sim.study import axes as registry
from sim.study.axes import Axis, axes, register_axis
from sim.study.media_variants import with_cauchy_media, with_tabulated_media
from sim.study.plan import CENTRE, QUICK, make_points, photon_scale, turns_of_points, work_of
from sim.study.setup import RESULTS, SeedSource, Setup


@pytest.fixture
def centre(small_scene):
    return Setup(small_scene, RenderSettings(radius=0.01, threads=2).resolved(small_scene))


@pytest.fixture
def rich_centre(small_scene):
    """Of a scene that has what some axes leave out."""
    ball, *others = small_scene.objects
    tinted = scenes.Dielectric(medium="SF11", absorption="published")
    objects = (ball.model_copy(update={"material": tinted}), *others)
    scene = small_scene.model_copy(update={"objects": objects})
    settings = RenderSettings(radius=0.01, threads=2, bounces=8)
    return Setup(scene, settings.resolved(scene))


@pytest.fixture
def own_registry(monkeypatch):
    monkeypatch.setattr(registry, "_REGISTRY", dict(registry._REGISTRY))


PARTS = {"settings": {"settings"}, "method": {"method", "settings"}, "scene": {"scene"},
         "estimator": {"estimator", "mesh_cells"}}
"""What an axis may change of a setup; those of the method vary photons too."""


@pytest.mark.parametrize("quick", [True, False])
def test_each_axis_changes_what_it_says_and_nothing_else(rich_centre, quick):
    centre = rich_centre
    for axis in axes():
        found = axis.vary(centre, quick)
        assert found, axis.name
        for value, setup in found.items():
            changed = {
                field.name
                for field in dataclasses.fields(Setup)
                if getattr(setup, field.name) != getattr(centre, field.name)
            }
            assert changed <= PARTS[axis.changes], (axis.name, value)
            assert changed or value == axis.default, (axis.name, value)


def test_what_a_scene_has_not_got_cannot_be_left_out(centre, rich_centre):
    found = {axis.name: axis for axis in axes()}
    assert not found["absorption"].vary(centre, False)
    assert not found["bounces"].vary(centre, False)
    assert list(found["bounces"].vary(rich_centre, False)) == ["0", "1", "2", "4"]
    clear = found["absorption"].vary(rich_centre, False)["none"].scene
    media = [one.material.resolved() for one in clear.objects[:1]]
    assert [medium.absorption for medium in media] == [None]
    assert media[0].dispersion == rich_centre.scene.objects[0].material.resolved().dispersion


def test_the_engines_choices_are_all_there(centre):
    found = {axis.name: axis.vary(centre, False) for axis in axes()}
    methods = {setup.method for values in found.values() for setup in values.values()}
    for field, others in {
        "sampler": {"r2", "random"}, "branching": {"roulette"}, "aiming": {"unaimed"},
        "fresnel": {"schlick", "none"},
    }.items():
        assert {Method(**{field: other}) for other in others} <= methods
    assert Method(sampler="random", branching="roulette", aiming="unaimed") in methods
    assert {one.estimator for one in found["estimator"].values()} == {"gather", "mesh"}
    assert found["precision"]["float32"].settings.precision == "float32"
    assert found["direct light"]["photons"].settings.direct_light == "photons"
    radii = [one.settings.radius for one in found["radius"].values()]
    assert min(radii) == pytest.approx(0.0025)
    assert max(radii) == pytest.approx(0.04)


def test_bands_divide_the_same_range(centre):
    for value, setup in next(a for a in axes() if a.name == "bands").vary(centre, True).items():
        film = setup.scene.film
        assert film.bands == int(value)
        np.testing.assert_allclose(
            film.edges_nm[[0, -1]], centre.scene.film.edges_nm[[0, -1]], rtol=1e-12
        )


def test_media_are_described_anew_as_well_as_they_can_be(small_scene):
    wavelength_nm = np.linspace(*small_scene.film.edges_nm[[0, -1]], 101)
    exact = small_scene.objects[0].material.resolved().eta(wavelength_nm)
    cauchy = with_cauchy_media(small_scene).objects[0].material
    table = with_tabulated_media(small_scene).objects[0].material
    assert isinstance(cauchy.medium, scenes.CauchyMedium)
    assert len(cauchy.medium.a) == 2
    # N-BK7 over 390 to 710 nm: 32″ of a 60° prism's deviation is about 1e-4 of index.
    off = np.abs(cauchy.resolved().eta(wavelength_nm) - exact).max()
    assert 1e-6 < off < 3e-4
    assert isinstance(table.medium, scenes.TableMedium)
    assert np.abs(table.resolved().eta(wavelength_nm) - exact).max() < 2e-5
    # Objects without dispersion stay as they are.
    assert with_cauchy_media(small_scene).objects[1] is small_scene.objects[1]


@pytest.mark.parametrize("rewrite", [with_cauchy_media, with_tabulated_media])
@pytest.mark.parametrize("absorption", ["published", scenes.NapierianAbsorption(coefficient=3.0)])
def test_media_described_in_another_way_keep_what_else_was_said_of_them(
    small_scene, rewrite, absorption
):
    ball, *others = small_scene.objects
    material = scenes.Dielectric(medium="SF11", absorption=absorption, priority=2)
    item = ball.model_copy(update={"material": material})
    scene = small_scene.model_copy(update={"objects": (item, *others)})
    found = rewrite(scene).objects[0].material
    assert found.priority == 2
    before, after = material.resolved().absorption, found.resolved().absorption
    assert after.napierian_per_m == before.napierian_per_m
    assert after.wavelength_nm == before.wavelength_nm


def test_a_later_feature_registers_its_axis_once(centre, own_registry):
    def vary(setup, quick):
        return {"none": setup.with_settings(max_interactions=7)}

    axis = Axis("fluorescence", "settings", ("picture",), "whether glass glows", "on", vary)
    assert register_axis(axis) is axis
    found = [one for one in make_points(centre, QUICK, RESULTS) if one.axis == "fluorescence"]
    assert [(one.value, one.results) for one in found] == [("none", ("picture",))]
    assert found[0].setup.settings.max_interactions == 7
    with pytest.raises(SettingsError, match="fluorescence"):
        register_axis(axis)


def test_points_share_the_centre_and_leave_out_what_cannot_change(centre):
    points = make_points(centre, QUICK, RESULTS)
    assert points[0].axis == points[0].value == CENTRE
    assert all(one.setup != centre for one in points[1:])
    assert all(one.results == ("bins",) for one in points if one.axis == "estimator")
    pictures = make_points(centre, QUICK, ("picture",))
    assert {one.results for one in pictures} == {("picture",)}
    assert "estimator" not in {one.axis for one in pictures}
    few = make_points(centre, dataclasses.replace(QUICK, axes=("photons",)), RESULTS)
    assert {one.axis for one in few} == {CENTRE, "photons"}
    assert work_of(few) == pytest.approx(1.0 + 1 / 16 + 1 / 4 + 4.0, rel=1e-2)


def test_every_point_runs_as_often_but_certain_ones_run_once(centre):
    points = make_points(centre, QUICK, RESULTS)
    turns = list(turns_of_points(3, points))
    for point in points:
        count = sum(one is point for _, one in turns)
        assert count == (1 if point.setup.estimator == "mesh" else 3)
    # Replicates are spread over the study.
    assert [one for _, one in turns[: len(points)]] == points


def test_the_centre_has_as_many_photons_as_time_allows():
    plan = dataclasses.replace(QUICK, replicates=2, points_s=100.0)
    # 10 runs of 1 s for the camera leave 40 s a replicate for photons, of which 20 runs take 8 s.
    assert photon_scale(plan, 20.0, 10, 1.0, 8.0) == 0.25
    assert photon_scale(plan, 20.0, 10, 1.0, 2.0) == 1.0
    assert photon_scale(plan, 20.0, 10, 100.0, 8.0) == 1 / 64


def test_no_seed_is_given_twice():
    seeds = SeedSource(5)
    assert [seeds.take() for _ in range(3)] == [5, 6, 7]


def test_ladders_hold_the_centre(centre):
    for quick in (True, False):
        assert 1 in standard.ladder(quick)
