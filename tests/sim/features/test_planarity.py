"""Which benches keep one plane of incidence, and which only look as if they did."""

import numpy as np
import pytest

import scenes
from sim.features.planarity import planarity
from sim.single_ray import trace_compiled_rays

GLASS = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
MIRROR = scenes.Metal(metal="silver")
WHITE = scenes.Lambertian(reflectance=0.8)
ORIGIN = (0.0, 0.0, 0.0)


def scene_of(*objects, lamps=()):
    items = [
        scenes.SceneObject(shape=one, material=GLASS if one.is_closed else MIRROR)
        for one in objects
    ]
    floor = scenes.SceneObject(
        shape=scenes.Plane(position=(0.0, -1.0, 0.0), normal=(0.1, 1.0, 0.3)), material=WHITE
    )
    return scenes.Scene(objects=[*items, floor], emitters=list(lamps))


def beam(direction, **fields):
    return scenes.Beam(
        flux=1.0, spectrum="E", position=(-1.0, 0.1, 0.2), direction=direction,
        profile=scenes.RoundProfile(radius=0.01), **fields,
    )  # fmt: skip


def point(position):
    return scenes.Point(flux=1.0, spectrum="E", position=position)


def ball(radius, position=ORIGIN):
    return scenes.Sphere(position=position, radius=radius)


def lens(x, axis=(1.0, 0.0, 0.0), y=0.0):
    return scenes.Lens(
        position=(x, y, 0.0), axis=axis, thickness=0.01, aperture=0.02,
        first={"radius": 0.05}, second={"radius": -0.05},
    )  # fmt: skip


def mirror(normal):
    return scenes.Rectangle(position=ORIGIN, size=(1.0, 1.0), normal=normal)


PRISM = scenes.Prism(
    position=ORIGIN, apex_deg=60.0, base=0.05, length=0.05, rotation_deg=(0.0, 0.0, 17.0)
)
BOX = scenes.Box(position=(0.2, 0.0, 0.0), size=(0.01, 0.3, 0.3), rotation_deg=(0.0, 0.0, 40.0))
SLANTED = scenes.Box(
    position=(0.2, 0.0, 0.0), size=(0.1, 0.3, 0.3), rotation_deg=(0.0, 40.0, 3.0)
)


def test_spheres_about_one_centre_keep_the_plane_of_any_ray():
    scene = scene_of(ball(1.0), ball(0.5), lamps=[point((3.0, 1.0, 2.0)), beam((1.0, 0.3, 0.1))])
    for from_anywhere in (True, False):
        reason = planarity(scene, from_anywhere=from_anywhere)
        assert reason is not None
        assert "one centre" in reason
    apart = scene_of(ball(1.0), ball(0.5, (1e-6, 0.0, 0.0)), lamps=[point((3.0, 1.0, 2.0))])
    assert planarity(apart, from_anywhere=True) is None


def test_parallel_mirrors_keep_the_plane_of_any_ray():
    two = [mirror((0.0, 1.0, 0.0)), scenes.Disk(position=(0, 1, 0), normal=(0, -1, 0), radius=1.0)]
    assert planarity(scene_of(*two), from_anywhere=True) is not None
    two.append(mirror((0.0, 1.0, 1e-6)))
    assert planarity(scene_of(*two), from_anywhere=True) is None


@pytest.mark.parametrize(
    ("objects", "lamps", "planar"),
    [
        ([PRISM, BOX], [beam((1.0, 0.2, 0.0))], True),
        ([PRISM, BOX], [beam((1.0, 0.2, 0.0)), beam((1.0, -0.3, 0.0))], True),
        ([BOX], [beam((np.cos(np.radians(40.0)), np.sin(np.radians(40.0)), 0.0))], True),
        ([PRISM, BOX], [beam((1.0, 0.2, 0.01))], False),  # out of the plane
        ([PRISM, BOX], [beam((1.0, 0.2, 0.0), divergence_deg=0.1)], False),
        ([PRISM, BOX], [point((-1.0, 0.0, 0.0))], False),
        ([PRISM, SLANTED], [beam((1.0, 0.2, 0.0))], False),
        ([PRISM, ball(0.01)], [beam((1.0, 0.2, 0.0))], False),
        ([PRISM], [], False),
    ],
)
def test_benches_in_a_plane(objects, lamps, planar):
    scene = scene_of(*objects, lamps=lamps)
    assert (planarity(scene, from_anywhere=False) is not None) == planar
    assert planarity(scene, from_anywhere=True) is None  # the eye is anywhere


@pytest.mark.parametrize(
    ("objects", "lamps", "planar"),
    [
        ([lens(0.0), lens(0.1)], [beam((1.0, 0.0, 0.0))], True),
        ([lens(0.0), ball(0.01, (0.1, 0.0, 0.0))], [beam((-1.0, 0.0, 0.0))], True),
        ([lens(0.0), mirror((1.0, 0.0, 0.0))], [point((-0.3, 0.0, 0.0))], True),
        ([ball(0.01), ball(0.01, (0.1, 0.0, 0.0))], [beam((1.0, 0.0, 0.0))], True),
        ([lens(0.0), lens(0.1, y=1e-6)], [beam((1.0, 0.0, 0.0))], False),
        ([lens(0.0), lens(0.1, axis=(1.0, 1e-6, 0.0))], [beam((1.0, 0.0, 0.0))], False),
        ([lens(0.0), lens(0.1)], [beam((1.0, 1e-6, 0.0))], False),
        ([lens(0.0), lens(0.1)], [point((-0.3, 1e-6, 0.0))], False),
        ([lens(0.0), PRISM], [beam((1.0, 0.0, 0.0))], False),
        ([lens(0.0), mirror((1.0, 0.0, 0.1))], [beam((1.0, 0.0, 0.0))], False),
        ([lens(0.0)], [beam((1.0, 0.0, 0.0), divergence_deg=1.0)], False),
    ],
)
def test_benches_about_an_axis(objects, lamps, planar):
    scene = scene_of(*objects, lamps=lamps)
    assert (planarity(scene, from_anywhere=False) is not None) == planar


def test_frames_do_not_turn_on_a_planar_bench():
    # What is claimed, seen on rays: s stays along one line, so that light from natural has no U.
    from sim.device import start_device
    from sim.scene_data import compile_scene

    start_device("cpu")
    scene = scene_of(lens(0.0), ball(0.01, (0.1, 0.0, 0.0)), lamps=[beam((1.0, 0.0, 0.0))])
    assert planarity(scene, from_anywhere=False) is not None
    rng = np.random.default_rng(3)
    origins = np.c_[np.full(40, -0.1), rng.uniform(-0.004, 0.004, (40, 2))]
    ways = np.tile([1.0, 0.0, 0.0], (40, 1))
    paths = trace_compiled_rays(
        compile_scene(scene), origins, ways, np.full(40, 550.0), branches=["refract", "reflect"]
    )
    for path in paths:
        assert len(path.frames) > 3
        turned = np.abs(path.frames[1:] @ path.frames[1])
        np.testing.assert_allclose(turned, 1.0, atol=1e-12)
        np.testing.assert_allclose(path.polarisations[:, 1:], 0.0, atol=1e-9)
