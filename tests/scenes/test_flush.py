"""Flat faces in one place, where nothing says which of them light meets."""

import math

import numpy as np
import pytest

import scenes
from scenes import Box, Disk, Lens, LensSurface, Mesh, Plane, Prism, Rectangle, SceneError, Sphere
from scenes.flat_patches import flat_patches, share_a_place

UP = (0.0, 1.0, 0.0)
GLASS = scenes.Dielectric(medium="N-BK7")
SHEET = scenes.Polariser(axis=(1.0, 0.0, 0.0))
RED, MIRROR = scenes.Lambertian(reflectance=0.5), scenes.Mirror()


def plate(x=0.0, y=0.0, z=0.0, size=(1.0, 1.0), normal=UP):
    return Rectangle(position=(x, y, z), size=size, normal=normal)


def disk(x=0.0, y=0.0, z=0.0, radius=0.5, normal=UP):
    return Disk(position=(x, y, z), normal=normal, radius=radius)


def problems_of(*things):
    """What is wrong between shapes of materials, called a, b, …"""
    objects = [
        scenes.SceneObject(name=chr(97 + k), shape=shape, material=material)
        for k, (shape, material) in enumerate(things)
    ]
    try:
        scenes.Scene(objects=objects)
    except SceneError as error:
        return error.problems
    return ()


DIAGONAL = 0.5 * math.sqrt(0.5)
"""How far a corner of the unit square is from its middle, over 2: where a disk just meets it."""

FLUSH = [
    (plate(), plate(0.9)), (plate(), plate(0.5, normal=(0.0, -2.0, 0.0))),
    (plate(), plate(size=(0.1, 0.1))), (plate(), disk(0.9)), (plate(size=(0.1, 0.1)), disk()),
    (disk(), disk(0.9, 0.0, 0.4)), (plate(), Plane(position=(5.0, 0.0, 3.0), normal=UP)),
    (Plane(position=(0, 0, 0), normal=UP), Plane(position=(5.0, 0.0, 3.0), normal=(0, -1, 0))),
    (plate(), disk(0.5 + DIAGONAL * 0.999, 0.0, 0.5 + DIAGONAL * 0.999)),
    (plate(y=1.0), plate(y=1.0 + 1e-12)),
]  # fmt: skip
CLEAR = [
    (plate(), plate(1.0)), (plate(), plate(0.5, 1e-6)), (plate(), disk(1.0)),
    (disk(), disk(0.9, 0.0, 0.5)), (plate(), plate(normal=(0.0, 1.0, 1e-3))),
    (plate(), disk(0.5 + DIAGONAL * 1.001, 0.0, 0.5 + DIAGONAL * 1.001)),
    (plate(), Plane(position=(0.0, 1e-6, 0.0), normal=UP)), (plate(), plate(normal=(1, 0, 0))),
]  # fmt: skip


@pytest.mark.parametrize("shapes", FLUSH)
def test_two_opaque_sheets_in_one_place_are_refused(shapes):
    for one, other in (shapes, shapes[::-1]):
        for materials in ((RED, MIRROR), (scenes.Absorber(), RED), (SHEET, RED), (SHEET, SHEET)):
            (problem,) = problems_of(*zip((one, other), materials, strict=True))
            assert problem.path == "objects[1].shape"
            assert "'b' and 'a' lie flush in one place" in problem.message
            assert "nothing says which of them light meets" in problem.message
            # Two polarisers are no sheet of one material: what each lets through differs.
            either = "" if SHEET in materials else ", or the same material"
            assert problem.allowed == "a gap between them" + either
            assert problem.message.endswith(problem.allowed)


@pytest.mark.parametrize("shapes", CLEAR)
def test_sheets_apart_or_edge_to_edge_are_not(shapes):
    for one, other in (shapes, shapes[::-1]):
        assert not problems_of((one, RED), (other, MIRROR))


@pytest.mark.parametrize("x", [1e6, 5e6])
def test_tiles_edge_to_edge_far_from_the_origin_are_not(x):
    # A coordinate is known to ε/2 of itself, 5·10⁻¹⁰ m at 5·10⁶ m; 10⁻⁹ of 0.05 m is less.
    for k in range(8):
        tile, beside = (plate(x + 0.1 * (k + n), size=(0.1, 0.1)) for n in (0, 1))
        assert not problems_of((tile, RED), (beside, MIRROR))
        round_one = disk(x + 0.1 * (k + 1), radius=0.05)
        assert not problems_of((tile, RED), (round_one, MIRROR))
        other = disk(x + 0.1 * (k + 2), radius=0.05)
        assert not problems_of((round_one, RED), (other, MIRROR))
        (problem,) = problems_of((tile, RED), (plate(x + 0.1 * (k + 0.99)), MIRROR))
        assert "flush" in problem.message


def test_the_same_material_twice_is_the_same_whichever_light_meets():
    assert not problems_of((plate(), RED), (plate(0.5), RED))


