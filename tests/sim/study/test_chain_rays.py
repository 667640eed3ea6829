"""Chains follow the steps of single rays, and carry what those reflect and transmit."""

import numpy as np
import pytest

import scenes
from sim.errors import SettingsError
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays
from sim.study.chain_rays import make_chain, trace_chain
from sim.study.receiver_bins import lay_bins

LAMP = scenes.Point(name="lamp", position=(0.0, 2.0, 0.0), flux=1.0, spectrum="E")
BALL = scenes.Sphere(position=(0.0, 1.0, 0.0), radius=0.4)
ROOF = scenes.Prism(position=(0.9, 0.4, 0.0), base=0.4, apex_deg=140.0, length=0.8)
WIDE = scenes.Rectangle(position=(0.1, 0.0, 0.0), size=(60.0, 60.0))


@pytest.fixture(scope="module")
def bench(make_bench, compile_bench):
    compiled = compile_bench(make_bench(LAMP, ball=BALL, slab=ROOF, floor=WIDE))
    return compiled, lay_bins(compiled.scene, "floor", rows=2, columns=2)


@pytest.fixture(scope="module")
def rays():
    """Rays from about the lamp, most of them onto the ball or the roof beside it, and colours."""
    random = np.random.default_rng(5)
    count = 4000
    origins = np.array([0.0, 2.0, 0.0]) + random.uniform(-0.05, 0.05, (count, 3))
    directions = random.uniform(-0.8, 0.8, (count, 3)) - np.array([0.0, 1.0, 0.0])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return origins, directions, random.uniform(400.0, 700.0, count)


@pytest.mark.parametrize(
    "branches",
    [
        None,
        (),
        ("refract", "refract"),
        ("reflect",),
        ("refract", "reflect", "reflect", "refract"),
    ],
)
def test_a_chain_is_the_single_ray_with_these_branches(bench, rays, branches):
    compiled, receiver = bench
    landings = trace_chain(make_chain(compiled, receiver, branches), *rays)
    paths = trace_compiled_rays(compiled, *rays, branches=branches or ())
    wanted = ["refract"] * 256 if branches is None else [*branches]
    arrived = 0
    for i, path in enumerate(paths):
        # Total reflection is no refraction: nothing takes that branch. Of reflections it is one.
        events = [
            "reflect" if event.startswith("total") and one == "reflect" else event
            for event, one in zip(path.events[:-1], wanted, strict=False)
        ]
        if path.events[-1] == "escape" and np.any(np.abs(landings.place[i]) > 29.9):
            continue  # past the floor's edge, but on its plane
        on_chain = path.events[-1] == "deposit" and events == wanted[: len(path.events) - 1]
        if branches is not None:
            on_chain = on_chain and len(path.events) == len(branches) + 1
        assert (landings.signature[i] > 0) == on_chain
        if on_chain:
            arrived += 1
            place = (path.points[-1] - receiver.centre) @ receiver.frame[:2].T
            np.testing.assert_allclose(landings.place[i], place, atol=1e-12)
            assert landings.transmittance[i] == pytest.approx(path.transmittance, rel=1e-12)
    assert arrived > 20


def test_signatures_tell_faces_and_objects_apart(bench, rays):
    compiled, receiver = bench
    landings = trace_chain(make_chain(compiled, receiver, None), *rays)
    paths = trace_compiled_rays(compiled, *rays)
    seen = {}
    for path, signature in zip(paths, landings.signature, strict=True):
        if signature:
            seen.setdefault(int(signature), set()).add(path.objects)
    assert all(len(sequences) == 1 for sequences in seen.values())
    assert len(seen) > 3  # nothing, the ball, the roof from its left and from its right


