"""What rows say: effects at equal time, savings, advice, and how references are chosen."""

import dataclasses

import numpy as np
import pytest

from sim.study.advice import advise
from sim.study.caustic_mesh import CausticMesh, Resolution
from sim.study.comparison import compare_point
from sim.study.findings import bias_shows_from, effects, saving, slopes
from sim.study.outcome import Outcome, PhotonNoise, Row
from sim.study.picture_reference import picture_reference
from sim.study.plan import QUICK, Point
from sim.study.references import (
    MeshReference,
    Reference,
    bins_reference,
    mean_and_noise,
    mesh_reference,
)
from sim.study.report import encode_html
from sim.study.sample import Costs, Sample
from sim.study.setup import SeedSource
from sim.study.statistics import (
    Interval,
    certain_errors,
    gram_matrix,
    mean_interval,
    separate_errors,
)

CELLS = 2000
REPLICATES = 6


def make_row(axis, value, *, photons=1000, passes=8, noise=0.1, bias=0.0, cpu_s=1.0, seed=0):
    """A row of replicates 1 + bias + noise of the reference 1, that take cpu_s ± 1%."""
    rng = np.random.default_rng([seed, photons, passes])
    found = 1.0 + bias + noise * rng.standard_normal((REPLICATES, CELLS))
    times = cpu_s * (1.0 + 0.01 * rng.standard_normal(REPLICATES))
    return Row(
        axis=axis, value=value, result="bins", photons=photons, passes=passes,
        errors=separate_errors(gram_matrix(list(found), np.ones(CELLS))),
        cpu_s=mean_interval(times), cpu_of_replicate=times, parts_s=(cpu_s, 0.0, 0.0, 0.0),
    )


@pytest.fixture(scope="module")
def outcome():
    """Sobol-like photons with error N^-0.75, random ones with N^-0.5, and some values."""
    rows = [
        make_row("centre", "centre"),
        make_row("photons", "×4", photons=4000, noise=0.1 * 4**-0.75, cpu_s=4.0),
        make_row("photons", "×1/4", photons=250, noise=0.1 * 4**0.75, cpu_s=0.25),
        make_row("passes", "×2", passes=16, noise=0.1 * 2**-0.5, cpu_s=2.0),
        make_row("all three", "plain, ×1 photons", noise=0.7),
        make_row("all three", "plain, ×4 photons", photons=4000, noise=0.35, cpu_s=4.0),
        make_row("fast", "on", noise=0.1, cpu_s=0.5, seed=1),
        make_row("alike", "other", noise=0.1, seed=2),
        make_row("slow", "on", noise=0.2, cpu_s=1.0, seed=3),
        make_row("cheap", "on", noise=0.2, cpu_s=0.5, seed=4),
        make_row("wrong", "on", noise=0.1, bias=0.5, cpu_s=0.8, seed=5),
    ]
    mesh = dataclasses.replace(
        make_row("estimator", "mesh", seed=6), errors=certain_errors(1e-3),
        cpu_of_replicate=np.array([1.0]),
    )
    return Outcome(
        scene="bench", title="", plan=QUICK, cpu_s=1.0, scale=1.0, default_photons=1000,
        default_passes=8, coverage=1.0, bins_text="", rows=(*rows, mesh),
        references={"bins": Reference(np.ones(1), "photons", 1e-3, 0.0, "")},
    )


def test_pictures_are_judged_by_an_error_that_no_few_pixels_rule(outcome):
    # Ten times the relative L2 error, from a lamp's edge, but half the tempered one: error² × time
    # is a quarter.
    centre, lamp = (
        dataclasses.replace(
            make_row(axis, value, noise=noise, seed=7), result="picture", tempered=tempered
        )
        for axis, value, noise, tempered in (
            ("centre", "centre", 0.1, Interval(0.02, 0.019, 0.021)),
            ("seen", "lamp", 1.0, Interval(0.01, 0.0095, 0.0105)),
        )
    )
    (effect,) = effects(dataclasses.replace(outcome, rows=(centre, lamp)), "picture")
    assert effect.error == pytest.approx(0.5)
    assert effect.ratio.value == pytest.approx(0.25 * effect.time)
    assert effect.ratio.high < 1.0


