"""What a run's picture depends on, and in what two runs differ.

All of the scene but its words, the files that it names by their content, the settings but those
that say when to stop, and the program. How many passes there shall be matters only in so far as
it decides in how many turns bands are sampled behind glass.
"""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel

import scenes
from sim.image.film import turns_of
from sim.version import VERSION

if TYPE_CHECKING:
    from sim.settings import ResolvedSettings

__all__ = ["Difference", "fingerprint_of", "list_differences"]

_WORDS = ("title", "description", "length_unit", "render")
"""Of a scene: no light depends on them; its [render] table is in the settings."""

_ENDS = ("preset", "passes", "target_error", "time_budget")
"""Settings that say when to stop."""

_LONGEST_LIST = 32
"""Longer lists are known by their digest, so that a grid of heights does not fill the file."""

_PACKAGES = ("spectra", "scenes", "sim")

ABSENT = "nothing"

Difference = tuple[str, str, str]
"""Path of a field, what the checkpoint has there, and what is asked for."""


def fingerprint_of(
    scene: scenes.Scene, settings: ResolvedSettings, *, pictured: bool
) -> dict[str, Any]:
    """All that decides a run's result, ready for JSON.

    Args:
        scene: what is rendered.
        settings: how.
        pictured: whether a picture is taken; else sensors alone measure.
    """
    decisive = {key: one for key, one in settings.reproducing().items() if key not in _ENDS}
    if pictured:
        two = turns_of(settings.passes) == 2
        decisive["passes"] = "even, and 4 or more" if two else "odd, or fewer than 4"
    found = {
        "program": {"version": VERSION, "source": _source_digest(), "warp": version("warp-lang")},
        "result": "a picture" if pictured else "a measurement",
        "settings": decisive,
        "scene": {key: one for key, one in _plain(scene).items() if key not in _WORDS},
    }
    # As it comes back from a file: tuples are lists there.
    restored: dict[str, Any] = json.loads(json.dumps(found))
    return restored


def list_differences(stored: Any, asked: Any) -> list[Difference]:
    """Where two fingerprints differ, in the order of their fields."""
    return list(_differences("", stored, asked))


def _differences(path: str, stored: Any, asked: Any) -> Iterator[Difference]:
    if isinstance(stored, dict) and isinstance(asked, dict):
        for key in dict.fromkeys((*asked, *stored)):
            inner = f"{path}.{key}" if path else str(key)
            yield from _differences(inner, stored.get(key, ABSENT), asked.get(key, ABSENT))
    elif isinstance(stored, list) and isinstance(asked, list) and len(stored) == len(asked):
        for index, pair in enumerate(zip(stored, asked, strict=True)):
            yield from _differences(f"{path}.{index}", *pair)
    elif stored != asked:
        yield path, _shown(stored), _shown(asked)


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return f"{len(value)} of them"
    if isinstance(value, dict):
        return str(value.get("type") or value.get("name") or "a table")
    text = str(value)
    return text if len(text) <= 80 else f"{text[:77]}…"


def _plain(value: Any) -> Any:
    """A scene's model as plain data; files by their content."""
    if isinstance(value, BaseModel):
        fields = {name: _plain(getattr(value, name)) for name in type(value).model_fields}
        content = _file_content(value)
        return fields if content is None else {**fields, "file": f"content {_digest(*content)}"}
    if isinstance(value, dict):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        plain = [_plain(one) for one in value]
        if len(plain) <= _LONGEST_LIST:
            return plain
        text = json.dumps(plain).encode()
        return f"{len(plain)} values, digest {hashlib.sha256(text).hexdigest()[:16]}"
    if isinstance(value, np.generic | np.ndarray):
        return _plain(value.tolist())
    return value


def _file_content(model: BaseModel) -> tuple[NDArray[Any], ...] | None:
    """What a model has read from the file that it names; None if it names none."""
    if getattr(model, "file", None) is None:
        return None
    if isinstance(model, scenes.Mesh):
        surface = model.local_surface()
        normals = () if surface.corner_normals is None else (surface.corner_normals,)
        return (surface.vertices, surface.triangles, *normals)
    if isinstance(model, scenes.HeightField):
        return (model.grid().heights,)
    assert isinstance(model, scenes.Mask), type(model)  # there is nothing else that reads files
    return (model.cells(),)


def _digest(*arrays: NDArray[Any]) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype.str} {array.shape}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:16]


@functools.cache
def _source_digest() -> str:
    """Of the program's own text: between two versions, too, it changes what is computed."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[2]
    for package in _PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            digest.update(f"{path.relative_to(root).as_posix()}\n".encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
