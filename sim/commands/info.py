"""Tell what a spectral EXR holds: size, bands, how it was made, where the energy went."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from sim.commands.energy import band_lines

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sim.image.exr_reading import SpectralImage

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "what a spectral EXR holds"

_DEEPEST = 8
"""Tables in tables of an attribute; Nephroid writes no more than two."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("file", metavar="FILE.exr")
    parser.add_argument("--scene", action="store_true",
                        help="print only the scene it was rendered from, as TOML")


def run(arguments: argparse.Namespace) -> None:
    """Print what is in the file, or only its scene."""
    from sim.errors import FileFormatError
    from sim.image.exr_reading import read_exr

    image = read_exr(arguments.file)
    if not arguments.scene:
        _print_pixels(image)
        _print_origin(image)
        return
    scene = image.attribute("scene")
    if scene is None:
        raise FileFormatError(image.path, "it does not say which scene it was rendered from")
    print(scene, end="" if scene.endswith("\n") else "\n")


def _print_pixels(image: SpectralImage) -> None:
    import numpy as np

    height, width, bands = image.spectral_radiance.shape
    lowest_nm, highest_nm = image.wavelengths_nm[0], image.wavelengths_nm[-1]
    print(image.path)
    _print_row("size", f"{width} × {height} pixels")
    _print_row("bands", f"{bands}, centred on {lowest_nm:g} to {highest_nm:g} nm")
    _print_row("unit", image.attribute("bands") or image.attributes.get("emissiveUnits"))
    with np.errstate(invalid="ignore"):  # a file may hold anything
        mean, largest = image.spectral_radiance.mean(dtype="float64"), image.spectral_radiance.max()
    _print_row("mean", f"{mean:.6g}")
    _print_row("largest", f"{largest:.6g}")
    _print_row("standard error", "yes" if image.standard_error is not None else "no")
    _print_row("linear RGB", "yes" if image.linear_rgb is not None else "no")
    _print_row("exposure", image.attributes.get("EV"), "stops")
    _print_row("other channels", ", ".join(image.other_channels) or None)


def _print_origin(image: SpectralImage) -> None:
    """How to render the file again, if it is one of Nephroid's."""
    _print_row("Nephroid", image.attribute("version"))
    _print_row("scene", image.attribute("scene_name"))
    _print_row("observer", image.attribute("observer"))
    _print_row("ended by", image.attribute("stopping"))
    for heading, unit in (("settings", ""), ("features", ""), ("accuracy", ""), ("energy", "W")):
        values = _table(image, heading)
        if values:
            print(f"  {heading}")
        by_band = values.pop("by_band", ())
        for name, value in values.items():
            _print_row(f"  {name}", value, unit)
        if by_band:
            _print_bands(image, by_band)


def _print_bands(image: SpectralImage, by_band: object) -> None:
    """The energy books of each band, of a file that whoever may have written."""
    from sim.errors import FileFormatError
    from sim.photons.energy import BOOK_COLUMNS

    rows, columns = _numbers(by_band), len(BOOK_COLUMNS)
    if rows.ndim != 2 or rows.shape[1] != columns:
        reason = f"by_band of its attribute 'energy' is not a table of {columns} columns"
        raise FileFormatError(image.path, reason)
    for line in band_lines(rows.tolist(), _book_centres_nm(image, len(rows))):
        print(f"  {line}")


def _book_centres_nm(image: SpectralImage, count: int) -> list[float] | None:
    """Centres of the books' bands [nm], which are the film's; None if the file does not say.

    A sensor's own bands may be others.
    """
    import numpy as np

    text = image.attribute("film_edges_nm")
    if text is None:
        return image.wavelengths_nm.tolist() if len(image.wavelengths_nm) == count else None
    try:
        edges_nm = _numbers(json.loads(text))
    except (ValueError, RecursionError):
        return None
    if edges_nm.shape != (count + 1,) or not np.all(np.isfinite(edges_nm)):
        return None
    centres_nm: list[float] = (0.5 * (edges_nm[1:] + edges_nm[:-1])).tolist()
    return centres_nm


def _numbers(values: object) -> NDArray[np.float64]:
    """What a file holds as an array; an empty one if those are no numbers in rows."""
    import numpy as np

    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return np.empty(0)


def _table(image: SpectralImage, heading: str) -> dict[str, object]:
    """What an attribute of ours holds, whoever wrote it."""
    from sim.errors import FileFormatError

    try:
        values = json.loads(image.attribute(heading) or "{}")
    except (ValueError, RecursionError):
        values = None
    if not isinstance(values, dict):
        reason = f"its attribute {heading!r} is not what Nephroid writes there: a table in JSON"
        raise FileFormatError(image.path, reason)
    return values


def _print_row(name: str, value: object, unit: str = "") -> None:
    """One line, unless the file does not say."""
    told = _text(value)  # of a file from anywhere: nothing that a terminal would obey
    text = "".join(one if one.isprintable() else "\N{REPLACEMENT CHARACTER}" for one in told)
    if text:
        print(f"  {name:<22}{text} {unit}".rstrip())


def _text(value: object, depth: int = _DEEPEST) -> str:
    """A value of an attribute, as a reader wants it; what is nested deeper is left out."""
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, dict | list) and depth == 0:
        return "…"
    if isinstance(value, dict):
        return ", ".join(f"{name} {_text(one, depth - 1)}" for name, one in value.items())
    if isinstance(value, list):
        return ", ".join(_text(one, depth - 1) for one in value)
    return "" if value is None else str(value)
