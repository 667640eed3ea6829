"""Which objects may touch or hold points of another one's surface."""

import numpy as np

import scenes
from scenes.shapes.reach import may_meet

__all__ = ["find_neighbours", "touch_distance"]

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
    spheres = [
        None if isinstance(one.shape, scenes.Plane) else one.shape.bounding_sphere()
        for one in scene.objects
    ]
    for i, one in enumerate(scene.objects):
        for j in range(i + 1, len(scene.objects)):
            if not (filled[i] or filled[j]):
                continue
            here, there = spheres[i], spheres[j]
            if here is not None and there is not None:
                apart = float(np.linalg.norm(np.subtract(here[0], there[0])))
                if apart - here[1] - there[1] > slack:
                    continue
            if may_meet(one.shape, scene.objects[j].shape, slack):
                near[i].append(j)
                near[j].append(i)
    return near
