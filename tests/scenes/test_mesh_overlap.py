"""Solids of triangles that claim the same space as others: how deep, and what is said of it."""

import itertools

import numpy as np
import pytest

import scenes
from scenes import Box, HeightField, Lens, LensSurface, Mesh, SceneError, Sphere
from scenes.overlap import overlap_depth
from scenes.shapes.triangle_distance import depth_inside, nearest_on_triangles
from scenes.shapes.triangle_pairs import box_pairs

CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) - 0.5
FACES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip
TOUCH = 1e-6


def write_obj(path, points, faces):
    lines = ["v " + " ".join(map(repr, point)) for point in points.tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    path.write_text("\n".join(lines), encoding="utf-8")


def globe(rings):
    """A ball of radius 1, its corners on the sphere; 4 rings (rings − 1) triangles."""
    theta = np.pi * np.arange(1, rings) / rings
    phi = np.pi * np.arange(2 * rings) / rings
    around = [
        np.stack([np.sin(t) * np.cos(phi), np.full_like(phi, np.cos(t)), np.sin(t) * np.sin(phi)])
        for t in theta
    ]
    points = np.concatenate([[[0, 1, 0]], np.concatenate(around, axis=1).T, [[0, -1, 0]]])
    here = np.arange(2 * rings)
    ahead = np.roll(here, -1)
    rows = [1 + 2 * rings * k for k in range(rings - 1)]
    last = len(points) - 1
    faces = [np.stack([np.zeros_like(here), 1 + ahead, 1 + here], axis=1)]
    for up, down in itertools.pairwise(rows):
        faces.append(np.stack([up + here, up + ahead, down + here], axis=1))
        faces.append(np.stack([up + ahead, down + ahead, down + here], axis=1))
    faces.append(np.stack([rows[-1] + here, rows[-1] + ahead, np.full_like(here, last)], axis=1))
    return points, np.concatenate(faces)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    write_obj(folder / "cube.obj", CORNERS, FACES)
    write_obj(folder / "bar.obj", CORNERS * [4.0, 0.2, 0.2], FACES)
    write_obj(folder / "globe.obj", *globe(24))
    write_obj(folder / "fine.obj", *globe(80))
    return folder


@pytest.fixture(scope="module")
def mesh(files):
    def make(name="cube", position=(0.0, 0.0, 0.0), rotation_deg=(0.0, 0.0, 0.0)):
        return Mesh(
            file=str(files / f"{name}.obj"), position=position, rotation_deg=rotation_deg
        )

    return make


CUBE = {"size": (1.0, 1.0, 1.0)}


@pytest.mark.parametrize(
    ("other", "depth"),
    [
        # A face of the cube 0.1 inside the box; an edge of the cube, 0.1 along both; a corner.
        (Box(position=(0.9, 0.1, 0.2), **CUBE), 0.1),
        (Box(position=(0.9, 0.95, 0.2), **CUBE), 0.05),
        (Box(position=(0.9, 0.95, 0.98), **CUBE), 0.02),
        # The very same place: no face of one is inside the other, but the middle, 1/2 deep, is.
        (Box(position=(0.0, 0.0, 0.0), **CUBE), 0.5),
        # A bar through the cube and out on both sides has no corner in it, nor the cube in the bar:
        # the cube's face is cut in half of the bar's height; a thin pin, far from any corner.
        (Box(position=(0.0, 0.1, 0.2), size=(3.0, 0.2, 0.2)), 0.1),
        (Box(position=(0.01, 0.13, 0.22), size=(0.002, 0.002, 2.0)), 0.001),
        # A ball that pokes through the middle of a face: r − (distance − 1/2).
        (Sphere(position=(0.1, 0.55, 0.1), radius=0.06), 0.01),
        # Whole inside, and the cube whole inside the ball: the corners are √3/2 from its centre.
        (Sphere(position=(0.1, 0.1, 0.1), radius=0.2), 0.2),
        (Sphere(position=(0.0, 0.0, 0.0), radius=2.0), 1.5),
        # Flush, and in contact at a point.
        (Box(position=(1.0, 0.3, 0.2), **CUBE), 0.0),
        (Sphere(position=(0.1, 0.6, 0.1), radius=0.1), 0.0),
        # Near, with boxes around both that overlap.
        (Sphere(position=(0.6, 0.6, 0.6), radius=0.17), 0.0),
    ],
)
def test_how_deep_a_mesh_and_a_formula_enter_one_another(mesh, other, depth):
    for pair in ((mesh(), other), (other, mesh())):
        assert overlap_depth(*pair, touch=TOUCH) == pytest.approx(depth, rel=2e-3, abs=1e-12)


def test_a_lens_that_a_mesh_enters(mesh):
    # The front's vertex is 0.1 before the middle: 0.03 inside the cube's face at z = 1/2.
    lens = Lens(
        position=(0.1, 0.1, 0.57), axis=(0, 0, 1), thickness=0.2, aperture=0.3,
        first=LensSurface(radius=0.5), second=LensSurface(radius=-0.5),
    )  # fmt: skip
    # The face's point on the axis is 0.03 behind the front.
    assert overlap_depth(mesh(), lens, touch=TOUCH) == pytest.approx(0.03, rel=0.02)
    away = lens.model_copy(update={"position": (0.1, 0.1, 0.6)})  # the vertex touches the face
    assert overlap_depth(mesh(), away, touch=TOUCH) <= TOUCH
    inside = lens.model_copy(update={"position": (0.1, 0.1, 0.1)})
    assert overlap_depth(mesh(), inside, touch=TOUCH) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("position", "name", "least", "most"),
    [
        ((0.9, 0.1, 0.2), "cube", 0.03, 0.1),
        ((0.0, 0.0, 0.0), "cube", 0.4, 0.5),  # the very same place
        ((0.5, 0.0, 0.0), "cube", 0.05, 0.5),  # its faces' rims lie in the other's faces
        ((0.0, 0.1, 0.2), "bar", 0.1, 0.4),  # no corner of either is inside the other
        ((0.0, 1.49, 0.0), "globe", 0.0005, 0.01),  # a pole in the middle of a face
        ((0.1, 0.0, 0.0), "globe", 0.1, 0.55),  # the cube whole inside the ball
        ((1.0, 0.3, 0.2), "cube", 0.0, 0.0),
        ((0.0, 1.5 + 1e-7, 0.0), "globe", 0.0, 0.0),
        ((1.3, 1.3, 0.0), "globe", 0.0, 0.0),
    ],
)
def test_how_deep_two_meshes_enter_one_another(mesh, position, name, least, most):
    for pair in ((mesh(), mesh(name, position)), (mesh(name, position), mesh())):
        depth = overlap_depth(*pair, touch=TOUCH)
        assert least <= depth <= most * (1.0 + 1e-9)