def test_slopes_are_those_of_the_ladder(outcome):
    laws = slopes(outcome, "bins")
    # Relative errors over 2000 cells scatter by 1/√4000; over a factor of 16 in N that is 0.6%.
    assert laws["error"].slope.value == pytest.approx(-0.75, abs=0.02)
    assert laws["error"].points == 3 * REPLICATES
    assert laws["time"].slope.value == pytest.approx(-0.75, abs=0.02)  # time goes with N
    assert laws["noise"].points == 3


def test_effects_are_photons_for_the_same_error(outcome):
    found = {one.row.name: one for one in effects(outcome, "bins")}
    # error² × time over the centre's: twice the passes are no better; the others by hand. The
    # intervals of squares over 2000 cells are 2 √(1/4000) t/√6 and the like: 5%.
    assert found["passes: ×2"].ratio.value == pytest.approx(1.0, rel=0.06)
    assert found["fast: on"].ratio.value == pytest.approx(0.5, rel=0.06)
    assert found["slow: on"].ratio.value == pytest.approx(4.0, rel=0.06)
    assert found["photons: ×4"].ratio.value == pytest.approx(4.0 * 4**-1.5, rel=0.06)
    for one in found.values():
        assert one.ratio.low <= one.ratio.value <= one.ratio.high
    assert found["alike: other"].ratio.low < 1.0 < found["alike: other"].ratio.high


def test_the_plain_methods_need_is_counted_in_photons(outcome):
    # c = 0.49 · 8000; the ladder's error is 0.1 (1000/N)^0.75.
    for photons, factor in saving(outcome, "bins"):
        expected = 49.0 * (photons / 1000.0) ** 0.5
        assert factor.value == pytest.approx(expected, rel=0.06)
        assert factor.low < expected < factor.high
    still = [PhotonNoise(False, n, 8, np.full(3, 0.01 * 1000 / n)) for n in (1000, 4000)]
    plain = [PhotonNoise(True, 1000, 8, np.array([0.6, 0.7, 0.8]))]
    picture = dataclasses.replace(outcome, photon_noise=[*still, *plain])
    assert [factor.value for _, factor in saving(picture, "picture")] == pytest.approx([70.0, 70.0])


def test_with_the_camera_held_still_the_slope_is_the_photons_own(outcome):
    rows = tuple(dataclasses.replace(row, result="picture") for row in outcome.rows)
    still = [PhotonNoise(False, n, 8, np.full(3, n**-1.2)) for n in (250, 1000, 4000)]
    plain = [PhotonNoise(True, n, 8, np.full(3, 50.0 / n)) for n in (250, 4000)]
    picture = dataclasses.replace(outcome, rows=rows, photon_noise=[*still, *plain])
    law = slopes(picture, "picture")["photon noise"]
    assert law.slope.value == pytest.approx(-0.6)
    assert law.points == 9


def test_it_is_told_from_how_many_photons_on_the_bias_shows(outcome):
    # Noise is N^-0.6, the centre's bias B: they meet at N = B^(-1/0.6).
    bias = 0.02
    still = [PhotonNoise(False, n, 8, np.full(3, n**-1.2)) for n in (250, 1000, 4000)]
    centre = make_row("centre", "centre", noise=1e-4, bias=bias)
    rows = tuple(
        dataclasses.replace(row, result="picture")
        for row in (centre, *outcome.rows[1:])
    )
    picture = dataclasses.replace(outcome, rows=rows, photon_noise=still)
    assert bias_shows_from(picture) == pytest.approx(bias ** (-1 / 0.6), rel=1e-3)
    unbiased = dataclasses.replace(outcome.rows[0], result="picture")
    picture = dataclasses.replace(picture, rows=(unbiased, *rows[1:]))
    assert bias_shows_from(picture) is None


