"""Values that a scene may have, but hardly means: each with a guess at what was meant.

A wrong unit rarely ends in an impossible value. What is looked for are slips that leave a mark of
their own: metres for millimetres, radians for degrees, ångströms for nanometres, 125 for 1/125 s.
Only files are asked, in their own terms; who states a `length_unit` is believed where sizes are
merely unusual.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, Final

import numpy as np

from scenes.emitters import RectangleLamp, SphereLamp
from scenes.errors import Problem
from scenes.fields import UNITS_PER_METRE
from scenes.materials import Dielectric
from scenes.media import SellmeierMedium, resolve_medium
from scenes.places import key_path
from scenes.scene import Scene
from scenes.shapes import FlatRectangle, Plane
from spectra import SpectraError

__all__ = ["SceneWarning", "doubts_about"]

_LARGEST_M: Final = 10.0
_SMALLEST_M: Final = 1e-4
_LEAST_ABBE_NUMBER: Final = 9.0
"""Rutile has 10, and nothing transparent disperses more."""

_NAME_OF = {"m": "metres", "mm": "millimetres"}
_OTHER = {"m": "mm", "mm": "m"}


class SceneWarning(UserWarning):
    """A value of a scene file that is allowed, but looks like a slip.

    Attributes:
        source: What was read: a file's path, or a gallery name.
        doubt: The field's path, the value, and what may have been meant.
    """

    def __init__(self, source: str, doubt: Problem) -> None:
        super().__init__(source, doubt)
        self.source, self.doubt = source, doubt

    def __str__(self) -> str:
        """The field's path, the value, and the guess."""
        return str(self.doubt)


@dataclass(frozen=True)
class _Entry:
    """A number in a file: where it is, and in what."""

    path: str
    key: str
    value: float
    table: Mapping[str, Any]


def doubts_about(scene: Scene, data: Mapping[str, Any]) -> list[Problem]:
    """What looks like a slip.

    Args:
        scene: The scene, which is right.
        data: The content of the file that it was read from.

    Returns:
        A problem for each doubt; `allowed` is the guess.
    """
    entries = list(_numbers(data, "", ""))
    kinds = (
        _sizes(scene, data),
        _thousandths(entries),
        _radians(entries),
        _angstroms(entries),
        _exposures(entries),
        _indices(scene),
        _remoteness(scene),
    )
    return [doubt for kind in kinds for doubt in _first_few(list(kind))]


def _first_few(doubts: list[Problem]) -> list[Problem]:
    """Those of one kind that are told, the last with how many more there are."""
    told = doubts[:_MOST_TOLD]
    if len(doubts) > _MOST_TOLD:
        more = f" (and {len(doubts) - _MOST_TOLD} more such)"
        told[-1] = replace(told[-1], message=told[-1].message + more)
    return told


_MOST_TOLD = 3


def _doubt(path: str, value: object, guess: str, why: str = "") -> Problem:
    shown = f"{value:g}" if isinstance(value, float) else value
    reason = f" ({why})" if why else ""
    return Problem(path, f"value {shown}{reason}; did you mean {guess}?", value, guess)


def _numbers(node: Any, path: str, key: str) -> Iterator[_Entry]:
    """Every number that is a table's own, or in a short array of a table's."""
    for name, value in node.items():
        place = key_path(path, name)
        if isinstance(value, Mapping):
            yield from _numbers(value, place, name)
            continue
        several = isinstance(value, list) and len(value) <= _MOST_LISTED
        for index, one in enumerate(value if several else [value]):
            where = key_path(place, index) if several else place
            if isinstance(one, Mapping):
                yield from _numbers(one, where, name)
            elif isinstance(one, int | float) and not isinstance(one, bool):
                yield _Entry(where, name, float(one), node)


_MOST_LISTED = 10_000


