"""A pilot's lessons: fewer photons for the same noise, the same light, and whatever the threads."""

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.image.camera import compile_camera
from sim.image.survey import survey_view
from sim.method import Method
from sim.photons import guidance
from sim.photons.guided_lamps import compile_guided_lamps
from sim.photons.lamp_structs import AIM_AREA, AIM_BASE, AIM_CELLS, AIM_CONE
from sim.photons.lamps import compile_lamps
from sim.photons.tracing import trace_photons
from sim.scene_data import compile_scene

PHOTONS, PASSES = 8_000, 12
EDGES = np.linspace(-0.8, 0.8, 5)

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(4.0, 4.0)),
    material=scenes.Lambertian(reflectance=0.5),
)
BALL = scenes.SceneObject(
    name="ball",
    shape=scenes.Sphere(position=(-0.4, 1.0, 0.0), radius=0.4),
    material=scenes.Dielectric(medium="SF11"),
)
FAR_BALL = BALL.model_copy(
    update={"name": "far", "shape": scenes.Sphere(position=(-1.0, 1.0, -9.0), radius=0.4)}
)
LAMP = scenes.SphereLamp(position=(0.5, 2.5, 0.0), radius=0.1, flux=2.0, spectrum="E")
WIDE = scenes.Beam(
    position=(-0.4, 3.0, 0.2), direction=(0.0, -1.0, 0.0), flux=1.0, spectrum="E",
    profile=scenes.RoundProfile(radius=1.0),
)  # fmt: skip
IDLE = scenes.Beam(
    position=(1.5, 3.0, 0.0), direction=(0.0, -1.0, 0.0), flux=9.0, spectrum="E",
    profile=scenes.RoundProfile(radius=0.1),
)  # fmt: skip
CAMERA = scenes.Camera(
    position=(0.0, 6.0, 0.01), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=15.0
)
"""From high above it sees the middle of the floor, 1.6 m of it, past the ball."""


def compiled_scene(*objects, emitters, **options):
    scene = scenes.Scene(objects=(FLOOR, *objects), emitters=emitters, camera=CAMERA)
    return compile_scene(scene, device=start_device("cpu"), **options)


def view_of(compiled):
    scene = compiled.scene
    return survey_view(compiled, compile_camera(compiled, scene.camera, scene.film), 550.0)


def guided(compiled, *, threads=2, seed=0):
    return compile_guided_lamps(
        compiled, compiled.scene.film.edges_nm, PHOTONS, view=view_of(compiled), seed=seed,
        max_interactions=64, threads=threads,
    )


def unguided(compiled):
    edges_nm = compiled.scene.film.edges_nm
    return compile_lamps(compiled, edges_nm, PHOTONS, view=view_of(compiled), direct=False)


def shares(lamps):
    """Photons of each emitter's aims, by emitter."""
    return [
        [stream.photons for stream in lamps.streams if stream.emitter == row]
        for row in range(len(lamps.aims))
    ]


@pytest.fixture(scope="module")
def bench():
    return compiled_scene(BALL, emitters=(LAMP, WIDE, IDLE))


@pytest.fixture(scope="module")
def learned(bench):
    return guided(bench)


def block_fluxes(compiled, lamps):
    """Flux by way of glass on the blocks that are seen, (passes, 4, 4), all books closing."""
    found = []
    for index in range(PASSES):
        batch = trace_photons(
            compiled, lamps, seed=1, pass_index=index, max_interactions=64, threads=2,
            store_direct=False,
        )
        assert abs(batch.books.residual) < 1e-12
        photons = batch.to_numpy()
        x, _, z = photons["position"].T
        found.append(np.histogram2d(x, z, [EDGES, EDGES], weights=photons["flux"])[0])
    return np.array(found)


def test_the_light_is_the_same_and_the_noise_less(bench, learned):
    one, other = block_fluxes(bench, learned), block_fluxes(bench, unguided(bench))
    variance, before = one.var(axis=0, ddof=1), other.var(axis=0, ddof=1)
    # The same streams drive both: differences may be smaller than this, never larger. Student's
    # t with 22 degrees of freedom exceeds 5 in one of 20,000 comparisons.
    error = np.sqrt((variance + before) / PASSES)
    assert np.all(np.abs(one.mean(axis=0) - other.mean(axis=0)) < 5.0 * error)
    # The idle beam alone had half of the photons; relative to the light, as the eye minds it.
    light = one.mean(axis=0) ** (4.0 / 3.0)
    assert np.sum(variance / light) < 0.5 * np.sum(before / light)


