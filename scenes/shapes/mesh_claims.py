"""What mesh files claim to hold, looked at before a reader believes it.

A few bytes can claim 10¹² vertices, name other files, or put one mesh in a million places. What is
checked is only that; whether the rest is right, the reader finds out.
"""

import json
import struct
from typing import Any

__all__ = ["is_text_stl", "refuse_false_claims"]

_HEADER_BYTES = 64 * 1024
_JSON_BYTES = 8 * 1024 * 1024
_MOST_NODES = 10_000
_DEEPEST = 100
_STL_START, _STL_TRIANGLE = 84, 50
"""Bytes of a binary STL's header, with the number of triangles last, and of each triangle."""

_GLB_START = 20
"""Length of what stands before the JSON of a GLB: magic, version, length; chunk length, kind."""


def refuse_false_claims(content: bytes, kind: str, most_triangles: int) -> None:
    """Refuse a file that claims more than it can hold, or more than may be.

    Args:
        content: of the file.
        kind: "ply", "obj", "stl" or "glb".
        most_triangles: how many there may be.

    Raises:
        ValueError: saying what it claims.
    """
    if kind == "ply":
        _check_ply(content, most_triangles)
    elif kind == "glb":
        _check_glb(content, most_triangles)
    elif kind == "stl":
        _check_stl(content)


def _check_ply(content: bytes, most_triangles: int) -> None:
    """The header's `element NAME COUNT`: every element takes a byte at the least."""
    header, found, _ = content[:_HEADER_BYTES].partition(b"end_header")
    if not found:
        raise ValueError(f"its header does not end within {_HEADER_BYTES // 1024} kB")
    for line in header.decode("latin-1").splitlines():
        words = line.split()
        if not words or words[0] != "element":
            continue
        name, count = _element(words)
        allowed = 3 * most_triangles if name == "vertex" else most_triangles
        if count > len(content) or count > allowed:
            raise ValueError(
                f"its header claims {count} of the element {name!r};"
                f" allowed: at most {min(allowed, len(content))} in a file of {len(content)} bytes"
            )


def _element(words: list[str]) -> tuple[str, int]:
    if len(words) != 3 or not words[2].isdecimal() or len(words[2]) > 20:
        raise ValueError("its header counts an element in no whole number of at most 20 digits")
    return words[1][:40], int(words[2])


def is_text_stl(content: bytes) -> bool:
    """Whether an STL file is of text, which begins "solid".

    The free header of a binary one may begin so as well: it is as long as its count says. Of text,
    these four bytes are characters, which no file of 64 MB is long enough for.
    """
    return content.lstrip()[:5].lower() == b"solid" and not _is_as_long_as_it_says(content)


def _is_as_long_as_it_says(content: bytes) -> bool:
    return len(content) >= _STL_START and (
        len(content) == _STL_START + _STL_TRIANGLE * _stl_count(content)
    )


def _stl_count(content: bytes) -> int:
    return int(struct.unpack_from("<I", content, _STL_START - 4)[0])


def _check_stl(content: bytes) -> None:
    """Of a binary one, the number of its triangles says how long it is."""
    if is_text_stl(content):
        return
    if len(content) < _STL_START:
        raise ValueError("it is cut off")
    if not _is_as_long_as_it_says(content):
        count = _stl_count(content)
        raise ValueError(f"its header claims {count} triangles, which is not what its length says")


def _check_glb(content: bytes, most_triangles: int) -> None:
    """The JSON chunk (Khronos 2021, glTF 2.0, §4.4): buffers, accessors, and the tree of nodes."""
    if len(content) < _GLB_START:
        raise ValueError("it is cut off")
    length = struct.unpack_from("<I", content, _GLB_START - 8)[0]
    if length > min(_JSON_BYTES, len(content) - _GLB_START):
        raise ValueError(f"it claims {length} bytes of JSON; allowed: at most {_JSON_BYTES}")
    try:
        document = json.loads(content[_GLB_START : _GLB_START + length])
    except (ValueError, RecursionError) as error:
        raise ValueError(f"its JSON cannot be read: {error}") from None
    for buffer in _tables(document, "buffers"):
        if "uri" in buffer:
            raise ValueError("it refers to another file; allowed: all of its buffers in itself")
    for index, accessor in enumerate(_tables(document, "accessors")):
        count = accessor.get("count")
        if not isinstance(count, int) or not 0 <= count <= 3 * most_triangles:
            raise ValueError(
                f"its accessor {index} claims {str(count)[:40]} elements;"
                f" allowed: a whole number up to {3 * most_triangles}"
            )
        if "bufferView" not in accessor:
            raise ValueError(f"its accessor {index} names no data; sparse ones are not read")
    _check_tree(_tables(document, "nodes"))


def _tables(document: Any, key: str) -> list[dict[str, Any]]:
    """The array of tables of that key; none if it is not there."""
    found = document.get(key, []) if isinstance(document, dict) else None
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise ValueError(f"its {key} are no array of tables")
    return found


def _check_tree(nodes: list[dict[str, Any]]) -> None:
    """Every node has one parent at most (§3.5.2): otherwise few nodes are in many places."""
    if len(nodes) > _MOST_NODES:
        raise ValueError(f"it has {len(nodes)} nodes; allowed: at most {_MOST_NODES}")
    parent: dict[int, int] = {}
    for index, node in enumerate(nodes):
        children = node.get("children", [])
        if not isinstance(children, list):
            raise ValueError(f"its node {index} has children that are no array")
        for child in children:
            if not isinstance(child, int) or not 0 <= child < len(nodes) or child in parent:
                raise ValueError(f"its nodes are no tree: node {index} has the child {child!r:.40}")
            parent[child] = index
    for start in parent:
        place, steps = start, 0
        while place in parent:
            place, steps = parent[place], steps + 1
            if steps > len(nodes):
                raise ValueError(f"its nodes are no tree: node {start} is above itself")
        if steps > _DEEPEST:
            raise ValueError(f"its nodes are nested {steps} deep; allowed: at most {_DEEPEST}")