def test_sheets_under_glass_are_found_as_well():
    pane = Box(position=(0.0, 0.1, 0.0), size=(2.0, 0.2, 2.0))
    (problem,) = problems_of((pane, GLASS), (plate(), RED), (disk(0.2), MIRROR))
    assert problem.path == "objects[2].shape"
    assert "'c' and 'b' lie flush" in problem.message


def plano_convex(**fields):
    fields = {"first": LensSurface(curvature=0.0), "second": LensSurface(radius=-2.0), **fields}
    return Lens(position=(0.0, 0.1, 0.0), axis=UP, thickness=0.2, aperture=0.8, **fields)


@pytest.fixture(scope="module")
def wedge(tmp_path_factory):
    """A tetrahedron below y = 0, its top flat."""
    path = tmp_path_factory.mktemp("wedge") / "wedge.obj"
    path.write_text(
        "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0.2 -1 0.2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "utf-8"
    )
    return Mesh(position=(0.0, 0.0, 0.0), file=str(path))


def solids(wedge):
    half = 0.25 * math.sqrt(3.0)  # of the height of a prism of 60° and a base of 1
    return {
        "box": (Box(position=(0.0, -0.5, 0.0), size=(1.0, 1.0, 1.0)), 0.0),
        "turned box": (
            Box(position=(0, -0.5, 0), size=(1, 1, 1), rotation_deg=(180.0, 33.0, 0.0)), 0.0
        ),
        "prism": (Prism(position=(0, half, 0), apex_deg=60.0, base=1.0, length=1.0), 0.0),
        "plano-convex lens": (plano_convex(), 0.0),
        "mesh": (wedge, 0.0),
    }  # fmt: skip


@pytest.mark.parametrize("name", ["box", "turned box", "prism", "plano-convex lens", "mesh"])
@pytest.mark.parametrize("sheet", [plate(0.1, 0.0, 0.1, (0.2, 0.2)), disk(0.1, 0.0, 0.1, 0.05)])
def test_a_polariser_on_glass_is_refused(wedge, name, sheet):
    glass, y = solids(wedge)[name]
    (problem,) = problems_of((glass, GLASS), (sheet, SHEET))
    assert problem.path == "objects[1].shape"
    assert "'b' and 'a' lie flush in one place" in problem.message
    assert "filter and to refract" in problem.message
    # A gap, on either side, is allowed, and so is any other sheet; and one beside the glass.
    for gap in (1e-6, -1e-6):
        near = sheet.model_copy(update={"position": (0.1, y + gap, 0.1)})
        assert not problems_of((glass, GLASS), (near, SHEET))
    beside = sheet.model_copy(update={"position": (0.1, y, 1.2)})
    assert not problems_of((glass, GLASS), (beside, SHEET))
    assert not problems_of((glass, GLASS), (sheet, RED))


def test_a_polariser_inside_through_or_tangent_to_glass_is_allowed():
    ball = Sphere(position=(0.0, -0.5, 0.0), radius=0.5)
    for sheet in (plate(), plate(y=-0.5), plate(y=-0.5, size=(0.1, 0.1))):
        assert not problems_of((ball, GLASS), (sheet, SHEET))
    curved = plano_convex(first=LensSurface(radius=3.0))
    assert not problems_of((curved, GLASS), (plate(size=(0.1, 0.1)), SHEET))


def test_only_triangles_at_a_sheets_height_are_looked_at(monkeypatch):
    # The flat bottom of a height field has as many triangles as the rest of it, all parallel.
    looked_at = []

    def counted(one, other, touch):
        looked_at.append(other)
        return share_a_place(one, other, touch)

    monkeypatch.setattr(scenes.flush, "share_a_place", counted)
    water = scenes.HeightField(
        position=(0.0, 0.0, 0.0), size=(1.0, 1.0), depth=0.5, cells=(20, 20),
        waves=[{"amplitude": 0.01, "period": 0.7}],
    )  # fmt: skip
    for y in (-0.25, -0.5 + 1e-6, -0.5 - 1e-6):
        assert not problems_of((water, GLASS), (plate(y=y, size=(0.2, 0.2)), SHEET))
    assert not looked_at
    (problem,) = problems_of((water, GLASS), (plate(y=-0.5, size=(0.2, 0.2)), SHEET))
    assert "lie flush" in problem.message
    assert looked_at


def test_the_faces_of_a_box_are_its_six_squares():
    box = Box(position=(1.0, 2.0, 3.0), size=(2.0, 2.0, 2.0), rotation_deg=(10.0, 20.0, 30.0))
    patches = list(flat_patches(box, np.array(UP)))
    assert len(patches) == 6
    for patch in patches:
        # Corner by corner around it, sides of 2.
        sides = np.linalg.norm(np.roll(patch.corners, -1, axis=0) - patch.corners, axis=1)
        np.testing.assert_allclose(sides, 2.0, rtol=1e-12)
    # Opposite faces lie in planes of their own, adjacent ones have an edge in common.
    for k, one in enumerate(patches):
        assert [share_a_place(one, other, 1e-9) for other in patches] == [m == k for m in range(6)]
