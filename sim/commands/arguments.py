"""Arguments that several commands understand in the same way."""

from __future__ import annotations

import argparse
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenes import Scene

__all__ = [
    "add_scene_arguments",
    "count",
    "duration",
    "exr_file",
    "figure_file",
    "fraction",
    "length",
    "load_scene",
    "png_file",
]

_LONGEST_M = 1000.0


def count(text: str) -> int:
    """A whole number, which may be written ``500000``, ``500_000`` or ``5e5``."""
    try:
        return int(text)
    except ValueError:
        number = float(text)
    if not number.is_integer():
        raise ValueError
    return int(number)


count.__name__ = "whole number"  # What argparse calls it: "invalid whole number value: 'many'".


def fraction(text: str) -> float:
    """A part of one, which may be written ``0.01`` or ``1%``."""
    return float(text[:-1]) / 100.0 if text.endswith("%") else float(text)


fraction.__name__ = "fraction or percentage"


def duration(text: str) -> float:
    """Seconds, which may be written ``90``, ``90s``, ``1.5min`` or ``0.5h``."""
    for unit, seconds in (("min", 60.0), ("s", 1.0), ("h", 3600.0)):
        if text.endswith(unit):
            return float(text.removesuffix(unit)) * seconds
    return float(text)


def length(text: str) -> float:
    """A length in metres, above 0 and at most a kilometre: ``0.01``, ``10mm``, ``1cm``, ``2m``."""
    metres = None
    for unit, per_metre in (("mm", 1000.0), ("cm", 100.0), ("m", 1.0)):
        if text.endswith(unit):
            metres = float(text.removesuffix(unit)) / per_metre
            break
    metres = float(text) if metres is None else metres
    if not 0.0 < metres <= _LONGEST_M:
        raise argparse.ArgumentTypeError(f"{text!r} is not above 0 and at most {_LONGEST_M:g} m")
    return metres


def exr_file(path: str) -> Path:
    """An output file that must end in ``.exr``."""
    return _file_with_suffix(path, ".exr")


def png_file(path: str) -> Path:
    """An output file that must end in ``.png``."""
    return _file_with_suffix(path, ".png")


def figure_file(path: str) -> Path:
    """An output file that must end in ``.png`` or ``.svg``."""
    return _file_with_suffix(path, ".png", ".svg")


def _file_with_suffix(path: str, *suffixes: str) -> Path:
    file = Path(path)
    if file.suffix.lower() not in suffixes:
        raise argparse.ArgumentTypeError(f"{path!r} does not end in {' or '.join(suffixes)}")
    return file


def add_scene_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the scene that a command is about, and what it may read."""
    parser.add_argument("scene", help="name of a gallery scene, or path of a .toml file")
    parser.add_argument("--allow-outside", action="store_true",
                        help="let the scene file name files outside its own folder (meshes, "
                             "heights, masks)")


def load_scene(arguments: argparse.Namespace) -> Scene:
    """The scene; each value of it that looks like a slip is told on stderr, on a line of its own.

    Raises:
        SceneError: It cannot be used.
    """
    from scenes import SceneWarning, load

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", SceneWarning)
        scene = load(arguments.scene, allow_outside=arguments.allow_outside)
    for warning in caught:
        if issubclass(warning.category, SceneWarning):
            print(f"warning: {warning.message}", file=sys.stderr)
        else:
            warnings.warn_explicit(
                warning.message, warning.category, warning.filename, warning.lineno
            )
    return scene
