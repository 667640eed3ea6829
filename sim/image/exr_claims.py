"""What an EXR file claims to hold, read from its header before the library takes memory for it.

A file of a few kilobytes can claim, and unpack to, many gigabytes of pixels. The header is a row of
attributes, each a name, a type, a length and data (OpenEXR 3 documentation, "OpenEXR File Layout");
of a file in parts there are several headers, and an empty one behind the last.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from typing import BinaryIO, Final

from sim.errors import FileFormatError

__all__ = ["refuse_bombs"]

_MAGIC: Final = (20000630).to_bytes(4, "little")
_MULTIPLE_PARTS: Final = 0x1000
_LONGEST_NAME: Final = 255
_LONGEST_ATTRIBUTE: Final = 64 * 1024 * 1024
_MOST_HEADERS: Final = 100
_MOST_ATTRIBUTES: Final = 10_000
_BYTES_OF_TYPE: Final = {0: 4, 1: 2, 2: 4}  # unsigned integers, half and single floats

_ALWAYS_READ: Final = 1 << 30
_MOST_TIMES_ITS_LENGTH: Final = 1024
"""Spectra with noise, as renderings have, compress two to three times; black ones some 400 times by
PIZ, which we write, and up to 1030 times by ZIP (deflate: 258 bytes in 2 bits)."""


def refuse_bombs(path: str) -> None:
    """Refuse a file that is none, or whose pixels would take more room than such a file can need.

    Raises:
        FileFormatError: It is no OpenEXR file, its header is damaged, or it claims too much.
        OSError: It cannot be read.
    """
    size = os.stat(path).st_size
    with open(path, "rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise FileFormatError(path, "it is not an OpenEXR file")
        try:
            claimed = sum(_claims(file))
        except (struct.error, ValueError) as error:
            raise FileFormatError(path, f"its header is damaged or cut off ({error})") from None
    allowed = max(_ALWAYS_READ, _MOST_TIMES_ITS_LENGTH * size)
    if claimed > allowed:
        reason = f"it claims {claimed} bytes of pixels in a file of {size} bytes; allowed: at most"
        raise FileFormatError(path, f"{reason} {allowed}")


def _claims(file: BinaryIO) -> Iterator[int]:
    """Bytes of pixels of each part."""
    (version,) = struct.unpack("<I", file.read(4))
    for _ in range(_MOST_HEADERS):
        attributes = dict(_attributes(file))
        if not attributes and version & _MULTIPLE_PARTS:
            return
        left, bottom, right, top = struct.unpack("<4i", attributes.get("dataWindow", b""))
        width, height = right - left + 1, top - bottom + 1
        if width < 1 or height < 1:
            raise ValueError(f"a data window of {width} × {height} pixels")
        yield width * height * _bytes_a_pixel(attributes.get("channels", b""))
        if not version & _MULTIPLE_PARTS:
            return
    raise ValueError(f"more than {_MOST_HEADERS} parts")


def _attributes(file: BinaryIO) -> Iterator[tuple[str, bytes]]:
    for _ in range(_MOST_ATTRIBUTES):
        name = _text(file)
        if not name:
            return
        _text(file)  # its type, which its name implies
        (length,) = struct.unpack("<i", file.read(4))
        if not 0 <= length <= _LONGEST_ATTRIBUTE:
            raise ValueError(f"an attribute of {length} bytes")
        data = file.read(length)
        if len(data) != length:
            raise ValueError("an attribute ends with the file")
        yield name, data
    raise ValueError(f"more than {_MOST_ATTRIBUTES} attributes")


def _text(file: BinaryIO) -> str:
    """A text that ends in a zero."""
    text = bytearray()
    while (one := file.read(1)) != b"\0":
        if not one or len(text) >= _LONGEST_NAME:
            raise ValueError("a name without end")
        text += one
    return text.decode("latin-1")


def _bytes_a_pixel(channels: bytes) -> int:
    """Of all channels: each is a name that ends in zero, and its type first of 16 bytes."""
    total = place = 0
    while place < len(channels) and channels[place]:
        place = channels.index(0, place) + 1
        (kind,) = struct.unpack_from("<i", channels, place)
        total += _BYTES_OF_TYPE.get(kind, 4)
        place += 16
    return total
