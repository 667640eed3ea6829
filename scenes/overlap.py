"""Solids that claim the same space.

Where solids overlap, the one of the higher priority fills the space (Schmidt & Budge 2002, "Simple
nested dielectrics in ray traced images", J. Graph. Tools 7(2), 1). Two different media of equal
priority are a contradiction, and an error.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.errors import Problem
from scenes.flush import is_sheet
from scenes.materials import Dielectric
from scenes.mesh_overlap import mesh_overlap_depth
from scenes.objects import SceneObject
from scenes.shapes import Mesh, Triangulated
from scenes.shapes.depth import height_above
from scenes.shapes.reach import close_pairs, count_close_pairs, may_meet

__all__ = ["MAX_CLOSE_PAIRS", "crowd_problems", "overlap_depth", "overlap_problems"]

FloatArray = NDArray[np.float64]

_TOUCH = 1e-9
"""Solids that enter one another by less than this part of the smaller one's size only touch."""

_TOUCH_OF_MESHES = 1e-6
"""The same where one is made of triangles: files keep coordinates in single precision, to 6e-8."""

_ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
"""Of the largest coordinate: how far faces that are meant to touch can be apart, or overlap."""

_ROUNDING_OF_FILES = float(np.finfo(np.float32).eps)
"""The same, of the largest coordinate in a mesh's own file: that of both faces, to half of it."""

MAX_CLOSE_PAIRS = 100_000
"""Each pair takes some tenths of a millisecond."""

_MOST_SEARCHES = 1500
"""Pairs whose depth is searched for: each takes some 2.4 ms."""

_TRIANGLES_A_SEARCH = 4000
"""Triangles of meshes that take as long: what touches only its neighbours is never too much, since
a scene has at most 2²¹ of them."""

_MOST_CLASHES = 20
"""Solids in one place that are told of."""

_CELLS = 12
_STARTS = 8
_ROUNDS = 24


def overlap_problems(objects: Mapping[int, SceneObject]) -> list[Problem]:
    """Every pair of different media that claims the same space with the same priority."""
    solids = [
        (index, one) for index, one in objects.items() if isinstance(one.material, Dielectric)
    ]
    pairs = close_pairs([one.shape for _, one in solids])
    problems: list[Problem] = []
    searches = 0.0
    for first, second in pairs:
        (i, one), (j, other) = solids[first], solids[second]
        if not _is_contested(one, other):
            continue
        searches += 1.0 + (_triangles(one.shape) + _triangles(other.shape)) / _TRIANGLES_A_SEARCH
        if searches > _MOST_SEARCHES:
            return [*problems, _too_many_searches()]
        problem = _clash(i, one, j, other)
        if problem is not None:
            problems.append(problem)
            if len(problems) == _MOST_CLASHES:
                break
    return problems


def crowd_problems(objects: Mapping[int, SceneObject]) -> list[Problem]:
    """More objects in one place than can be looked at pair by pair.

    Only pairs with a solid of a medium, and pairs of sheets, are looked at.
    """
    opaque = [one for one in objects.values() if not isinstance(one.material, Dielectric)]
    pairs = count_close_pairs([one.shape for one in objects.values()])
    if pairs > MAX_CLOSE_PAIRS:
        pairs -= count_close_pairs([one.shape for one in opaque])
        pairs += count_close_pairs([one.shape for one in opaque if is_sheet(one.shape)])
    if pairs <= MAX_CLOSE_PAIRS:
        return []
    allowed = (
        f"at most {MAX_CLOSE_PAIRS} pairs, of glass and anything else or of two sheets, whose"
        " bounding spheres meet"
    )
    return [Problem("objects", f"{pairs} pairs are close to each other; allowed: {allowed}", None,
                    allowed)]  # fmt: skip


def _triangles(shape: Any) -> int:
    return len(shape.local_surface().triangles) if isinstance(shape, Triangulated) else 0


def _too_many_searches() -> Problem:
    allowed = (
        f"at most {_MOST_SEARCHES} such pairs, fewer of large meshes; different priorities, which"
        " settle who fills what, or a wider gap"
    )
    message = (
        "more pairs of solids than can be searched for overlaps are near one another, of different"
        f" media and of the same priority; allowed: {allowed}"
    )
    return Problem("objects", message, None, allowed)