def _sizes(scene: Scene, data: Mapping[str, Any]) -> Iterator[Problem]:
    """Things much larger, or smaller, than what stands on a bench."""
    unit = data.get("length_unit", "m")
    scale = UNITS_PER_METRE[unit]
    stated = "length_unit" in data
    other = _OTHER[unit]
    guess = f'{_NAME_OF[other]}, length_unit = "{other}"'
    sizes_m = {
        index: _longest_side(one.shape)
        for index, one in enumerate(scene.objects)
        if not isinstance(one.shape, Plane)
    }
    # Millimetres are stated, so that one tiny thing is believed; not if there is nothing else.
    all_small = unit == "mm" and max(sizes_m.values(), default=0.0) < _SMALLEST_M
    for index, size_m in sizes_m.items():
        # In a file in metres that is too small for a bench, millimetres would be smaller still.
        if (size_m > _LARGEST_M and not stated) or all_small:
            across = f"{size_m * scale:.3g} {unit} across"
            yield _doubt(f"objects[{index}].shape", across, guess)
        elif size_m < _SMALLEST_M and not stated:
            wanted = f"{size_m * 1000.0:.3g} m"
            why = 'if it is meant, state length_unit = "m"'
            yield _doubt(f"objects[{index}].shape", f"{size_m:.3g} m across", wanted, why)
    for index, lamp in enumerate(scene.emitters):
        if not isinstance(lamp, SphereLamp | RectangleLamp) or stated:
            continue
        size_m = _longest_side(lamp) if isinstance(lamp, RectangleLamp) else 2.0 * lamp.radius
        if size_m > _LARGEST_M:
            yield _doubt(f"emitters[{index}]", f"{size_m:.3g} m across", guess)
    camera = scene.camera
    if camera is not None and camera.sensor_height > 1.0:
        height = camera.sensor_height
        yield _doubt("camera.sensor_height", height * scale, f"{height * scale / 1000.0:g} {unit}",
                     f"the camera's sensor is {height:g} m high")  # fmt: skip


def _longest_side(shape: Any) -> float:
    """Of a rectangle its longer side, of all else the diameter of the sphere around it [m]."""
    if isinstance(shape, FlatRectangle):
        return max(shape.size)
    return 2.0 * float(shape.bounding_sphere()[1])


_LENGTHS = ("radius", "size", "base", "length", "aperture", "thickness", "depth")


def _thousandths(entries: list[_Entry]) -> Iterator[Problem]:
    """Lengths of the same kind in two objects, one of them a thousand times the other."""
    alike: dict[tuple[str, object], dict[float, _Entry]] = {}
    for one in entries:
        if one.key in _LENGTHS and one.path.startswith("objects[") and one.value > 0.0:
            group = alike.setdefault((one.key, one.table.get("type")), {})
            group.setdefault(one.value, one)
    for group in alike.values():
        if len(group) > _MOST_COMPARED:
            continue
        for a, b in combinations(group.values(), 2):
            if a.path.partition(".")[0] == b.path.partition(".")[0]:
                continue  # two sides of a thin pane
            if math.isclose(max(a.value, b.value), 1000.0 * min(a.value, b.value), rel_tol=1e-9):
                why = f"{a.path} is {a.value:g}, exactly 1000 times more or less"
                yield _doubt(b.path, b.value, f"{a.value:g}", why)


_MOST_COMPARED = 100


def _radians(entries: list[_Entry]) -> Iterator[Problem]:
    """Degrees that are a multiple of 5° in radians, to all of the digits that are given."""
    for one in entries:
        if not one.key.endswith("_deg") or not 0.0 < abs(one.value) <= 2.0 * math.pi + 0.01:
            continue
        digits = len(repr(one.value).partition(".")[2])
        significant = len(repr(abs(one.value)).replace(".", "").lstrip("0"))
        meant_deg = 5.0 * round(math.degrees(one.value) / 5.0)
        slack = 0.5001 * 10.0**-digits + 4.0 * math.ulp(one.value)
        is_round = meant_deg and abs(one.value - math.radians(meant_deg)) <= slack
        if significant >= _SIGNIFICANT and is_round and _is_allowed(one, meant_deg):
            why = f"{one.value:.6g} radians are {meant_deg:g} degrees"
            yield _doubt(one.path, one.value, f"{meant_deg:g}", why)
        elif one.key == "fov_deg" and one.value < 0.5 * math.pi:
            yield _doubt(one.path, one.value, f"{math.degrees(one.value):.3g}",
                         "a very narrow field of view, in degrees")  # fmt: skip


