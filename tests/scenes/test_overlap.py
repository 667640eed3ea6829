"""Solids that claim the same space: how deep, and what is said of it."""

import math

import numpy as np
import pytest

import scenes
from scenes import Box, Lens, LensSurface, SceneError, Sphere, overlap
from scenes.overlap import overlap_depth

UNIT = Box(position=(0, 0, 0), size=(1, 1, 1))
SHIFTED = Box(position=(0.5, 0, 0), size=(1, 1, 1))


def cap(position, first, second, thickness=0.2, aperture=0.8):
    return Lens(
        position=position, axis=(0, 0, 1), thickness=thickness, aperture=aperture,
        first=LensSurface(radius=first), second=LensSurface(radius=second),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("one", "other", "depth"),
    [
        # Two spheres share a lens of r + s − d across: half of it is as deep as a point can be.
        (Sphere(position=(0, 0, 0), radius=1.0), Sphere(position=(1.4, 0, 0), radius=0.6), 0.1),
        (Sphere(position=(0, 0, 0), radius=1.0), Sphere(position=(1.999, 0, 0), radius=1.0), 5e-4),
        (Sphere(position=(0, 0, 0), radius=1.0),
         Sphere(position=(1.2, 1.6 - 1e-7, 0), radius=1.0), 4e-8),
        # Concentric: the radius of the smaller one.
        (Sphere(position=(0, 0, 0), radius=1.0), Sphere(position=(0, 0, 0), radius=0.3), 0.3),
        # Boxes: half of what they share along the shortest way.
        (UNIT, Box(position=(0.99, 0.2, 0.1), size=(1, 1, 1)), 0.005),
        (UNIT, Box(position=(0.9, 0.95, 0.9), size=(1, 1, 1)), 0.025),
        # Tangent ones and flush ones only touch.
        (Sphere(position=(0, 0, 0), radius=1.0), Sphere(position=(2, 0, 0), radius=1.0), 0.0),
        (UNIT, Box(position=(0, 1.0, 0), size=(1, 1, 1)), 0.0),
        (UNIT, Sphere(position=(0, 0.8, 0), radius=0.3), 0.0),
        # A cemented pair.
        (cap((0, 0, 0), 2.0, -1.0), cap((0, 0, 0.2), -1.0, -1.5), 0.0),
    ],
)  # fmt: skip
def test_how_deep_solids_enter_one_another(one, other, depth):
    for pair in ((one, other), (other, one)):
        assert overlap_depth(*pair) == pytest.approx(depth, rel=1e-3, abs=2e-15)


def test_a_corner_in_a_face_is_found_wherever_it_is():
    # A cube on its corner, 1e-3 deep in a slab: half as deep is a point at most below its top and,
    # for the cube's three faces, whose normals have a sine of 1/√3 with the vertical,
    # h/√3 above the corner: at z (1 + 1/√3) = 1e-3/√3.
    angle = math.degrees(math.atan(1.0 / math.sqrt(2.0)))
    turned = Box(position=(0.31, 0.77, 0.2), size=(1, 1, 1), rotation_deg=(45.0, 0.0, angle))
    lowest = np.min(turned.vertices_world(), axis=0)
    low = float(lowest[1])
    slab = Box(position=(0, low + 1e-3 - 0.5, 0), size=(5, 1, 5))
    expected = 1e-3 / math.sqrt(3.0) / (1.0 + 1.0 / math.sqrt(3.0))
    assert overlap_depth(slab, turned) == pytest.approx(expected, rel=0.05)


def objects(*materials):
    return [
        scenes.SceneObject(name=name, shape=shape, material=material)
        for name, shape, material in zip(("left", "right"), (UNIT, SHIFTED), materials, strict=True)
    ]


def glass(medium, priority=0, **fields):
    return scenes.Dielectric(medium=medium, priority=priority, **fields)


def test_different_media_of_equal_priority_are_a_contradiction():
    with pytest.raises(SceneError) as caught:
        scenes.Scene(objects=objects(glass("N-BK7", 3), glass("SF11", 3)))
    (problem,) = caught.value.problems
    assert problem.path == "objects[1].material.priority"
    assert "'right' and 'left' claim the same space, 0.25 m deep" in problem.message
    assert problem.value == 3
    assert "other than 3" in problem.allowed


@pytest.mark.parametrize(
    "materials",
    [
        (glass("N-BK7", 3), glass("SF11", 2)),
        (glass("N-BK7"), glass("N-BK7")),
        (glass("N-BK7"), scenes.Lambertian(reflectance=0.5)),
        (glass("N-BK7"), scenes.Mirror()),
    ],
)
def test_what_is_settled_is_no_contradiction(materials):
    scenes.Scene(objects=objects(*materials))


