"""The kinds of numbers a scene is made of: lengths, sizes, directions, angles, wavelengths.

Scene files may give lengths in millimetres. Models hold metres always: `scenes.files` passes the
file's unit in the validation context, and the types of this module convert while they validate,
so that a field's type alone says whether it is scaled. Models built in Python are in metres.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import AfterValidator, AllowInfNan, Field, Strict, ValidationInfo

from scenes.errors import Problem, refusal

__all__ = [
    "LIGHT_RANGE",
    "MAX_INVERSE_LENGTH_PER_M",
    "MAX_LENGTH_M",
    "MIN_SIZE_M",
    "UNITS_PER_METRE",
    "WAVELENGTH_RANGE_NM",
    "Coordinate",
    "Count",
    "Curvature",
    "Degrees",
    "Direction",
    "Extent",
    "InverseLength",
    "Light",
    "NonNegative",
    "Number",
    "Position",
    "Positive",
    "Rotation",
    "SignedRadius",
    "Size",
    "Wavelength",
    "folder_of",
    "is_file",
    "length_text",
    "may_look_outside",
    "unit_context",
]

UNITS_PER_METRE: Final = {"m": 1.0, "mm": 1000.0}
"""Length units a file may use; a division by these is exact to the last digit, a product is not."""

MAX_LENGTH_M: Final = 1e9
"""No coordinate or size may exceed this: squares and cubes of lengths must stay finite."""

MAX_INVERSE_LENGTH_PER_M: Final = 1e30
"""No absorption coefficient may exceed this: nothing passes an atom's layer of it."""

LIGHT_RANGE: Final = (1e-30, 1e30)
"""Of fluxes, irradiances and radiances [W, …]: their squares and shares must be numbers too."""

MIN_SIZE_M: Final = 1e-9
"""No size may be smaller: geometrical optics ended long before a nanometre."""

WAVELENGTH_RANGE_NM: Final = (10.0, 1e6)
"""From the extreme ultraviolet to the far infrared: no optical medium is described beyond."""

_CONTEXT_KEY = "length_unit"
_FOLDER_KEY = "folder"
_OUTSIDE_KEY = "allow_outside"


def unit_context(
    length_unit: str, folder: Path | None = None, *, allow_outside: bool = False
) -> dict[str, Any]:
    """The validation context of a file.

    Args:
        length_unit: of its lengths, "m" or "mm".
        folder: where the files that it names are; None: the current folder.
        allow_outside: whether it may name files outside that folder.
    """
    where = {_FOLDER_KEY: folder or Path(), _OUTSIDE_KEY: allow_outside}
    return {_CONTEXT_KEY: length_unit, **where}


def is_file(info: ValidationInfo) -> bool:
    """Whether a file is being read, rather than a model built in Python."""
    return isinstance(info.context, Mapping) and _CONTEXT_KEY in info.context


def folder_of(info: ValidationInfo) -> Path | None:
    """The folder of the file that is being read; None for a model built in Python."""
    return Path(info.context[_FOLDER_KEY]) if info.context and is_file(info) else None


def may_look_outside(info: ValidationInfo) -> bool:
    """Whether the file that is being read may name files outside its folder."""
    return bool(info.context and info.context.get(_OUTSIDE_KEY))


def _unit(info: ValidationInfo) -> str:
    return str(info.context[_CONTEXT_KEY]) if info.context and is_file(info) else "m"


def length_text(length_m: float, info: ValidationInfo) -> str:
    """A length for a message, in the unit of the file that is being read."""
    unit = _unit(info)
    return f"{length_m * UNITS_PER_METRE[unit]:.6g} {unit}"


def _coordinate_m(length: float, info: ValidationInfo) -> float:
    length_m = length / UNITS_PER_METRE[_unit(info)]
    if abs(length_m) > MAX_LENGTH_M:
        allowed = f"at most {length_text(MAX_LENGTH_M, info)} from the origin"
        raise refusal(Problem("", f"must be {allowed}, is {length:.6g}", length, allowed))
    return length_m


def _size_m(length: float, info: ValidationInfo) -> float:
    length_m = length / UNITS_PER_METRE[_unit(info)]
    if not MIN_SIZE_M <= abs(length_m) <= MAX_LENGTH_M:
        lowest, highest = length_text(MIN_SIZE_M, info), length_text(MAX_LENGTH_M, info)
        allowed = f"between {lowest} and {highest}"
        raise refusal(Problem("", f"must be {allowed}, is {length:.6g}", length, allowed))
    return length_m


def _extent_m(length: float, info: ValidationInfo) -> float:
    return length if length == 0.0 else _size_m(length, info)


