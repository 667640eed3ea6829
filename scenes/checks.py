"""Checks that need more than one part of a scene: names, and ranges of wavelength."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from scenes.emitters import AnyEmitter, Emitter
from scenes.endless import endless_problems
from scenes.errors import Problem
from scenes.film import Film
from scenes.flush import flush_problems
from scenes.materials import Dielectric, Metal
from scenes.media import AMBIENT_NAMES, AmbientSpec, DescribedMedium, resolve_medium
from scenes.objects import SceneObject
from scenes.overlap import crowd_problems, overlap_problems
from scenes.sensors import AnySensor, Sensor, bin_problems
from spectra import Medium, WavelengthOutOfRange, air_index

__all__ = ["MOST_OBJECTS", "cross_problems", "cross_problems_of_valid_parts", "used_ranges_nm"]

MOST_OBJECTS = 4096
"""In a scene; also the most entries of any list that are looked at when a file is wrong."""

Interval = tuple[float, float]

_Known = tuple[str, str, Interval]
"""The path of a description in the file, what it describes, and its range of wavelengths [nm]."""

_FILM: TypeAdapter[Any] = TypeAdapter(Film)
_AMBIENT: TypeAdapter[Any] = TypeAdapter(AmbientSpec)
_OBJECT: TypeAdapter[Any] = TypeAdapter(SceneObject)
_EMITTER: TypeAdapter[Any] = TypeAdapter(AnyEmitter)
_SENSOR: TypeAdapter[Any] = TypeAdapter(AnySensor)


def used_ranges_nm(film: Film, emitters: Sequence[Emitter]) -> list[Interval]:
    """The wavelengths that are traced [nm]: what an emitter emits and the film records.

    Without any emitter it is all that the film records.
    """
    film_low, film_high = float(film.edges_nm[0]), float(film.edges_nm[-1])
    if not emitters:
        return [(film_low, film_high)]
    supports = [emitter.emission().support_nm for emitter in emitters]
    clipped = [(max(low, film_low), min(high, film_high)) for low, high in supports]
    return [(low, high) for low, high in clipped if low <= high]


def cross_problems(
    *,
    film: Film,
    ambient: str | DescribedMedium,
    objects: Mapping[int, SceneObject],
    emitters: Mapping[int, Emitter],
    sensors: Mapping[int, Sensor],
) -> list[Problem]:
    """What is wrong between the parts of a scene.

    Args:
        film: The film.
        ambient: What surrounds the objects.
        objects: Objects by their index in the file.
        emitters: Emitters by their index in the file.
        sensors: Sensors by their index in the file.
    """
    crowd = crowd_problems(objects)
    return [
        *_repeated_names("objects", {i: one.name for i, one in objects.items()}),
        *_repeated_names("emitters", {i: one.name for i, one in emitters.items()}),
        *_repeated_names("sensors", {i: one.name for i, one in sensors.items()}),
        *bin_problems(film, sensors),
        *_range_problems(used_ranges_nm(film, list(emitters.values())), ambient, objects),
        *(crowd or [*overlap_problems(objects), *flush_problems(objects)]),
        *endless_problems(ambient, objects, emitters),
    ]


def _repeated_names(field: str, names: Mapping[int, str]) -> list[Problem]:
    full = {index: name or f"{field}[{index}]" for index, name in names.items()}
    counts = Counter(full.values())
    allowed = "a name that nothing else in the list has"
    return [
        Problem(f"{field}[{index}].name", f"{name!r} is used {counts[name]} times", name, allowed)
        for index, name in full.items()
        if counts[name] > 1
    ]


def _range_problems(
    used: Sequence[Interval], ambient: str | DescribedMedium, objects: Mapping[int, SceneObject]
) -> list[Problem]:
    media = {
        f"objects[{index}].material.medium": one.material.resolved()
        for index, one in objects.items()
        if isinstance(one.material, Dielectric)
    }
    surrounding = None if ambient in AMBIENT_NAMES else resolve_medium(ambient)
    if surrounding is not None:
        media["ambient"] = surrounding
    known = [(path, medium.name, medium.wavelength_range_nm) for path, medium in media.items()]
    known += [*_known_absorptions(media, objects), *_known_metals(objects)]
    problems = [problem for one in known for problem in _uncovered(*one, used)]
    reference = surrounding.relative_to if surrounding is not None else ambient
    if reference != "reference" and any(one.relative_to != reference for one in media.values()):
        problems += _outside_air(used)
    return problems


def _known_absorptions(
    media: Mapping[str, Medium], objects: Mapping[int, SceneObject]
) -> list[_Known]:
    """Where the media's absorptions are described, and for which wavelengths."""
    beside = {
        f"objects[{index}].material.medium": f"objects[{index}].material.absorption"
        for index, one in objects.items()
        if isinstance(one.material, Dielectric) and one.material.absorption is not None
    }
    return [
        (
            beside.get(path, f"{path}.absorption"),
            "the absorption",
            medium.absorption.wavelength_range_nm,
        )
        for path, medium in media.items()
        if medium.absorption is not None
    ]


