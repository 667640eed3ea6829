"""Solids that stand on receivers without a gap: what enters arrives, however they are turned."""

import math

import numpy as np
import pytest

import scenes
from scenes.frames import rotation_matrix
from sim import analytic

ETA = 1.5
TURNS = ((0.0, 0.0, 0.0), (10.0, 20.0, 30.0), (-77.0, 31.0, 145.0))


def standing(turn, *, floor_first, theta=0.4, offset=(0.0, 0.0, 0.0)):
    """A block on a floor, both turned, and a beam through its top, away from the edges."""
    frame = rotation_matrix(turn)

    def place(*point):
        return tuple((frame @ point + offset).tolist())

    def way(*direction):
        return tuple((frame @ direction).tolist())

    block = scenes.SceneObject(
        name="block",
        shape=scenes.Box(position=place(0.0, 0.35, 0.0), size=(1.0, 0.7, 1.1), rotation_deg=turn),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA)),
    )
    floor = scenes.SceneObject(
        name="floor",
        shape=scenes.Rectangle(
            position=place(0.2, 0.0, 0.1), size=(3.0, 2.0), normal=way(0, 1, 0), up=way(0, 0, 1)
        ),
        material=scenes.Lambertian(reflectance=0.5),
    )
    beam = scenes.Beam(
        position=place(-0.5 * math.sin(theta), 1.2, 0.0),
        direction=way(math.sin(theta), -math.cos(theta), 0.0),
        profile=scenes.RoundProfile(radius=0.1), flux=1.0, spectrum="E",
    )  # fmt: skip
    objects = (floor, block) if floor_first else (block, floor)
    return scenes.Scene(objects=objects, emitters=(beam,))


@pytest.mark.parametrize("floor_first", [False, True])
@pytest.mark.parametrize("turn", TURNS)
def test_what_enters_a_block_arrives_on_the_floor_under_it(trace_passes, turn, floor_first):
    scene = standing(turn, floor_first=floor_first)
    passes = trace_passes(scene, photons=5000)
    books, photons = passes.books[0], passes.photons[0]
    reflected = float(np.mean(analytic.fresnel_reflectance(math.cos(0.4), 1.0, ETA)))
    assert abs(books.residual) < 1e-12
    assert books.absorbed == 0.0
    # The top reflects r, and nothing else does: there is no air between the block and the floor.
    # Roulette has no part in it, as r > 0.01.
    assert books.deposited == pytest.approx((1.0 - reflected) * books.emitted, rel=1e-12)
    assert books.escaped == pytest.approx(reflected * books.emitted, rel=1e-11)
    names = [one.name for one in scene.objects]
    assert set(photons["object"].tolist()) == {names.index("floor")}
    assert set(photons["side"].tolist()) == {0}


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_no_light_slips_through_far_from_the_origin(trace_passes, precision):
    # A bench 300 m away: 2⁻⁴⁰ of it is no more than the rounding of its coordinates there.
    scene = standing(TURNS[1], floor_first=False, offset=(300.0, -100.0, 200.0))
    passes = trace_passes(scene, photons=5000, precision=precision)
    books = passes.books[0]
    reflected = float(np.mean(analytic.fresnel_reflectance(math.cos(0.4), 1.0, ETA)))
    tolerance = 1e-9 if precision == "float64" else 1e-4
    assert books.deposited == pytest.approx((1.0 - reflected) * books.emitted, rel=tolerance)


@pytest.mark.parametrize("turn", TURNS)
def test_a_lamp_in_a_block_lights_the_floor_under_it(trace_passes, turn):
    # What comes down to the floor straight from the lamp is direct light, and not stored; all of
    # it is on the books, though, and nothing is left below the floor.
    scene = standing(turn, floor_first=False)
    frame = rotation_matrix(turn)
    lamp = scenes.Point(position=tuple((frame @ (0, 0.3, 0)).tolist()), flux=1.0, spectrum="E")
    room = scenes.SceneObject(
        name="below", shape=scenes.Rectangle(
            position=tuple((frame @ (0.2, -0.1, 0.1)).tolist()), size=(3.0, 2.0),
            normal=tuple((frame @ (0, 1, 0)).tolist()), up=tuple((frame @ (0, 0, 1)).tolist()),
        ), material=scenes.Absorber(),
    )  # fmt: skip
    scene = scenes.Scene(objects=(*scene.objects, room), emitters=(lamp,))
    books = trace_passes(scene, photons=5000).books[0]
    assert abs(books.residual) < 1e-12
    # The black sheet lies in the floor's shadow, but for what passes beside the floor: nothing.
    assert books.absorbed < 1e-12
    assert books.deposited > 0.2