_SIGNIFICANT = 4
"""Digits of an angle that say more than chance: of three, one value in a hundred is near 5°."""

_MOST_DEG = {
    "fov_deg": 179.0, "apex_deg": 179.0, "divergence_deg": 89.0, "ellipticity_deg": 45.0,
}  # fmt: skip
"""How large angles may be, in multiples of 5° and a bit; others may be any."""


def _is_allowed(one: _Entry, angle_deg: float) -> bool:
    """Whether the field could be this angle."""
    most = _MOST_DEG.get(one.key, math.inf)
    if one.key == "half_angle_deg":
        most = 180.0 if one.table.get("type") == "spot" else 89.0
    return abs(angle_deg) <= most


def _angstroms(entries: list[_Entry]) -> Iterator[Problem]:
    """Wavelengths of lamps and films that would be visible light in ångströms."""
    told = set()
    for one in entries:
        is_light = one.key in ("wavelength_nm", "first_nm", "last_nm")
        place = one.path.partition(".")[0]
        if is_light and place.startswith(("film", "emitters")) and 3800.0 <= one.value <= 7800.0:
            table = one.path.rpartition(".")[0]
            if table not in told:
                told.add(table)
                why = "infrared, in nanometres"
                yield _doubt(one.path, one.value, f"{one.value / 10.0:g}, from ångströms", why)


def _exposures(entries: list[_Entry]) -> Iterator[Problem]:
    """Shutters as photographers write them: 125 for 1/125 s."""
    for one in entries:
        if one.key == "shutter_s" and one.value >= 100.0 and one.value.is_integer():
            yield _doubt(one.path, one.value, f"{1.0 / one.value:.3g}",
                         f"1/{one.value:g} s is written as a decimal")  # fmt: skip


def _indices(scene: Scene) -> Iterator[Problem]:
    """Media that bend light the wrong way, or disperse it more than any matter."""
    described = {
        f"objects[{index}].material.medium": one.material.medium
        for index, one in enumerate(scene.objects)
        if isinstance(one.material, Dielectric) and not isinstance(one.material.medium, str)
    }
    if not isinstance(scene.ambient, str):
        described["ambient"] = scene.ambient
    for path, spec in described.items():
        medium = resolve_medium(spec)
        low, high = medium.wavelength_range_nm
        middle = min(max(587.5618, low), high)
        eta = float(medium.eta(middle))
        if eta < 0.95:
            key = f"{path}.eta" if spec.type == "constant" else path
            yield _doubt(key, eta, f"{1.0 / eta:.4g}", "less than that of air: from glass to air")
        try:
            abbe_number = medium.abbe_number
        except SpectraError:
            continue
        if 0.0 < abbe_number < _LEAST_ABBE_NUMBER:
            why = f"Abbe number {abbe_number:.2g}, and no transparent matter is below 9"
            if isinstance(spec, SellmeierMedium):
                squares = [float(f"{c * c:.6g}") for c in spec.c_um2]
                guess = f"{squares}, C squared"
                yield _doubt(f"{path}.c_um2", list(spec.c_um2), guess, why)
            else:
                yield _doubt(path, "as given", "coefficients in another unit than µm", why)


def _remoteness(scene: Scene) -> Iterator[Problem]:
    """A camera so far away that all there is fills less than a hundredth of the picture."""
    camera = scene.camera
    shapes = [one.shape for one in scene.objects]
    if camera is None or not shapes or any(isinstance(shape, Plane) for shape in shapes):
        return
    bounds = [shape.bounding_sphere() for shape in shapes if not isinstance(shape, Plane)]
    centres = np.array([centre for centre, _ in bounds])
    centre = 0.5 * (centres.min(axis=0) + centres.max(axis=0))
    reach = max(float(np.linalg.norm(one - centre)) + radius for one, radius in bounds)
    distance = float(np.linalg.norm(np.subtract(camera.position, centre)))
    seen = 2.0 * math.degrees(math.atan2(reach, distance))
    if seen < 0.01 * camera.fov_deg:
        why = f"all there is, {2.0 * reach:.3g} m across, fills less than 1 % of the picture"
        where = "one in the unit of the other lengths"
        yield _doubt("camera.position", f"{distance:.3g} m away", where, why)