def test_rays_land_beyond_the_receivers_edge_but_not_behind_what_is_in_the_way(
    make_bench, compile_bench
):
    small = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(0.2, 0.2))
    compiled = compile_bench(make_bench(LAMP, ball=BALL, floor=small))
    receiver = lay_bins(compiled.scene, "floor", rows=1, columns=1)
    origins = np.array([[0.7, 2.0, 0.3], [0.1, 2.0, 0.0], [0.7, 2.0, 0.3]])
    directions = np.array([[0.0, -1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
    chain = make_chain(compiled, receiver, ())
    landings = trace_chain(chain, origins, directions, np.full(3, 500.0))
    # Past the ball; into the ball, which direct light does not pass; upwards.
    np.testing.assert_array_equal(landings.signature > 0, [True, False, False])
    along = receiver.frame[:2] @ np.array([0.7, 0.0, 0.3])
    np.testing.assert_allclose(landings.place[0], along, atol=1e-12)
    assert landings.transmittance[0] == 1.0


def test_only_branches_and_float64_are_taken(bench):
    compiled, receiver = bench
    for branches in ("refract", ("transmit",)):
        with pytest.raises(SettingsError, match="branches"):
            make_chain(compiled, receiver, branches)
    single = compile_scene(compiled.scene, precision="float32")
    with pytest.raises(SettingsError, match="precision: 'float32'"):
        make_chain(single, receiver, None)


def chain_scene(*objects, ambient="reference"):
    floor = scenes.SceneObject(
        name="floor", shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(4.0, 4.0)),
        material=scenes.Lambertian(reflectance=0.5),
    )  # fmt: skip
    return scenes.Scene(objects=(*objects, floor), emitters=(LAMP,), ambient=ambient)


def slab(name, low, high, medium, **fields):
    shape = scenes.Box(position=(0, 0.5 * (low + high), 0), size=(9.0, high - low, 9.0))
    return scenes.SceneObject(
        name=name, shape=shape, material=scenes.Dielectric(medium=medium, **fields)
    )


def test_a_chain_loses_on_its_way_what_single_rays_lose(compile_bench, rays):
    # A coloured plate with a hidden sheet of another glass, above a floor in a coloured medium: on
    # the floor's plane, beyond its edge, light has come no further than that.
    dye = scenes.NapierianAbsorption(coefficient=0.8)
    plate = slab("plate", 0.8, 1.2, "N-BK7", priority=1, absorption=dye)
    sheet = slab("sheet", 0.9, 1.0, "SF11")
    air = scenes.ConstantMedium(eta=1.0, absorption=scenes.NapierianAbsorption(coefficient=0.3))
    compiled = compile_bench(chain_scene(plate, sheet, ambient=air))
    receiver = lay_bins(compiled.scene, "floor", rows=2, columns=2)
    paths = trace_compiled_rays(compiled, *rays)
    for branches in (None, ("refract",) * 4):
        landings = trace_chain(make_chain(compiled, receiver, branches), *rays)
        inside = beyond = 0
        for i, path in enumerate(paths):
            assert path.events[:4] == ("refract", "pass", "pass", "refract")
            if path.events[4] == "deposit":
                inside += 1
                assert landings.transmittance[i] == pytest.approx(path.transmittance, rel=1e-13)
            elif landings.transmittance[i] > 0.0:
                beyond += 1
                way = path.points[4][1] / -path.directions[4][1]
                before = np.prod(1.0 - path.absorptances[:4]) * np.prod(1.0 - path.reflectances[:4])
                expected = float(before * np.exp(-0.3 * way))
                assert landings.transmittance[i] == pytest.approx(expected, rel=1e-12)
        assert inside > 1000
        assert beyond > 10 or branches is None


def test_a_mirror_past_the_receiver_takes_nothing(compile_bench):
    # The plane of the floor is met before a dull mirror under it, beside the floor's edge.
    mirror = scenes.SceneObject(
        name="mirror", shape=scenes.Rectangle(position=(0.0, -1.0, 0.0), size=(50.0, 50.0)),
        material=scenes.Mirror(reflectance=0.25),
    )  # fmt: skip
    compiled = compile_bench(chain_scene(mirror))
    receiver = lay_bins(compiled.scene, "floor", rows=2, columns=2)
    rays = np.array([[2.5, 1.0, 0.0]]), np.array([[0.0, -1.0, 0.0]]), np.array([550.0])
    landings = trace_chain(make_chain(compiled, receiver, ()), *rays)
    np.testing.assert_allclose(landings.place, [[2.5, 0.0]], atol=1e-15)
    assert landings.transmittance[0] == 1.0
