"""Arrays by name, of parts of parts: ``film.mean``, ``sensors.rays0.flux.mean``."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

__all__ = ["NamedArrays", "part_of", "prefixed"]

NamedArrays = dict[str, NDArray[Any]]


def prefixed(part: str, arrays: NamedArrays) -> NamedArrays:
    """The arrays of a part, under the names that the whole has for them."""
    return {f"{part}.{name}": one for name, one in arrays.items()}


def part_of(arrays: NamedArrays, part: str) -> NamedArrays:
    """The arrays of a part, under its own names."""
    start = f"{part}."
    return {
        name.removeprefix(start): one for name, one in arrays.items() if name.startswith(start)
    }