def test_the_same_glass_with_another_colour_is_another_medium():
    dyed = glass("N-BK7", absorption=scenes.NapierianAbsorption(coefficient=1.0))
    with pytest.raises(SceneError, match="claim the same space"):
        scenes.Scene(objects=objects(glass("N-BK7"), dyed))


def test_every_pair_is_named_and_nothing_else():
    row = [
        scenes.SceneObject(
            name=f"ball {k}", shape=Sphere(position=(1.9 * k, 0, 0), radius=1.0),
            material=glass(("N-BK7", "SF11")[k % 2]),
        )
        for k in range(5)
    ]  # fmt: skip
    with pytest.raises(SceneError) as caught:
        scenes.Scene(objects=row)
    paths = [problem.path for problem in caught.value.problems]
    assert paths == [f"objects[{k}].material.priority" for k in range(1, 5)]


@pytest.mark.parametrize("priority", [-1001, 1001, 0.5, True, "high"])
def test_a_priority_is_a_whole_number_within_limits(priority):
    with pytest.raises(SceneError, match="priority"):
        scenes.loads(f"""
            [[objects]]
            shape = {{type = "sphere", position = [0.0, 0.0, 0.0], radius = 1.0}}
            [objects.material]
            type = "dielectric"
            medium = "N-BK7"
            priority = {str(priority).lower() if isinstance(priority, bool) else repr(priority)}
        """)


def slats(material, count=450):
    """A louvre: each slat's bounding sphere, 1 m across, meets those of all the others."""
    return [
        scenes.SceneObject(
            name=f"slat {k}", material=material,
            shape=Box(position=(0.0, 0.002 * k, 0.0), size=(1.0, 0.001, 0.01)),
        )
        for k in range(count)
    ]  # fmt: skip


def test_opaque_solids_may_be_a_crowd():
    # 450 · 449 / 2 = 101,025 pairs, of which none can be a contradiction.
    scene = scenes.Scene(objects=slats(scenes.Absorber()))
    assert len(scene.objects) == 450
    with pytest.raises(SceneError, match="101025 pairs are close to each other"):
        scenes.Scene(objects=slats(glass("N-BK7")))


def test_more_searches_than_there_is_time_for_are_refused(monkeypatch):
    # Balls of 0.2 at a bar's long edge, √2 · 0.145 = 0.205 from it: no direction of a face, nor
    # from middle to middle, parts them, so that each is searched for.
    bar = Box(position=(0.0, 0.0, 0.0), size=(4.0, 1.0, 1.0))
    balls = [Sphere(position=(x, 0.645, 0.645), radius=0.2) for x in (-1.7, -1.1, 1.1, 1.7)]
    things = [(bar, "N-BK7"), *((ball, "SF11") for ball in balls)]
    row = [scenes.SceneObject(shape=shape, material=glass(name)) for shape, name in things]
    searched = []
    search = overlap.overlap_depth

    def counted(one, other, touch):
        searched.append((one, other))
        return search(one, other, touch)

    monkeypatch.setattr(overlap, "overlap_depth", counted)
    scenes.Scene(objects=row)
    assert len(searched) == 4
    monkeypatch.setattr(overlap, "_MOST_SEARCHES", 3)
    with pytest.raises(SceneError) as caught:
        scenes.Scene(objects=row)
    (problem,) = caught.value.problems
    assert problem.path == "objects"
    assert "at most 3 such pairs" in problem.allowed
    assert "different priorities" in problem.allowed


@pytest.mark.parametrize("x", [0.0, 1e6, 5e6, -3e8])
def test_cubes_face_to_face_touch_wherever_they_are(x):
    # A coordinate is known to ε/2 of itself: at 5·10⁶ m, 5·10⁻¹⁰ m, 0.1 m cubes overlap by that.
    row = [
        scenes.SceneObject(
            name=f"cube {k}", shape=Box(position=(x + 0.1 * k, 0, 0), size=(0.1, 0.1, 0.1)),
            material=glass(("N-BK7", "SF11")[k % 2]),
        )
        for k in range(4)
    ]  # fmt: skip
    scenes.Scene(objects=row)
    # An overlap of a millimetre is one there, too.
    deep = row[1].model_copy(
        update={"shape": Box(position=(x + 0.099, 0, 0), size=(0.1, 0.1, 0.1))}
    )
    with pytest.raises(SceneError, match="claim the same space"):
        scenes.Scene(objects=[row[0], deep])