def test_theory_stands_beside_the_slopes(outcome):
    known = dataclasses.replace(outcome, dimensions={"bins": 3})
    # -1/2 - 1/6
    assert "(theory: -0.67, by 3 dimensions)" in "\n".join(advise(known, "bins"))
    assert "theory" not in "\n".join(advise(outcome, "bins"))
    page = encode_html(known).decode()
    assert page.count("-0.667, by 3 dimensions") == 2  # of error and noise, not of time


def test_advice_follows_from_the_numbers(outcome):
    text = "\n".join(advise(outcome, "bins"))
    sentence = {line.partition(":")[0]: line for line in advise(outcome, "bins")}
    assert "turn up photons in a pass first" in text
    better = next(v for k, v in sentence.items() if k.startswith("Worth trying"))
    assert "fast: on" in better
    assert "alike" not in better
    dearer = next(v for k, v in sentence.items() if k.startswith("Dearer"))
    assert {"slow: on", "cheap: on", "wrong: on"} <= {
        name.partition(" (")[0] for name in dearer.partition("time: ")[2].split(", ")
    }
    useless = sentence["Cost accuracy without saving time"]
    assert "slow: on" in useless
    assert "cheap: on" not in useless
    biased = next(v for k, v in sentence.items() if k.startswith("More biased than the centre"))
    assert "wrong: on" in biased
    assert "slow" not in biased
    assert "The centre itself" not in text
    assert "Error falls as photons to the power -0.7" in text
    assert "alike: other" in sentence["No difference shows for"]


def test_a_reference_is_held_against_the_smallest_error_of_chance(outcome):
    # 0.1 · 4^-0.75 = 0.035 is the smallest; the mesh, which states 1e-3 of itself, is left out.
    assert outcome.smallest_error("bins") == pytest.approx(0.1 * 4**-0.75, rel=0.03)
    assert outcome.reference_is_good("bins")
    poor = {"bins": dataclasses.replace(outcome.references["bins"], bias=4e-3)}
    assert not dataclasses.replace(outcome, references=poor).reference_is_good("bins")


def test_amounts_alone_have_a_pareto_set_of_their_own(outcome):
    names = [row.name for row in outcome.pareto("bins", amounts_only=True)]
    assert names == ["photons: ×1/4", "centre", "passes: ×2", "photons: ×4"]
    assert "fast: on" in [row.name for row in outcome.pareto("bins")]


def test_a_mesh_is_not_judged_by_a_mesh(small_scene):
    values = np.ones((2, 2, 1))
    sample = Sample(0, values, None, None, None, Costs(trace=1.0), stated_error=0.01)
    point = Point("estimator", "mesh", type("S", (), {"settings": QuickSettings})(), ("bins",))
    chain = FakeChain()
    for kind, expected in (("caustic mesh", 0.01), ("photons", 0.0)):
        reference = Reference(values, kind, 0.0, 0.0, "")
        row = compare_point(point, [sample], "bins", reference, chain, small_scene)
        assert row.errors.error.value == pytest.approx(expected)
        assert np.isnan(row.centroid_arcsec.value) == (kind == "caustic mesh")


class QuickSettings:
    photons, passes = 1, 1


class FakeBins:
    def bin_centres(self):
        return np.zeros((2, 2, 3)) + np.arange(3)


class FakeChain:
    bins, emitter, refractions, edges_nm = FakeBins(), "lamp", 2, np.array([400.0, 500.0])


def test_the_noise_of_a_mean_is_that_of_its_parts_over_the_root():
    rng = np.random.default_rng(7)
    parts = [1.0 + 0.3 * rng.standard_normal(CELLS) for _ in range(9)]
    mean, noise = mean_and_noise(parts)
    # 0.3/√9, known to 1/√(2 · 8 · 2000) = 0.6%; 4 σ. The mean's square is 1.
    assert noise == pytest.approx(0.1, rel=0.03)
    np.testing.assert_allclose(mean, np.mean(parts, axis=0))
    assert mean_and_noise(parts[:1])[1] == np.inf


