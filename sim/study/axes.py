"""The axes of a study: what can be varied, each declared in one place.

A feature that can be had for less time or more accuracy registers its axis beside its code:

    register_axis(Axis(
        name="absorption", changes="scene", results=RESULTS,
        summary="whether glass absorbs", vary=lambda centre, quick: {"none": ...},
    ))

`vary` gets the study's centre and returns the other setups, each under its value's name; the
centre itself need not be among them. `sim.study.standard_axes` holds those of the engine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from sim.errors import SettingsError
from sim.study.setup import ResultKind, Setup

__all__ = ["Axis", "Vary", "axes", "register_axis"]

Vary: TypeAlias = Callable[[Setup, bool], Mapping[str, Setup]]
"""(centre, whether the study is a quick one) → setups by the name of their value."""


@dataclass(frozen=True)
class Axis:
    """One thing that can be varied.

    Attributes:
        name: of the axis, unique.
        changes: which part of a setup its values change.
        results: which results its values can change; the others are not measured for it.
        summary: what is varied, in plain words, as a noun.
        default: name of the centre's value.
        vary: makes the setups.
    """

    name: str
    changes: Literal["settings", "method", "scene", "estimator"]
    results: tuple[ResultKind, ...]
    summary: str
    default: str
    vary: Vary


_REGISTRY: dict[str, Axis] = {}


def register_axis(axis: Axis) -> Axis:
    """Add an axis to every study from now on.

    Raises:
        SettingsError: there is one of that name already.
    """
    if axis.name in _REGISTRY:
        raise SettingsError("axis", axis.name, f"a name not yet taken: {', '.join(_REGISTRY)}")
    _REGISTRY[axis.name] = axis
    return axis


def axes() -> tuple[Axis, ...]:
    """All axes, in the order of their registration."""
    return tuple(_REGISTRY.values())
