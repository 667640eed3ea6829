"""Which objects may touch or hold points of another one's surface."""

import numpy as np

import scenes
from scenes.flush import flush_pairs
from scenes.shapes.reach import close_pairs, may_meet
from sim.errors import SettingsError

__all__ = [
    "find_neighbours",
    "near_pairs",
    "rank_media",
    "refuse_merged_sheets",
    "scene_size",
    "touch_distance",
]

_TOUCH_BITS = {"float64": 40, "float32": 17}
"""Surfaces nearer to one another than 2^−this of the scene's size are in one place. That is some
hundred times the rounding of coordinates, and nothing that a bench could tell from contact."""

_NEAR = 1e-4
"""Solids within this part of the scene's size of each other may touch, whatever the precision."""


def scene_size(scene: scenes.Scene) -> float:
    """Diameter of a sphere around the finite objects, at most twice too large [m]."""
    spheres = [
        item.shape.bounding_sphere()
        for item in scene.objects
        if not isinstance(item.shape, scenes.Plane)
    ]
    if not spheres:
        return 1.0
    middle = np.mean([centre for centre, _ in spheres], axis=0)
    return 2.0 * max(float(np.linalg.norm(centre - middle)) + radius for centre, radius in spheres)


def near_pairs(scene: scenes.Scene) -> list[tuple[int, int]]:
    """Pairs of objects, one of them made of a medium, that may touch, nest or overlap."""
    near = find_neighbours(scene, _NEAR * scene_size(scene))
    return [(i, j) for i, row in enumerate(near) for j in row if i < j]


def touch_distance(bounding_radius: float, precision: str) -> float:
    """How near surfaces are in one place [m]."""
    return float(np.ldexp(bounding_radius, -_TOUCH_BITS[precision]))


def refuse_merged_sheets(scene: scenes.Scene, touch: float, precision: str) -> None:
    """Make sure that no polariser becomes one with glass that the scene keeps it apart from.

    Args:
        scene: which has been checked for polarisers that lie on glass.
        touch: how near surfaces are in one place [m].
        precision: "float32" or "float64".

    Raises:
        SettingsError: single precision cannot tell a polariser from glass so near.
    """
    if precision != "float32":
        return
    sheets = (scenes.Dielectric, scenes.Polariser)
    objects = {i: one for i, one in enumerate(scene.objects) if isinstance(one.material, sheets)}
    for pair in flush_pairs(objects, touch):
        if any(isinstance(objects[index].material, scenes.Dielectric) for index in pair):
            one, other = (objects[index].name or f"objects[{index}]" for index in pair)
            reason = f"{one!r} and {other!r} are nearer to one another than {touch:.2g} m"
            raise SettingsError("precision", precision, f"'float64', since {reason}")


def find_neighbours(scene: scenes.Scene, slack: float) -> list[list[int]]:
    """Of each object, those that may come nearer than `slack` [m] to it.

    Pairs count in which one is made of a medium: what opaque objects do among themselves no light
    can tell.
    """
    near: list[list[int]] = [[] for _ in scene.objects]
    filled = [isinstance(one.material, scenes.Dielectric) for one in scene.objects]
    shapes = [one.shape for one in scene.objects]
    for i, j in close_pairs(shapes, slack):
        if (filled[i] or filled[j]) and may_meet(shapes[i], shapes[j], slack):
            near[i].append(j)
            near[j].append(i)
    return near


def rank_media(scene: scenes.Scene) -> list[int]:
    """Of each object, its place among those made of a medium, from 0: by priority, then by order.

    No two have the same, so that solids of one priority that overlap by a hair, as rounding makes
    them, are dealt with like any others: of equal priorities the first in the scene ranks highest.
    """
    priorities = [
        (one.material.priority, -prim)
        for prim, one in enumerate(scene.objects)
        if isinstance(one.material, scenes.Dielectric)
    ]
    ranks = [0] * len(scene.objects)
    for rank, (_, minus_prim) in enumerate(sorted(priorities)):
        ranks[-minus_prim] = rank
    return ranks