def write_cuboids(path, *boxes):
    """A closed surface of several boxes, each a middle and a size."""
    points = np.concatenate([CORNERS * np.array(size) + np.array(at) for at, size in boxes])
    write_obj(path, points, np.concatenate([FACES + 8 * k for k in range(len(boxes))]))
    return Mesh(file=str(path), position=(0.0, 0.0, 0.0))


def test_an_overlap_behind_many_longer_touches_is_found(files):
    # Three bars whose tops lie in a foil of 1.5 µm: long edges of both are in the other one, and
    # only touch it, 0.75 µm deep. The corners of two small cubes share 2 mm, of which half is as
    # deep as a point can be. The pieces of their edges come last.
    small = (0.01, 0.01, 0.01)
    at = np.array([-0.4, 0.0, -0.5])
    bars = [((0.55, y, 0.75e-6 - 0.05), (0.5, 0.2, 0.1)) for y in (0.0, 0.3, 0.6)]
    one = write_cuboids(files / "bars.obj", bars[0], (at, small), *bars[1:])
    foil = ((0.0, 0.5, 0.75e-6), (1.0, 3.0, 1.5e-6))
    for shift, least, most in ((0.008, 0.9e-3, 1e-3), (0.0101, 0.0, TOUCH)):
        other = write_cuboids(files / f"foil {shift}.obj", foil, (at + shift, small))
        for pair in ((one, other), (other, one)):
            assert least <= overlap_depth(*pair, touch=TOUCH) <= most * (1.0 + 1e-9)


