"""What cannot be together with light from infinitely far away."""

from collections.abc import Mapping

from scenes.emitters import DistantEmitter, Emitter
from scenes.errors import Problem
from scenes.materials import is_specular
from scenes.media import AMBIENT_NAMES, DescribedMedium, resolve_medium
from scenes.objects import SceneObject
from scenes.shapes import Plane

__all__ = ["endless_problems"]


def endless_problems(
    ambient: str | DescribedMedium,
    objects: Mapping[int, SceneObject],
    emitters: Mapping[int, Emitter],
) -> list[Problem]:
    """Light from afar ends in an ambient that absorbs; mirrors without end would reflect it all.

    Args:
        ambient: What surrounds the objects.
        objects: Objects by their index in the file.
        emitters: Emitters by their index in the file.
    """
    distant = [
        one.name or f"emitters[{index}]"
        for index, one in emitters.items()
        if isinstance(one, DistantEmitter)
    ]
    if not distant:
        return []
    problems = []
    medium = None if ambient in AMBIENT_NAMES else resolve_medium(ambient)
    if medium is not None and medium.absorption is not None:
        allowed = f"a medium that does not absorb, since {distant[0]} is infinitely far away"
        problems.append(Problem("ambient", f"must be {allowed}", medium.name, allowed))
    for index, one in objects.items():
        if isinstance(one.shape, Plane) and is_specular(one.material):
            allowed = f"finite, since {distant[0]} would send it photons without end"
            problems.append(
                Problem(f"objects[{index}].shape", f"a mirror must be {allowed}", None, allowed)
            )
    return problems
