"""Rays that only just touch: tangents, edges, corners, faces that they run along or start on."""

import math

import numpy as np
import pytest

import scenes

ETA = 1.5


def spread(value, precision, ulps=4):
    """`value` and its nearest neighbours among the precision's numbers, as float64."""
    kind = np.dtype(precision).type
    below, above = [kind(value)], [kind(value)]
    for _ in range(ulps):
        below.append(np.nextafter(below[-1], kind(-np.inf)))
        above.append(np.nextafter(above[-1], kind(np.inf)))
    return np.array([*below[:0:-1], *above], dtype=np.float64)


def assert_sound(paths, precision, eps):
    """Every path is of finite points and unit directions, ends, and splits no more than there is.

    Light that enters at grazing incidence meets the critical angle inside, on one side of it or
    the other, so that it may go round for long; as much as T = 4 cosθ of it, which is next to
    nothing, as transmittances of paths that have not ended must show.
    """
    for path in paths:
        assert np.all(np.isfinite(path.points))
        norms = np.linalg.norm(path.directions, axis=1)
        np.testing.assert_allclose(norms, 1.0, rtol=0, atol=4 * eps[precision])
        assert np.all((path.reflectances >= 0.0) & (path.reflectances <= 1.0))
        if path.events[-1] == "limit":
            entered = 1.0 - path.reflectances[0]
            # cos²θ = 1 − (b/R)² is at most some 2 · 4 + 4 ε here.
            assert entered <= 4.0 * ETA * math.sqrt(16.0 * eps[precision])


@pytest.mark.parametrize("far", [3.0, 1e3])
def test_tangents_of_a_sphere(follow, solid, precision, eps, far):
    ball = solid(scenes.Sphere(position=(0, 0, 0), radius=1.0), ETA)
    heights = spread(1.0, precision)
    starts = np.column_stack([np.full(9, -far), heights, np.zeros(9)])
    paths = follow([ball], starts, (1.0, 0.0, 0.0), precision=precision)
    assert_sound(paths, precision, eps)
    for height, path in zip(heights, paths, strict=True):
        if height > 1.0:
            assert path.events == ("escape",)
        elif height < 1.0:
            # The ball is met by no more than the half chord, √(1 − h²), before its middle.
            assert path.objects[0] == "solid"
            assert abs(path.points[1][0]) <= math.sqrt(16 * eps[precision]) + far * eps[precision]
    # What goes past is not turned, and what is reflected hardly: by 2 cosθ.
    reflected = follow([ball], starts, (1.0, 0.0, 0.0), precision=precision, branches=["reflect"])
    for path in reflected:
        np.testing.assert_allclose(
            path.directions[-1], [1, 0, 0], atol=4 * math.sqrt(16 * eps[precision])
        )


@pytest.mark.parametrize("conic", [0.0, -0.7, 0.6])
def test_tangents_of_caps(follow, solid, precision, eps, conic):
    # Across the vertex, in the plane that touches it: a hair into the glass, at it, and above it.
    lens = scenes.Lens(
        position=(0, 0, 0.25), axis=(0, 0, 1), thickness=0.5, aperture=1.0,
        first=scenes.LensSurface(radius=1.0, conic=conic),
        second=scenes.LensSurface(curvature=0.0),
    )  # fmt: skip
    depths = [0.0, *(s * k * eps[precision] for k in (0.5, 1, 2, 4) for s in (1.0, -1.0))]
    starts = np.column_stack([np.full(9, -2.0), np.zeros(9), depths])
    paths = follow([solid(lens, ETA)], starts, (1.0, 0.0, 0.0), precision=precision)
    assert_sound(paths, precision, eps)
    for depth, path in zip(depths, paths, strict=True):
        # The frame's origin is half the thickness away, so that the height is known to ε/4 or so.
        if depth < -eps[precision]:
            assert path.events == ("escape",)
        if len(path.events) > 1:
            # The cap is met where it is that high: ρ² ≤ 2 R z.
            assert abs(path.points[1][0]) <= math.sqrt(2.0 * (abs(depth) + 2 * eps[precision]))


PRISM = scenes.Prism(position=(0, 0, 0), apex_deg=60.0, base=1.0, length=1.0)


def aimed_at(targets, way, distance=2.0):
    way = np.asarray(way, dtype=np.float64)
    way = way / np.linalg.norm(way)
    return np.asarray(targets) - distance * way, np.broadcast_to(way, np.shape(targets))


def test_through_edges_and_corners_of_a_prism(follow, solid, precision, eps):
    corners = PRISM.vertices_world()
    middles = [0.5 * (a + b) for a in corners for b in corners]
    targets = np.array([*corners, *middles])
    ways = np.random.default_rng(41).normal(size=(40, 3))
    for way in ways:
        starts, directions = aimed_at(targets, way)
        paths = follow(
            [solid(PRISM, ETA)], starts, directions, precision=precision, max_interactions=64
        )
        assert_sound(paths, precision, eps)
        for path in paths:
            # It enters and leaves, or does neither: refractions come in pairs.
            if path.events[-1] == "escape":
                assert path.events.count("refract") % 2 == 0


def test_what_goes_in_at_an_edge_comes_out(follow, solid, precision, eps):
    # Light is followed for 1000 surfaces from an edge on: total reflection may hold it, but it must
    # not get out through the glass without having met it.
    corners = PRISM.vertices_world()
    targets = np.array([0.5 * (corners[2] + corners[5]), corners[2], corners[0]])
    ways = [(0.3, -1.0, 0.1), (-0.2, -1.0, 0.4), (1.0, -0.2, 0.0), (0.0, -1.0, 0.0)]
    normals, offsets = PRISM.faces()
    for way in ways:
        starts, directions = aimed_at(targets, way)
        for path in follow(
            [solid(PRISM, ETA)], starts, directions, precision=precision, max_interactions=1000
        ):
            inside = False
            for k, event in enumerate(path.events):
                if event == "refract":
                    inside = not inside
                elif event == "escape":
                    assert not inside
                point = path.points[k + 1]
                if event != "escape":
                    outside = np.max(normals @ point - offsets)
                    assert abs(outside) <= 32 * eps[precision]