def test_lamps_that_light_no_glass_get_few_photons(learned):
    lamp, wide, idle = (sum(counts) for counts in shares(learned))
    assert lamp + wide + idle == PHOTONS
    assert idle < 0.05 * PHOTONS
    assert min(lamp, wide) > 0.1 * PHOTONS


def test_a_beam_and_a_cone_learn_where_the_glass_is_and_nothing_is_left_out(learned):
    cells = int(AIM_CELLS)
    for aims in learned.aims[:2]:
        aim = aims[-1]
        assert aim.kind in {AIM_BASE, AIM_CONE}
        functions = aim.distribution.reshape(cells + 1, cells + 1)
        rows, columns = np.diff(functions[0]), np.diff(functions[1:], axis=1)
        density = rows[:, None] * columns * cells**2
        assert density.min() > 0.99 * guidance.UNIFORM_PART
    # The beam's profile is 2 m wide, the ball under it 0.8 m: 16 % of it.
    assert 0.05 < np.mean(density > 1.0) < 0.35
    assert density[0, 0] == pytest.approx(guidance.UNIFORM_PART, rel=1e-9)


def test_what_is_learned_depends_on_the_seed_but_on_no_threads(bench, learned):
    alone, reseeded = guided(bench, threads=1), guided(bench, seed=7)
    for one, other in zip(learned.aims, alone.aims, strict=True):
        for a, b in zip(one, other, strict=True):
            assert a.share == b.share
            np.testing.assert_array_equal(a.distribution, b.distribution)
    assert learned.streams == alone.streams
    assert learned.streams != reseeded.streams


def test_single_precision_learns_the_same(learned):
    # From the same numbers: but for a photon here and there that roulette treats otherwise, or
    # that falls to the neighbour's cell.
    single = guided(compiled_scene(BALL, emitters=(LAMP, WIDE, IDLE), precision="float32"))
    for one, other in zip(shares(learned), shares(single), strict=True):
        np.testing.assert_allclose(one, other, atol=0.02 * PHOTONS)
    for row in (0, 1):
        one, other = (lamps.aims[row][-1].distribution for lamps in (learned, single))
        np.testing.assert_allclose(one, other, atol=0.02)


def test_receivers_are_aimed_at_through_glass_only():
    # Past a ball nothing straight is worth a photon; through a pane all of it is.
    pane = scenes.SceneObject(
        name="pane",
        shape=scenes.Box(position=(0.0, 2.0, 0.0), size=(6.0, 0.02, 6.0)),
        material=scenes.Dielectric(medium="N-BK7"),
    )
    past = guided(compiled_scene(BALL, emitters=(LAMP,)))
    through = guided(compiled_scene(pane, emitters=(LAMP,)))
    assert [aim.kind for aim in past.aims[0]] == [AIM_BASE, AIM_CONE]
    area = [aim for aim in through.aims[0] if aim.kind == AIM_AREA]
    assert area[0].share > 0.8


def test_glass_that_the_picture_owes_nothing_is_aimed_at_little():
    lamps = guided(compiled_scene(BALL, FAR_BALL, emitters=(LAMP,)))
    counts = dict(zip([id(aim) for aim in lamps.aims[0]], shares(lamps)[0], strict=True))
    near, far = (counts[id(aim)] for aim in lamps.aims[0] if aim.kind == AIM_CONE)
    assert far < 0.05 * near


def test_the_lamps_own_way_always_has_its_part(learned):
    for aims, counts in zip(learned.aims, shares(learned), strict=True):
        assert aims[0].kind == AIM_BASE
        assert counts[0] >= 0.9 * guidance.BASE_PART * sum(counts)


def test_without_glass_there_is_nothing_to_learn():
    lamps = guided(compiled_scene(emitters=(LAMP, WIDE)))
    assert [sum(counts) for counts in shares(lamps)] == [PHOTONS // 2, PHOTONS // 2]
    assert all(len(aim.distribution) == 0 for aims in lamps.aims for aim in aims if aim.kind == 0)


def test_an_unaimed_method_learns_nothing():
    lamps = guided(compiled_scene(BALL, emitters=(LAMP,), method=Method(aiming="unaimed")))
    assert [aim.kind for aim in lamps.aims[0]] == [AIM_BASE]
    assert len(lamps.aims[0][0].distribution) == 0