def test_turned_meshes_are_found_too(mesh):
    # Two bars across one another, 0.2 thick: no corner of either is in the other.
    one, other = mesh("bar"), mesh("bar", (0.0, 0.15, 0.0), (0.0, 70.0, 0.0))
    assert 0.005 < overlap_depth(one, other, touch=TOUCH) <= 0.05 + 1e-12
    apart = mesh("bar", (0.0, 0.2, 0.0), (0.0, 70.0, 0.0))
    assert overlap_depth(one, apart, touch=TOUCH) <= TOUCH


def glass(name, shape, medium, priority=0):
    return scenes.SceneObject(
        name=name, shape=shape, material=scenes.Dielectric(medium=medium, priority=priority)
    )


def test_a_mesh_in_glass_of_equal_priority_is_a_contradiction(mesh):
    ball = Sphere(position=(0.0, 0.7, 0.0), radius=0.3)
    with pytest.raises(SceneError) as caught:
        scenes.Scene(objects=[glass("ball", ball, "SF11"), glass("block", mesh(), "N-BK7")])
    (problem,) = caught.value.problems
    assert problem.path == "objects[1].material.priority"
    assert "'block' and 'ball' claim the same space, 0.1 m deep" in problem.message
    scenes.Scene(objects=[glass("ball", ball, "SF11", 1), glass("block", mesh(), "N-BK7")])
    scenes.Scene(objects=[glass("ball", ball, "N-BK7"), glass("block", mesh(), "N-BK7")])


def test_water_that_wets_its_glass_only_touches_it():
    # Water as a height field of a depth, flush with the walls and the floor of a tank around it.
    wave = {"amplitude": 0.05, "period": 0.7}
    water = HeightField(
        position=(0, 0, 0), size=(2.0, 1.0), waves=[wave], cells=(40, 20), depth=0.5
    )
    wall = Box(position=(1.05, 0.0, 0.0), size=(0.1, 2.0, 2.0))
    floor = Box(position=(0.0, -0.55, 0.0), size=(2.0, 0.1, 2.0))
    stone = Box(position=(0.0, -0.45, 0.0), size=(0.3, 0.1, 0.3))
    wet = [
        glass("water", water, "water"), glass("wall", wall, "N-BK7"),
        glass("floor", floor, "N-BK7"),
    ]  # fmt: skip
    scenes.Scene(objects=wet)
    with pytest.raises(SceneError, match=r"'stone' and 'water' claim the same space, 0\.05 m deep"):
        scenes.Scene(objects=[*wet[:2], glass("stone", stone, "SF11")])


