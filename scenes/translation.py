"""From pydantic's errors to `Problem`s, in words of our own and in the terms of TOML."""

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from scenes.errors import PROBLEM_ERROR_TYPE, Problem, nearest_names, shown
from scenes.places import Place, key_path

__all__ = ["problems_of"]

_EXPECTED = {
    "float_type": "a number",
    "int_type": "an integer",
    "string_type": "a string",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "finite_number": "a finite number",
}
_COMPARED = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
_MOST_ERRORS = 1000
"""Errors of one file that are told; a hostile one may have a million."""

_TABLE_INSTEAD = ("float_type", "string_type", "model_type", "model_attributes_type")
"""Errors of fields where a table with a `type` may stand, or may stand as well."""


def problems_of(error: ValidationError, model: type[BaseModel]) -> tuple[Problem, ...]:
    """Every problem in a pydantic error.

    Args:
        error: What validating `model` raised.
        model: The model at the root of the error's locations.

    Returns:
        The problems in pydantic's order, which is that of the fields; none twice. Of more than
        a thousand errors the rest is counted only.
    """
    found: dict[Problem, None] = {}
    told = error.errors(include_url=False)[:_MOST_ERRORS]
    wrong_inside = {details["loc"][:-1] for details in told}
    for details in told:
        if details["type"] == "too_short" and details["loc"] in wrong_inside:
            continue  # an array is left at its first wrong element, and only seems too short
        place = Place.at(details["loc"], model)
        found.update(dict.fromkeys(_problems(details, place)))
    more = error.error_count() - _MOST_ERRORS
    return (*found, Problem("", f"and {more} more errors")) if more > 0 else tuple(found)


def _problems(details: ErrorDetails, place: Place) -> tuple[Problem, ...]:
    kind, value, context = details["type"], details["input"], details.get("ctx", {})
    if kind == PROBLEM_ERROR_TYPE:
        return tuple(problem.below(place.path) for problem in context["problems"])
    if kind == "missing":
        return (_missing(place, value),)
    if kind == "extra_forbidden":
        return (_unknown_key(place, value),)
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return (_unknown_type(place, value),)
    allowed = _allowed(kind, context, place) or details["msg"].removeprefix("Input should be ")
    message = f"must be {allowed}, is {shown(value)}{_guess(kind, context, value)}"
    return (Problem(place.path, message, value, allowed),)


def _guess(kind: str, context: Mapping[str, Any], value: Any) -> str:
    """What a number may have been meant to be: a percentage, where only a fraction can stand."""
    if kind == "less_than_equal" and context["le"] == 1 and 2.0 <= value <= 100.0:
        return f"; did you mean {value / 100.0:g} (it looks like a percentage)?"
    return ""


def _allowed(kind: str, context: Mapping[str, Any], place: Place) -> str:
    """What a field accepts, by the error it gave; "" for errors that no field of ours gives."""
    if kind in _COMPARED:
        words, key = _COMPARED[kind]
        return f"{words} {context[key]:g}"
    if kind == "literal_error":
        return str(context["expected"])
    if kind in ("too_long", "too_short", "tuple_type"):
        return _array(context, place)
    if kind == "string_too_long":
        return f"a text of at most {context['max_length']} characters"
    expected = _EXPECTED.get(kind, "")
    if kind in _TABLE_INSTEAD and place.tables:
        table = f'a table with a key "type", one of: {", ".join(place.types)}'
        table = table if place.types else f"a table with the keys {', '.join(place.keys)}"
        return table if expected == "a table" else f"{expected}, or {table}"
    return expected


def _array(context: Mapping[str, Any], place: Place) -> str:
    if place.length is not None:
        return f"an array of {place.length} numbers"
    if "max_length" in context:
        return f"an array of at most {context['max_length']} elements"
    if "min_length" in context:
        return f"an array of at least {context['min_length']} elements"
    return "an array"


def _missing(place: Place, value: object) -> Problem:
    if isinstance(place.key, int) and place.parent is not None:  # a vector that is too short
        allowed = f"an array of {place.parent.length} numbers"
        message = f"must be {allowed}, is {shown(value)}"
        return Problem(place.parent.path, message, value, allowed)
    return Problem(place.path, f"missing; required: {place.description}", None, place.description)


def _unknown_key(place: Place, value: object) -> Problem:
    known = place.parent.keys if place.parent else []
    return _unknown("key", str(place.key), known, Problem(place.path, "", value))


def _unknown_type(place: Place, value: object) -> Problem:
    path = key_path(place.path, "type")
    given = value.get("type") if isinstance(value, Mapping) else None
    if given is None:
        allowed = ", ".join(place.types)
        return Problem(path, f"missing; required, one of: {allowed}", None, allowed)
    return _unknown("type", given, place.types, Problem(path, "", given))


def _unknown(kind: str, name: object, known: list[str], blank: Problem) -> Problem:
    near = nearest_names(name, known, count=1) if isinstance(name, str) else []
    guess = f"did you mean {near[0]!r}? " if near else ""
    allowed = ", ".join(known)
    message = f"unknown {kind} {shown(name)}; {guess}allowed: {allowed}"
    return Problem(blank.path, message, blank.value, allowed)
