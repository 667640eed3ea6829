"""Every method answers the same physical question; only the noise differs."""

import itertools

import numpy as np
import pytest

import scenes
from sim.errors import SettingsError
from sim.method import DEFAULT_METHOD, Method

PASSES = 16
EDGES = np.linspace(-1.5, 1.5, 4)
"""The floor's middle is counted in 3 × 3 blocks."""

BASELINE = {"sampler": "random", "branching": "roulette", "aiming": "unaimed"}
VARIANTS = [
    {"sampler": "r2"},
    {"sampler": "random"},
    {"branching": "roulette"},
    {"aiming": "unaimed"},
    BASELINE,
]

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(4.0, 4.0)),
    material=scenes.Lambertian(reflectance=0.5),
)


def make_ball_scene():
    """A lamp and a beam above a ball of flint above a floor."""
    ball = scenes.SceneObject(
        name="ball",
        shape=scenes.Sphere(position=(0.0, 0.7, 0.0), radius=0.6),
        material=scenes.Dielectric(medium="SF11"),
    )
    lamp = scenes.SphereLamp(position=(0.5, 2.5, 0.0), radius=0.1, flux=2.0, spectrum="E")
    beam = scenes.Beam(
        position=(-0.3, 2.0, 0.1), direction=(0.0, -1.0, 0.0), flux=1.0, spectrum="E",
        profile=scenes.RoundProfile(radius=0.2), divergence_deg=1.0,
    )
    return scenes.Scene(objects=(FLOOR, ball), emitters=(lamp, beam))


def block_fluxes(photons):
    """Flux on the floor's blocks, (2, 3, 3): straight from the lamps, and by way of glass."""
    met = photons["refractions"] + photons["reflections"] > 0
    x, _, z = photons["position"].T
    return np.stack(
        [
            np.histogram2d(x[kind], z[kind], [EDGES, EDGES], weights=photons["flux"][kind])[0]
            for kind in (~met, met)
        ]
    )


@pytest.fixture(scope="module")
def trace_blocks(trace_passes):
    """Blocks' fluxes (passes, 2, 3, 3) by a method, all energy books having closed."""

    def trace(method, **options):
        passes = trace_passes(
            make_ball_scene(), photons=40_000, passes=PASSES, method=method, **options
        )
        # Rounding: N ε/2 of 40,000 photons is 4e-12 at worst, √N of that in truth.
        assert all(abs(books.residual) < 1e-12 for books in passes.books)
        return passes.sums(block_fluxes)

    return trace


@pytest.fixture(scope="module")
def default_blocks(trace_blocks):
    return trace_blocks({})


def deviation(one, other):
    """Difference of means over its standard error, for replicates in rows.

    Where neither ever counted any light, as straight from the lamps behind the ball, it is 0.
    """
    error = np.sqrt((one.var(axis=0, ddof=1) + other.var(axis=0, ddof=1)) / PASSES)
    off = one.mean(axis=0) - other.mean(axis=0)
    return np.divide(off, error, out=np.zeros_like(off), where=error > 0.0)


@pytest.mark.parametrize("method", VARIANTS, ids=["-".join(one.values()) for one in VARIANTS])
def test_a_variant_deposits_the_same_flux_in_each_block(trace_blocks, default_blocks, method):
    # Seeds of their own: the replicates are independent. With 30 degrees of freedom Student's t
    # exceeds 5 in one of 40,000 comparisons.
    variant = trace_blocks(method, seed=1)
    off = deviation(variant, default_blocks)
    assert np.all(np.abs(off) < 5.0), off
    # The test is sharp where light is, of either kind: σ is 1 to 3 % of the brightest block.
    error = np.sqrt(variant.var(axis=0, ddof=1) / PASSES)
    for kind in (0, 1):
        brightest = np.argmax(default_blocks.mean(axis=0)[kind])
        assert error[kind].flat[brightest] < 0.03 * default_blocks.mean(axis=0)[kind].max()


def test_the_default_is_less_noisy_than_the_baseline(trace_blocks, default_blocks):
    # What has met glass: aimed at, followed both ways, and drawn evenly. Each of these alone is
    # worth a factor; together a factor of 4 in error is far below what they give.
    baseline = trace_blocks(BASELINE, seed=1)[:, 1].std(axis=0, ddof=1)
    default = default_blocks[:, 1].std(axis=0, ddof=1)
    assert np.sqrt(np.mean(baseline**2) / np.mean(default**2)) > 4.0


def test_unaimed_photons_carry_their_lamps_flux_evenly(trace_passes):
    # And with roulette all of it until they end, in one piece a colour: four behind the ball.
    method = {"aiming": "unaimed", "branching": "roulette"}
    photons = trace_passes(make_ball_scene(), photons=4000, method=method).photons[0]
    met = photons["refractions"] + photons["reflections"] > 0
    for emitter in (0, 1):
        for kind, colours in ((~met, 1), (met, 4)):
            flux = photons["flux"][kind & (photons["emitter"] == emitter)] * colours
            np.testing.assert_allclose(flux, flux.mean() if len(flux) else 0.0, rtol=1e-12)


def make_plate_scene():
    """A beam straight down through a plate of index 1.5 onto a floor."""
    plate = scenes.SceneObject(
        name="plate",
        shape=scenes.Box(position=(0.0, 0.5, 0.0), size=(1.0, 0.1, 1.0)),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5)),
    )
    beam = scenes.Beam(
        position=(0.0, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=1.0,
        profile=scenes.RoundProfile(radius=0.2), spectrum="E",
    )
    return scenes.Scene(objects=(FLOOR, plate), emitters=(beam,))


def test_without_fresnel_all_light_passes_what_does_not_reflect_it_totally(trace_passes):
    passes = trace_passes(make_plate_scene(), photons=500, method={"fresnel": "none"})
    assert np.all(passes.photons[0]["refractions"] == 2)
    assert np.all(passes.photons[0]["reflections"] == 0)
    assert passes.books[0].deposited == pytest.approx(passes.flux, rel=1e-12)


def test_schlick_is_exact_at_normal_incidence(trace_passes):
    # R = R₀ there, in Schlick's formula too.
    exact, schlick = (
        trace_passes(make_plate_scene(), photons=500, method={"fresnel": one})
        for one in ("exact", "schlick")
    )
    assert exact.books[0].deposited == pytest.approx(schlick.books[0].deposited, rel=1e-12)
    r = 0.2**2
    through = exact.photons[0]["reflections"] == 0
    flux = schlick.photons[0]["flux"][through].sum()
    assert flux == pytest.approx(passes_of_plate(r) * exact.flux, rel=1e-12)


def passes_of_plate(r):
    """Of light that crosses two surfaces without a reflection."""
    return (1.0 - r) ** 2


def test_methods_are_keys():
    choices = list(itertools.product(("sobol", "r2"), ("weights", "roulette")))
    found = {Method(sampler=a, branching=b): i for i, (a, b) in enumerate(choices)}
    assert len(found) == 4
    assert found[Method()] == 0
    assert Method() == DEFAULT_METHOD


@pytest.mark.parametrize("field", ["sampler", "branching", "aiming", "fresnel"])
def test_a_choice_that_does_not_exist_is_refused(field):
    with pytest.raises(SettingsError, match=rf"method\.{field}: 'halton' is not allowed"):
        Method(**{field: "halton"})