def make_mesh(errors, values=1.0):
    return CausticMesh(
        irradiance=np.full((2, 2, 1), values), error=np.zeros((2, 2, 1)),
        edges_nm=np.array([400.0, 500.0]), order=2.0, mesh_error=errors[0],
        wavelength_error=errors[1], lamp_error=errors[2], landed=1.0, cut_fraction=0.0, emitted=1.0,
    )


class FakeWorkshop:
    """A workshop with a chain, whose meshes err as their resolution says."""

    chain = FakeChain()

    def bench(self, setup):
        return type("B", (), {"compiled": None})()


def test_a_mesh_is_refined_where_it_errs_most(monkeypatch, small_scene):
    asked = []

    def trace(compiled, bins, *, resolution, **_):
        asked.append(resolution)
        return make_mesh((0.1 / resolution.cells, 0.4 / resolution.wavelengths, 0.01))

    monkeypatch.setattr("sim.study.references.trace_caustic_mesh", trace)
    setup = type("S", (), {"scene": small_scene})()
    found = mesh_reference(FakeWorkshop(), setup, goal=0.03, cpu_s=10.0)
    # Wavelengths err most down to 0.4/64; cells and lamp points stay as they are.
    assert asked == [Resolution(cells=16, wavelengths=2**k, lamp_points=2) for k in range(1, 6)]
    assert (found.target, found.resolution) == ("ball", asked[-1])


@pytest.mark.parametrize(("stated", "kind"), [(1e-6, "caustic mesh"), (0.5, "photons")])
def test_the_reference_that_errs_less_is_taken_and_checked(monkeypatch, stated, kind):
    photons = Reference(np.full((2, 2, 1), 1.1), "photons", 0.01, 0.0, "")
    monkeypatch.setattr("sim.study.references._of_photons", lambda *_: photons)
    mesh = MeshReference(make_mesh((stated, 0.0, 0.0)), "ball", Resolution(cells=16))
    found = bins_reference(
        FakeWorkshop(), None, SeedSource(), mesh=mesh, goal=1e-9, cpu_s=1.0
    )
    assert found.kind == kind
    # |1 − 1.1|/1.1 = 0.091.
    assert "0.091 apart" in found.check
    easy = bins_reference(FakeWorkshop(), None, SeedSource(), mesh=mesh, goal=1.0, cpu_s=1.0)
    assert (easy.kind, easy.check) == ("caustic mesh", "")


def test_a_pictures_reference_narrows_its_kernel_until_noise_exceeds_bias(centre_setup):
    # Bias goes with the square of the radius, 0.4 r²; noise of a run is 0.02: at half the radius
    # 0.1 of bias, at a quarter 0.025, at an eighth 0.006 against 0.02/√4 = 0.01.
    rng = np.random.default_rng(8)
    radii = []

    class Studio:
        def run(self, setup, seed, results):
            radii.append(setup.settings.radius)
            colours = 1.0 + 0.02 * rng.standard_normal((50, 50, 3))
            bias = np.full((50, 50), 0.4 * setup.settings.radius**2)
            return Sample(seed, None, colours, bias, None, Costs())

    found = picture_reference(Studio(), centre_setup, SeedSource(), goal=1e-9, cpu_s=0.0)
    assert sorted(set(radii)) == [0.125, 0.25, 0.5]
    assert found.bias == pytest.approx(0.4 / 64.0, rel=0.01)
    assert found.noise == pytest.approx(0.01, rel=0.05)
    assert found.error == pytest.approx(np.hypot(found.noise, found.bias))
    radii.clear()
    picture_reference(Studio(), centre_setup, SeedSource(), goal=0.2, cpu_s=0.0)
    assert set(radii) == {0.5}


@pytest.fixture
def centre_setup(small_scene):
    from sim.settings import RenderSettings
    from sim.study.setup import Setup

    settings = RenderSettings(photons=100, passes=2, radius=1.0, threads=2)
    return Setup(small_scene, settings.resolved(small_scene))
