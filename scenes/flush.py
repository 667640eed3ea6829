"""Flat faces in one place, where nothing says which of them light meets.

Faces in one place are one surface, and the first that a ray finds is dealt with. That is well
defined where glass touches glass, or something opaque; it is not for

- two sheets of different opaque materials: which of them is seen would be an accident;
- a polariser on glass: it would have to filter and to refract.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from scenes.errors import Problem
from scenes.flat_patches import flat_patches, share_a_place
from scenes.materials import Dielectric
from scenes.objects import SceneObject
from scenes.polariser import Polariser
from scenes.shapes import Disk, Plane, Rectangle
from scenes.shapes.reach import close_pairs, may_meet

__all__ = ["flush_pairs", "flush_problems", "is_sheet"]

_TOUCH = 1e-9
"""Faces nearer than this part of the smaller one's size are in one place, as in
`scenes.overlap`."""


def flush_problems(objects: Mapping[int, SceneObject]) -> list[Problem]:
    """Every pair of sheets, or of a polariser and glass, that lies in one place.

    Args:
        objects: by their index in the file.
    """
    return [_problem(i, objects[i], j, objects[j]) for i, j in flush_pairs(objects)]


def flush_pairs(
    objects: Mapping[int, SceneObject], touch: float | None = None
) -> Iterator[tuple[int, int]]:
    """Indices of the pairs of sheets, or of a polariser and glass, that lie in one place.

    Args:
        objects: by their index in the file.
        touch: how near faces are in one place [m]; None: 10⁻⁹ of the smaller one's size.
    """
    filters = any(isinstance(one.material, Polariser) for one in objects.values())
    indices = [
        index for index, one in objects.items()
        if (filters if isinstance(one.material, Dielectric) else is_sheet(one.shape))
    ]  # fmt: skip
    shapes = [objects[index].shape for index in indices]
    for first, second in close_pairs(shapes, touch or 0.0):
        i, j = indices[first], indices[second]
        if _is_clear(objects[i], objects[j]):
            continue
        if _are_flush(objects[i].shape, objects[j].shape, touch):
            yield i, j


def is_sheet(shape: Any) -> bool:
    """Whether a shape is flat and has no inside."""
    return isinstance(shape, Rectangle | Disk | Plane)


def _is_clear(one: SceneObject, other: SceneObject) -> bool:
    """Whether it does not matter if two objects lie in one place."""
    materials = (one.material, other.material)
    if any(isinstance(material, Dielectric) for material in materials):
        return not any(isinstance(material, Polariser) for material in materials)
    return one.material == other.material and not isinstance(one.material, Polariser)


def _are_flush(one: Any, other: Any, touch: float | None) -> bool:
    """Whether two shapes, one of them a sheet, lie flush in one place."""
    sizes = [
        shape.bounding_sphere()[1] for shape in (one, other) if not isinstance(shape, Plane)
    ]
    if touch is None:
        touch = _TOUCH * float(min(sizes, default=1.0))
    if not may_meet(one, other, touch):
        return False
    sheet, thing = (one, other) if is_sheet(one) else (other, one)
    (patch,) = flat_patches(sheet, np.array(sheet.normal))
    faces = flat_patches(thing, patch.normal, patch.middle, touch)
    return any(share_a_place(patch, face, touch) for face in faces)


def _problem(i: int, one: SceneObject, j: int, other: SceneObject) -> Problem:
    names = f"{other.name or f'objects[{j}]'!r} and {one.name or f'objects[{i}]'!r}"
    if any(isinstance(thing.material, Dielectric) for thing in (one, other)):
        why = "a polariser on glass would have to filter and to refract"
        allowed = "a gap between them, or the polariser wholly inside the glass or outside it"
    else:
        why = "nothing says which of them light meets"
        polarise = any(isinstance(thing.material, Polariser) for thing in (one, other))
        allowed = "a gap between them" + ("" if polarise else ", or the same material")
    message = f"{names} lie flush in one place, and {why}; allowed: {allowed}"
    return Problem(f"objects[{j}].shape", message, None, allowed)