def _signed_radius_m(radius: float, info: ValidationInfo) -> float:
    if radius == 0.0:
        allowed = "any length but 0; a flat surface is written curvature = 0"
        raise refusal(Problem("", f"must not be 0; allowed: {allowed}", radius, allowed))
    return _size_m(radius, info)


def _curvature_per_m(curvature: float, info: ValidationInfo) -> float:
    curvature_per_m = curvature * UNITS_PER_METRE[_unit(info)]
    if abs(curvature_per_m) > 1.0 / MIN_SIZE_M:
        allowed = f"a radius of at least {length_text(MIN_SIZE_M, info)}"
        raise refusal(Problem("", f"must mean {allowed}, is {curvature:.6g}", curvature, allowed))
    return curvature_per_m


def _per_metre(per_length: float, info: ValidationInfo) -> float:
    per_metre = per_length * UNITS_PER_METRE[_unit(info)]
    if per_metre > MAX_INVERSE_LENGTH_PER_M:
        highest = MAX_INVERSE_LENGTH_PER_M / UNITS_PER_METRE[_unit(info)]
        allowed = f"at most {highest:g} per {_unit(info)}"
        raise refusal(Problem("", f"must be {allowed}, is {per_length:g}", per_length, allowed))
    return per_metre


def _normalised(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    largest = max(abs(component) for component in direction)
    if largest == 0.0:
        allowed = "a vector that is not zero; its length does not matter"
        raise refusal(Problem("", "must not be the zero vector", direction, allowed))
    x, y, z = (component / largest for component in direction)  # squares cannot overflow now
    norm = math.hypot(x, y, z)
    if abs(largest * norm - 1.0) <= 4.0 * math.ulp(1.0):
        return direction  # already a unit vector: written to a file and read, it stays the same
    return (x / norm, y / norm, z / norm)


_LOOKS_LIKE = (("micrometres", 1e-3, 0.1, 10.0), ("metres", 1e-9, 1e-7, 1e-5))
"""Units that wavelengths are given in by mistake: their size per nm, and what values then are."""


def _plausible_wavelength_nm(wavelength_nm: float) -> float:
    lowest, highest = WAVELENGTH_RANGE_NM
    if lowest <= wavelength_nm <= highest:
        return wavelength_nm
    allowed = f"{lowest:g} to {highest:g} nm"
    looks = ""
    for unit, per_nm, shortest, longest in _LOOKS_LIKE:
        if shortest <= wavelength_nm < longest:
            meant = f"{wavelength_nm / per_nm:g} nm"
            looks = f" ({wavelength_nm:g} looks like {unit}; did you mean {meant}?)"
    message = f"must be {allowed}, is {wavelength_nm:g}{looks}"
    raise refusal(Problem("", message, wavelength_nm, allowed))


Number = Annotated[float, Strict(), AllowInfNan(False)]
"""A finite number; a text or a truth value is not one."""

Positive = Annotated[Number, Field(gt=0)]
NonNegative = Annotated[Number, Field(ge=0)]
Light = Annotated[Number, Field(ge=LIGHT_RANGE[0], le=LIGHT_RANGE[1])]
"""A flux, an irradiance or a radiance."""

Count = Annotated[int, Strict(), Field(gt=0)]
Degrees = Number

Coordinate = Annotated[Number, AfterValidator(_coordinate_m)]
"""A signed length [m]."""

Size = Annotated[Number, Field(gt=0), AfterValidator(_size_m)]
"""A length that must exist [m]."""

Extent = Annotated[Number, Field(ge=0), AfterValidator(_extent_m)]
"""A length that may be 0 [m]."""

SignedRadius = Annotated[Number, AfterValidator(_signed_radius_m)]
"""A radius of curvature [m], positive or negative."""

Curvature = Annotated[Number, AfterValidator(_curvature_per_m)]
"""The inverse of a signed radius [1/m]; in a file in mm it is written in 1/mm."""

InverseLength = Annotated[Number, Field(ge=0), AfterValidator(_per_metre)]
"""A coefficient per length, 0 or more [1/m]; in a file in mm it is written in 1/mm."""

Position = tuple[Coordinate, Coordinate, Coordinate]
"""A point [m]."""

Direction = Annotated[tuple[Number, Number, Number], AfterValidator(_normalised)]
"""A unit vector; files may give it any length."""

Rotation = tuple[Degrees, Degrees, Degrees]
"""Turns about the fixed x, then y, then z axes [degrees]."""

Wavelength = Annotated[Number, AfterValidator(_plausible_wavelength_nm)]
"""A wavelength [nm]."""