def _known_metals(objects: Mapping[int, SceneObject]) -> list[_Known]:
    metals = {
        index: one.material.resolved()
        for index, one in objects.items()
        if isinstance(one.material, Metal)
    }
    return [
        (f"objects[{index}].material.metal", metal.name, metal.wavelength_range_nm)
        for index, metal in metals.items()
    ]


def _uncovered(path: str, name: str, range_nm: Interval, used: Sequence[Interval]) -> list[Problem]:
    lowest, highest = range_nm
    for low, high in used:
        if low < lowest or high > highest:
            allowed = f"wavelengths between {lowest:g} and {highest:g} nm"
            message = (
                f"{name} is known between {lowest:g} and {highest:g} nm,"
                f" but the emitters and the film use {low:g} to {high:g} nm;"
                " narrow the film's bands or the emitters' spectra"
            )
            return [Problem(path, message, (low, high), allowed)]
    return []


def _outside_air(used: Sequence[Interval]) -> list[Problem]:
    """Between vacuum and air, indices are converted by that of air, which has its own range."""
    try:
        air_index(np.array([end for interval in used for end in interval]))
    except WavelengthOutOfRange as error:
        return [Problem("ambient", f"{error}", None, 'ambient = "reference"')]
    return []


def cross_problems_of_valid_parts(
    data: Mapping[str, Any], context: Mapping[str, Any]
) -> list[Problem]:
    """What is wrong between those parts of a scene that are right in themselves.

    A file with an error in one table is never assembled into a scene; this still finds the
    errors between its other tables, so that all can be reported at once.

    Args:
        data: The file's content.
        context: The validation context.
    """
    film = _valid(_FILM, data.get("film", {}), context)
    objects = _valid_entries(_OBJECT, data.get("objects", []), context)
    emitters = _valid_entries(_EMITTER, data.get("emitters", []), context)
    sensors = _valid_entries(_SENSOR, data.get("sensors", []), context)
    if film is None or (data.get("emitters") and not emitters):
        return [
            *_repeated_names("objects", {i: one.name for i, one in objects.items()}),
            *_repeated_names("emitters", {i: one.name for i, one in emitters.items()}),
            *_repeated_names("sensors", {i: one.name for i, one in sensors.items()}),
        ]
    ambient = _valid(_AMBIENT, data.get("ambient", "reference"), context) or "reference"
    return cross_problems(
        film=film, ambient=ambient, objects=objects, emitters=emitters, sensors=sensors
    )


def _valid(kind: TypeAdapter[Any], value: object, context: Mapping[str, Any]) -> Any:
    try:
        return kind.validate_python(value, context=dict(context))
    except ValidationError:
        return None


def _valid_entries(
    kind: TypeAdapter[Any], values: object, context: Mapping[str, Any]
) -> dict[int, Any]:
    entries = values if isinstance(values, list) and len(values) <= MOST_OBJECTS else []
    checked = {index: _valid(kind, value, context) for index, value in enumerate(entries)}
    return {index: one for index, one in checked.items() if one is not None}