def _is_contested(one: SceneObject, other: SceneObject) -> bool:
    """Whether two solids may meet, and nothing says which of them fills what they share."""
    assert isinstance(one.material, Dielectric)
    assert isinstance(other.material, Dielectric)
    return (
        one.material.priority == other.material.priority
        and one.material.resolved() != other.material.resolved()
        and may_meet(one.shape, other.shape)
    )


def _touch(one: Any, other: Any) -> float:
    """How deep two solids may enter one another and only touch [m]."""
    spheres = [shape.bounding_sphere() for shape in (one, other)]
    meshed = isinstance(one, Triangulated) or isinstance(other, Triangulated)
    farthest = max(float(np.max(np.abs(centre))) + float(radius) for centre, radius in spheres)
    in_files = [
        float(np.max(np.abs(shape.local_surface().vertices)))
        for shape in (one, other) if isinstance(shape, Mesh)
    ]  # fmt: skip
    smaller = float(min(radius for _, radius in spheres))
    return max(
        smaller * (_TOUCH_OF_MESHES if meshed else _TOUCH),
        _ROUNDING * farthest,
        _ROUNDING_OF_FILES * max(in_files, default=0.0),
    )


def _clash(i: int, one: SceneObject, j: int, other: SceneObject) -> Problem | None:
    """What is wrong between two contested solids, if anything is."""
    assert isinstance(other.material, Dielectric)
    priority = other.material.priority
    touch = _touch(one.shape, other.shape)
    depth = overlap_depth(one.shape, other.shape, touch)
    if depth <= touch:
        return None
    names = f"{other.name or f'objects[{j}]'!r} and {one.name or f'objects[{i}]'!r}"
    allowed = f"a priority other than {priority} for the one that fills the space they share"
    message = (
        f"{names} claim the same space, {depth:.3g} m deep, with different media and the same"
        f" priority {priority}; allowed: {allowed}, or shapes apart from each other"
    )
    return Problem(f"objects[{j}].material.priority", message, priority, allowed)


def overlap_depth(one: Any, other: Any, touch: float = 0.0) -> float:
    """How deep two solids enter one another [m]: how deep inside both a point can be; 0 if none.

    The height above both, max(h₁, h₂), is searched for its lowest point: on a grid over what
    both solids' boxes share, then on ever finer grids about the best points found. Where one is
    made of triangles, it is how deep the surface of one lies inside the other.

    Args:
        one: a closed shape.
        other: a closed shape.
        touch: up to what depth solids of triangles only touch [m].
    """
    if isinstance(one, Triangulated):
        return mesh_overlap_depth(one, other, touch)
    if isinstance(other, Triangulated):
        return mesh_overlap_depth(other, one, touch)
    low = np.maximum(_box(one)[0], _box(other)[0])
    high = np.minimum(_box(one)[1], _box(other)[1])
    if np.any(low > high):
        return 0.0
    lattice = (np.indices((_CELLS,) * 3).reshape(3, -1).T + 0.5) / _CELLS
    points = low + lattice * (high - low)
    cell = (high - low) / _CELLS
    best = points
    lowest = np.inf
    for _ in range(_ROUNDS):
        heights = [height_above(shape, points) for shape in (one, other)]
        assert heights[0] is not None  # every closed shape but triangles is known there
        assert heights[1] is not None
        height = np.maximum(heights[0], heights[1])
        order = np.argsort(height, kind="stable")[:_STARTS]
        if height[order[0]] < lowest:
            lowest, best = float(height[order[0]]), points[order]
        nearby = (np.indices((3,) * 3).reshape(3, -1).T - 1.0) * 0.5 * cell
        points = (best[:, None, :] + nearby).reshape(-1, 3)
        cell = cell * 0.6
    return -lowest if lowest < 0.0 else 0.0


def _box(shape: Any) -> tuple[FloatArray, FloatArray]:
    """A box around the bounding sphere."""
    centre, radius = shape.bounding_sphere()
    return np.asarray(centre) - radius, np.asarray(centre) + radius
