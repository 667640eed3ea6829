"""What a scene requires of the code that is compiled for it."""

import dataclasses

import pytest

import scenes
from sim.features import Features, find_features
from spectra import Cauchy, Medium, Tabulated, glass

NOTHING = Features(
    spheres=False, flats=False, polyhedra=False, lenses=False, sellmeier=False, cauchy=False,
    tabulated=False, air_conversion=False, media_count=1,
)  # fmt: skip
AMBIENT = Medium("reference", Cauchy((1.0,)), (0.0, 1e9), "", "air")
TABLE = Medium("table", Tabulated((400.0, 700.0), (1.5, 1.4)), (400.0, 700.0), "", "air")
ORIGIN = (0.0, 0.0, 0.0)


def scene_of(*shapes):
    black = scenes.Absorber()
    return scenes.Scene(objects=[scenes.SceneObject(shape=one, material=black) for one in shapes])


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