@pytest.mark.parametrize("height", [0.5, 0.0])
def test_along_a_face(follow, solid, precision, eps, height):
    # In the plane of a box's upper face, and along its axis: parallel to four of its faces.
    box = solid(scenes.Box(position=(0, 0, 0), size=(1.0, 1.0, 1.0)), ETA)
    heights = spread(height, precision) if height else np.array([0.0])
    starts = np.column_stack([np.full(len(heights), -2.0), heights, np.zeros(len(heights))])
    paths = follow([box], starts, (1.0, 0.0, 0.0), precision=precision)
    assert_sound(paths, precision, eps)
    for one, path in zip(heights, paths, strict=True):
        if one > 0.5:
            assert path.events == ("escape",)
        else:
            assert path.events == ("refract", "refract", "escape")
            np.testing.assert_array_equal(path.directions[-1], [1.0, 0.0, 0.0])
            assert path.points[1][0] == -0.5
            assert path.points[2][0] == 0.5


@pytest.mark.parametrize("corner", [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5)])
def test_along_an_edge(follow, solid, precision, eps, corner):
    box = solid(scenes.Box(position=(0, 0, 0), size=(1.0, 1.0, 1.0)), ETA)
    paths = follow([box], (-2.0, *corner), (1.0, 0.0, 0.0), precision=precision)
    assert_sound(paths, precision, eps)
    assert paths[0].events in {("escape",), ("refract", "refract", "escape")}


def shapes_with_a_point():
    """Solids, a point of their surface that is exact in either precision, its outward normal."""
    lens = scenes.Lens(
        position=(0, 0, 0), axis=(0, 0, 1), thickness=0.5, aperture=1.0,
        first=scenes.LensSurface(radius=1.0), second=scenes.LensSurface(radius=-2.0),
    )  # fmt: skip
    return {
        "sphere": (scenes.Sphere(position=(0, 0, 0), radius=1.0), (1.0, 0.0, 0.0), (1, 0, 0)),
        "box": (scenes.Box(position=(0, 0, 0), size=(1, 1, 1)), (0.125, 0.5, 0.25), (0, 1, 0)),
        "front": (lens, (0.0, 0.0, -0.25), (0, 0, -1)),
        "back": (lens, (0.0, 0.0, 0.25), (0, 0, 1)),
        "rim": (lens, (0.5, 0.0, 0.0), (1, 0, 0)),
    }


@pytest.mark.parametrize("name", ["sphere", "box", "front", "back", "rim"])
def test_a_ray_that_starts_on_a_surface_starts_before_or_behind_it(
    follow, solid, precision, eps, name
):
    # Rounding decides which: the path is that of a start a hair further out or further in.
    shape, point, normal = shapes_with_a_point()[name]
    normal = np.array(normal, dtype=np.float64)
    across = np.array([normal[1], normal[2], normal[0]])
    objects = [solid(shape, ETA)]
    for slope in (0.0, 0.25, -0.5):
        for side in (-1.0, 1.0):
            way = side * normal + slope * across
            way /= np.linalg.norm(way)
            hair = 32 * eps[precision] * normal
            path, *near = follow(
                objects, point + np.array([0.0 * hair, hair, -hair]), way, precision=precision
            )
            assert path.events in {one.events for one in near}
            same = next(one for one in near if one.events == path.events)
            # A start that is off by 32 ε, where the surfaces are curved by 1 and light is refracted
            # twice.
            slack = 4 * 32 * eps[precision]
            np.testing.assert_allclose(path.directions, same.directions, rtol=0, atol=slack)
            np.testing.assert_allclose(path.points[:-1], same.points[:-1], rtol=0, atol=slack)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_on_a_flat_face_it_starts_before_it_whichever_way_it_goes(follow, solid, precision, side):
    box = solid(scenes.Box(position=(0, 0, 0), size=(1.0, 1.0, 1.0)), ETA)
    (path,) = follow([box], (0.125, 0.5, 0.25), (0.0, side, 0.0), precision=precision)
    assert path.events[0] == "refract"
    np.testing.assert_array_equal(path.points[1], (0.125, 0.5, 0.25))
    assert path.events.count("refract") == (1 if side > 0.0 else 2)


def test_a_ray_that_starts_next_to_a_surface_is_on_its_own_side(follow, solid, precision, eps):
    box = solid(scenes.Box(position=(0, 0, 0), size=(1.0, 1.0, 1.0)), ETA)
    below, _, above = spread(0.5, precision, ulps=1)
    up, down = (0.3, 1.0, 0.2), (0.3, -1.0, 0.2)
    outward_from_above, inward_from_above = (
        follow([box], (0, above, 0), way, precision=precision)[0] for way in (up, down)
    )
    outward_from_below, inward_from_below = (
        follow([box], (0, below, 0), way, precision=precision)[0] for way in (up, down)
    )
    assert outward_from_above.events == ("escape",)
    assert inward_from_above.events[0] == "refract"
    assert inward_from_above.points[1][1] == 0.5
    assert outward_from_below.events == ("refract", "escape")
    assert inward_from_below.points[1][1] == pytest.approx(-0.5, abs=4 * eps[precision])
