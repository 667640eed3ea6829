"""Files of named arrays with a header, that say whether they are whole.

Layout: a line that names the format; the header's length, 8 bytes, little-endian; the header, JSON
in UTF-8; the arrays' bytes, one after the other; SHA-256 of all before. Nothing in it is code, and
nothing is believed before the digest has been compared: a file that was cut short, altered or made
up is an error that says so.

The arrays are read where they lie (mmap), since those of a large film take gigabytes.
"""

from __future__ import annotations

import hashlib
import json
import math
import mmap
import os
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.errors import FileFormatError

__all__ = ["StoredState", "encode_state", "read_state"]

MAGIC = b"nephroid checkpoint 1\n"

PIECE = 1 << 22
"""Bytes that are handed over at a time: a millisecond of work."""

_LENGTH_BYTES = 8
_DIGEST_BYTES = 32
_LARGEST_HEADER = 1 << 26
_TYPES = ("<f8", "<f4", "<i4", "<i8")

Array = NDArray[Any]


class StoredState:
    """What a file holds.

    Attributes:
        numbers: the header's part that is not about arrays.
        arrays: by name, read-only.
    """

    def __init__(self, numbers: dict[str, Any], arrays: dict[str, Array]) -> None:
        self.numbers = numbers
        self.arrays = arrays


def encode_state(numbers: Mapping[str, Any], arrays: Mapping[str, Array]) -> Iterator[memoryview]:
    """The content of a file, in pieces.

    Args:
        numbers: ready for JSON.
        arrays: by name, of float64, float32, int32 or int64.
    """
    rows = [[name, _type_of(array), list(array.shape)] for name, array in arrays.items()]
    header = json.dumps({"numbers": numbers, "arrays": rows}).encode()
    digest = hashlib.sha256()
    start = MAGIC + len(header).to_bytes(_LENGTH_BYTES, "little") + header
    for view in (memoryview(start), *(_bytes_of(array) for array in arrays.values())):
        for first in range(0, len(view), PIECE):
            piece = view[first : first + PIECE]
            digest.update(piece)
            yield piece
    yield memoryview(digest.digest())


def _type_of(array: Array) -> str:
    name = array.dtype.newbyteorder("<").str
    if name not in _TYPES:
        raise TypeError(f"an array of {array.dtype} is not for these files")
    return name


def _bytes_of(array: Array) -> memoryview:
    plain = np.ascontiguousarray(array, dtype=_type_of(array))
    return plain.reshape(-1).view(np.uint8).data


def read_state(path: str | os.PathLike[str]) -> StoredState:
    """Read a file back.

    Raises:
        FileFormatError: it is not such a file, or not as it was written.
        OSError: it cannot be read.
    """
    try:
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            if size < len(MAGIC) + _LENGTH_BYTES + _DIGEST_BYTES:
                raise FileFormatError(path, "it is no checkpoint, or was cut short")
            content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except OSError as error:
        raise FileFormatError(path, error.strerror or str(error)) from error
    if content[: len(MAGIC)] != MAGIC:
        raise FileFormatError(path, "it is no checkpoint of this version")
    if not _is_whole(content):
        raise FileFormatError(path, "it is damaged or was cut short: its digest is another")
    try:
        return _parsed(content)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, OverflowError):
        raise FileFormatError(path, "its header makes no sense") from None


def _is_whole(content: mmap.mmap) -> bool:
    """Whether the digest at the end is that of all before."""
    end = len(content) - _DIGEST_BYTES
    digest = hashlib.sha256()
    with memoryview(content) as view:
        for first in range(0, end, PIECE):
            digest.update(view[first : min(first + PIECE, end)])
    return digest.digest() == content[end:]


def _parsed(content: mmap.mmap) -> StoredState:
    """Header and arrays of a whole file; any of several errors if they do not fit together."""
    first = len(MAGIC) + _LENGTH_BYTES
    length = int.from_bytes(content[len(MAGIC) : first], "little")
    end = len(content) - _DIGEST_BYTES
    if length > min(_LARGEST_HEADER, end - first):
        raise ValueError
    header = json.loads(content[first : first + length])
    place, arrays = first + length, {}
    for name, type_name, shape in header["arrays"]:
        if type_name not in _TYPES or not isinstance(name, str) or name in arrays:
            raise ValueError
        if not all(type(side) is int and side >= 0 for side in shape):
            raise ValueError
        kind = np.dtype(type_name)
        count = math.prod(shape)
        if count > (end - place) // kind.itemsize:
            raise ValueError
        flat: Array = np.frombuffer(content, kind, count, place) if count else np.zeros(0, kind)
        arrays[name] = flat.reshape(shape)
        place += count * kind.itemsize
    if place != end or not isinstance(header["numbers"], dict):
        raise ValueError
    return StoredState(header["numbers"], arrays)
