"""Scene files: TOML read into scenes, the gallery, and the JSON Schema that editors use."""

import os
import re
import tomllib
import warnings
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from scenes.budget import BUDGET_KEY, Budget
from scenes.checks import cross_problems_of_valid_parts
from scenes.doubts import SceneWarning, doubts_about
from scenes.errors import Problem, SceneError, nearest_names, shown
from scenes.fields import UNITS_PER_METRE, unit_context
from scenes.file_content import file_content
from scenes.scene import Scene
from scenes.translation import problems_of

__all__ = ["gallery", "gallery_path", "load", "loads", "schema"]

_GALLERY: Final = Path(__file__).parent / "gallery"
_SUFFIX: Final = ".toml"
_MAX_BYTES: Final = 4 * 1024 * 1024
_PART: Final = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')[ \t]*+"""
_DEEP_KEY: Final = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:\.[ \t]*+{_PART}){{32}}")
"""Dotted keys of so many parts take `tomllib` a time that grows as the square of their length."""

_MOST: Final = f"at most {_MAX_BYTES // 1024**2} MB"
_JSON_SCHEMA_DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"


def gallery() -> tuple[str, ...]:
    """Names of the scenes that come with the program, sorted."""
    return tuple(sorted(path.stem for path in _GALLERY.glob(f"*{_SUFFIX}")))


def gallery_path(name: str) -> Path:
    """The file of a gallery scene.

    Raises:
        SceneError: if there is no scene of that name.
    """
    if name not in gallery():
        raise _unknown_scene(name)
    return _GALLERY / f"{name}{_SUFFIX}"


def load(name_or_path: str | os.PathLike[str], *, allow_outside: bool = False) -> Scene:
    """Read a scene.

    Args:
        name_or_path: A name from the gallery, or else the path of a TOML file.
        allow_outside: Whether it may name files outside its own folder.

    Warns:
        SceneWarning: of every value that is allowed, but looks like a slip.

    Raises:
        SceneError: if there is no such scene, it cannot be read, or anything in it is wrong;
            every problem of the file at once.
    """
    name = os.fspath(name_or_path)
    if name in gallery():
        return _scene(_text(gallery_path(name)), shown_as=name, name=name, folder=_GALLERY)
    path = Path(name)
    is_a_word = isinstance(name_or_path, str) and path.name == name and not path.suffix
    try:
        text = _text(path)
    except FileNotFoundError:
        if is_a_word:
            raise _unknown_scene(name) from None
        raise SceneError(name, [_unreadable("there is no such file")]) from None
    return _scene(
        text, shown_as=name, name=path.stem, folder=path.parent, allow_outside=allow_outside
    )


def loads(
    text: str,
    *,
    name: str = "<string>",
    folder: str | os.PathLike[str] | None = None,
    allow_outside: bool = False,
) -> Scene:
    """Read a scene from the text of a scene file.

    Args:
        text: TOML.
        name: What to call it in errors.
        folder: Where the files are that it names; the current folder if not given.
        allow_outside: Whether it may name files outside that folder.

    Warns:
        SceneWarning: of every value that is allowed, but looks like a slip.

    Raises:
        SceneError: if anything in it is wrong; every problem at once.
    """
    where = Path() if folder is None else Path(folder)
    return _scene(text, shown_as=name, name=name, folder=where, allow_outside=allow_outside)


def schema() -> dict[str, Any]:
    """The JSON Schema of scene files, for editors that complete and check TOML."""
    return {"$schema": _JSON_SCHEMA_DIALECT, **Scene.model_json_schema()}


def _scene(
    text: str, *, shown_as: str, name: str, folder: Path, allow_outside: bool = False
) -> Scene:
    data = _tables(text, shown_as)
    unit = data.get("length_unit", "m")
    known = isinstance(unit, str) and unit in UNITS_PER_METRE
    context = unit_context(unit if known else "m", folder, allow_outside=allow_outside)
    try:
        scene = Scene.model_validate(data, context={**context, BUDGET_KEY: Budget()})
    except ValidationError as error:
        beside = cross_problems_of_valid_parts(data, {**context, BUDGET_KEY: Budget()})
        found = (*problems_of(error, Scene), *beside)
        raise SceneError(shown_as, dict.fromkeys(found)) from None
    scene._source_name, scene._source_text = name, text
    for doubt in doubts_about(scene, data):
        warnings.warn(SceneWarning(shown_as, doubt), stacklevel=3)
    return scene


def _tables(text: str, shown_as: str) -> dict[str, Any]:
    """What TOML text holds.

    Raises:
        SceneError: if it is no TOML, or more of it than a scene can be.
    """
    if len(text) > _MAX_BYTES:
        raise SceneError(shown_as, [_unreadable(f"it is too large; allowed: {_MOST}")])
    if _DEEP_KEY.search(text):
        reason = "a key is nested too deeply; allowed: at most 32 parts"
        raise SceneError(shown_as, [Problem("", reason)])
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SceneError(shown_as, [Problem("", "not TOML: nested too deeply")]) from None
    except ValueError as error:  # a TOMLDecodeError, or an integer of too many digits
        raise SceneError(shown_as, [Problem("", f"not TOML: {error}")]) from None


def _text(path: Path) -> str:
    """The text of a file.

    Raises:
        FileNotFoundError: if there is none.
        SceneError: if it cannot be read as text.
    """
    try:
        content = file_content(path, _MAX_BYTES)
    except FileNotFoundError:
        raise
    except (OSError, ValueError) as error:  # ValueError: no path can look like this
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError(str(path), [_unreadable(reason)]) from None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        reason = f"it is not UTF-8 text: byte {content[error.start]:#04x} at {error.start}"
        raise SceneError(str(path), [_unreadable(reason)]) from None


def _unreadable(reason: str) -> Problem:
    return Problem("", f"cannot be read: {reason}")


def _unknown_scene(name: str) -> SceneError:
    names = gallery()
    near = nearest_names(name, names)
    guess = f"nearest: {', '.join(near)}; " if near else ""
    allowed = f"a name from the gallery ({', '.join(names)}), or the path of a {_SUFFIX} file"
    message = f"unknown scene {shown(name)}; {guess}allowed: {allowed}"
    return SceneError(name, [Problem("", message, name, allowed)])
