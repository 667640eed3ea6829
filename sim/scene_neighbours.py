"""Which objects may touch or hold points of another one's surface."""

import numpy as np

import scenes
from scenes.shapes.reach import close_pairs, may_meet

__all__ = ["find_neighbours", "rank_media", "touch_distance"]

_TOUCH_BITS = {"float64": 40, "float32": 17}
"""Surfaces nearer to one another than 2^−this of the scene's size are in one place. That is some
hundred times the rounding of coordinates, and nothing that a bench could tell from contact."""


def touch_distance(bounding_radius: float, precision: str) -> float:
    """How near surfaces are in one place [m]."""
    return float(np.ldexp(bounding_radius, -_TOUCH_BITS[precision]))


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