def test_coordinates_in_single_precision_only_touch(files):
    points = np.float32(CORNERS + np.array([0.3, 0.7, 0.1])).astype(np.float64)
    write_obj(files / "rounded.obj", points, FACES)
    rounded = Mesh(file=str(files / "rounded.obj"), position=(-0.3, -0.7, -0.1))
    block = Box(position=(0.0, 1.0, 0.0), **CUBE)
    scenes.Scene(objects=[glass("one", rounded, "N-BK7"), glass("other", block, "SF11")])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_coordinates_far_from_a_files_own_origin_only_touch(files, sign):
    # In single precision they are known to 2⁻²⁴ of 1234.5, 7e-5, and the cubes' faces as well: by
    # as much the mesh enters the block, or is apart from it.
    far = np.array([0.0, sign * 1234.5678, 0.0])
    points = np.float32(CORNERS + far).astype(np.float64)
    write_obj(files / "far.obj", points, FACES)
    apart = Mesh(file=str(files / "far.obj"), position=tuple(-far))
    off = apart.vertices_world()[:, 1]
    assert max(abs(off.min() + 0.5), abs(off.max() - 0.5)) > 1e-6
    for y in (-1.0, 1.0):
        block = Box(position=(0.0, y, 0.0), **CUBE)
        scenes.Scene(objects=[glass("one", apart, "N-BK7"), glass("other", block, "SF11")])
    deep = Box(position=(0.0, 0.999, 0.0), **CUBE)
    with pytest.raises(SceneError, match="claim the same space"):
        scenes.Scene(objects=[glass("one", apart, "N-BK7"), glass("other", deep, "SF11")])


def test_fine_meshes_are_searched_too(mesh):
    # No timing is asserted: a search that compared all pairs, 6·10⁸, would not come to an end.
    fine = mesh("fine")
    assert len(fine.surface().triangles) == 25280
    beside = Box(position=(0.0, 1.45, 0.0), **CUBE)
    assert overlap_depth(fine, beside, touch=TOUCH) == pytest.approx(0.05, rel=2e-3)
    twin = mesh("fine", (0.0, 1.9, 0.0))
    assert 0.01 < overlap_depth(fine, twin, touch=TOUCH) <= 0.1


def test_the_nearest_point_of_a_triangle():
    # Seen from points over its face, its edges and its corners.
    triangle = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    for point, nearest in (
        ((0.2, 0.3, 5.0), (0.2, 0.3, 0.0)), ((0.4, -1.0, 1.0), (0.4, 0.0, 0.0)),
        ((1.0, 1.0, 0.0), (0.5, 0.5, 0.0)), ((3.0, -1.0, 0.0), (1.0, 0.0, 0.0)),
        ((-1.0, 0.4, 0.0), (0.0, 0.4, 0.0)), ((-1.0, -1.0, 2.0), (0.0, 0.0, 0.0)),
    ):  # fmt: skip
        found = nearest_on_triangles(np.array(point), triangle)
        np.testing.assert_allclose(found, [nearest], atol=1e-15)
    # A sliver without area is its longest side.
    sliver = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]])
    found = nearest_on_triangles(np.array([1.5, 1.0, 0.0]), sliver)
    np.testing.assert_allclose(found, [[1.5, 0.0, 0.0]], atol=1e-15)


def test_inside_is_where_a_surface_fills_all_directions():
    corners = CORNERS[FACES]
    random = np.random.default_rng(3)
    for point in random.uniform(-1.0, 1.0, (200, 3)):
        sides = np.abs(point) - 0.5
        outside = np.linalg.norm(np.maximum(sides, 0.0))
        expected = -outside if outside > 0.0 else -sides.max()
        assert depth_inside(point, corners) == pytest.approx(expected, abs=1e-14)


def test_pairs_of_boxes_are_those_of_all_pairs():
    random = np.random.default_rng(4)
    one, other = (random.uniform(0, 1, (k, 1, 3)) + random.uniform(0, 0.1, (k, 3, 3))
                  for k in (130, 37))  # fmt: skip
    low, high = one.min(axis=1)[:, None], one.max(axis=1)[:, None]
    meets = np.all((low <= other.max(axis=1)) & (high >= other.min(axis=1)), axis=2)
    for pair, expected in (((one, other), meets), ((other, one), meets.T)):
        found = np.zeros(expected.shape, dtype=bool)
        found[box_pairs(*pair, 1 << 20)] = True
        np.testing.assert_array_equal(found, expected)
    assert 0 < meets.sum() < meets.size
    assert len(box_pairs(one, other, 7)[0]) <= 7
