"""Mutations of scene files: of their bytes, and of the tables that they hold."""

from __future__ import annotations

import copy
import datetime
import random
from typing import Any

from scene_grammar import NASTY_NUMBERS, NASTY_TEXTS, WORDS

__all__ = ["mutate_bytes", "mutate_tables"]

_PIECES = [
    b"[[objects]]\n", b"[film]\n", b"[", b"]", b"[[", b"{", b"}", b'"', b"'", b'"""', b"'''", b"=",
    b".", b",", b"\n", b"\r", b"\x00", b"\xff", b"\xef\xbb\xbf", b"\xf0\x9f\x98\x80", b"#", b"\\",
    b"\\u0000", b"\\ud800", b"\\UFFFFFFFF", b"nan", b"inf", b"-", b"+", b"0x", b"1_000", b"1e999",
    b"9" * 400, b"9" * 5000, b"true", b"1979-05-27T07:32:00Z", b"00:00:00", b"a.b.c.d = 1\n",
    b"a." * 200 + b"a = 1\n", b"[" * 600, b"{a=" * 400, b" " * 1000, b"a" * 2000, b"[[a]]\n" * 200,
    b"length_unit = 'mm'\n", b"1e-400", b"0.0", b"-0.0", b"1e300",
]  # fmt: skip


def mutate_bytes(data: bytes, rng: random.Random, pieces: list[bytes] | None = None) -> bytes:
    """A file with some of its bytes flipped, cut out, doubled, moved, or put in."""
    found = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 3, 5, 10])):
        place = rng.randrange(len(found) + 1)
        end = min(len(found), place + rng.choice([1, 2, 4, 8, 40, 400]))
        kind = rng.randrange(9)
        if kind == 0 and place < len(found):
            found[place] ^= 1 << rng.randrange(8)
        elif kind == 1 and place < len(found):
            found[place] = rng.randrange(256)
        elif kind == 2:
            del found[place:end]
        elif kind == 3:
            found[place:place] = found[place:end] * rng.choice([1, 2, 50])
        elif kind == 4:
            start = rng.randrange(len(found) + 1)
            found[place:place] = found[start : start + end - place]
        elif kind in (5, 6):
            found[place:place] = rng.choice(_PIECES if pieces is None else pieces)
        elif kind == 7:
            del found[place:]
        else:
            found[place:end] = rng.randbytes(end - place)
    return bytes(found)


def mutate_tables(data: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """A scene's tables with some entries dropped, doubled, swapped, nested, or of another kind."""
    mutant = copy.deepcopy(data)
    for _ in range(rng.choice([1, 1, 1, 2, 3, 5])):
        places = list(_places(mutant))
        if not places:
            break
        _mutate(*rng.choice(places), places, rng)
    return mutant


def _places(node: Any) -> Any:
    keys = node.keys() if isinstance(node, dict) else range(len(node))
    for key in list(keys):
        yield node, key
        if isinstance(node[key], dict | list):
            yield from _places(node[key])


def _mutate(node: Any, key: Any, places: list[Any], rng: random.Random) -> None:
    if key >= len(node) if isinstance(node, list) else key not in node:
        return  # what was done before took it away
    value = node[key]
    kind = rng.randrange(12)
    if kind == 0:
        del node[key]
    elif kind == 1:
        _double(node, key, rng)
    elif kind == 2:
        node[key] = _of_another_kind(rng)
    elif kind == 3:
        node[key] = rng.choice([[value], {"type": value}, {str(key): value}, [value, value]])
    elif kind == 4:
        other, there = rng.choice(places)
        if isinstance(other, dict) and there in other:
            node[key] = copy.deepcopy(other[there])
    elif kind in (5, 6) and isinstance(value, int | float):
        node[key] = rng.choice(
            [-value, value * 1000, value / 1000, value * 1e6, value * 1e-9, float(value), value + 1]
        )
    elif kind == 7:
        node[key] = _large(rng)
    elif kind == 8 and isinstance(key, str):
        node[rng.choice([key + "s", key.upper(), key[:-1], "type", "é", "x" * 300])] = node.pop(key)
    elif kind == 9 and isinstance(value, str):
        node[key] = rng.choice([*NASTY_TEXTS, *(w for words in WORDS.values() for w in words)])
    else:
        node[key] = rng.choice(NASTY_NUMBERS)


def _double(node: Any, key: Any, rng: random.Random) -> None:
    if isinstance(node, list):
        node[key:key] = [copy.deepcopy(node[key]) for _ in range(rng.choice([1, 1, 2, 20]))]
    else:
        node[f"{key}_2"] = node[key]


def _of_another_kind(rng: random.Random) -> Any:
    return rng.choice(
        [
            True, "text", [], {}, [[]], [{}], {"type": "sphere"}, {"type": "table"}, 1, 0.5, "",
            {"type": 1}, {"type": []}, datetime.date(2026, 1, 1), datetime.time(1, 2),
            ["a", 1, {}], {"": ""}, {"a b": {"c.d": 1}},
        ]
    )  # fmt: skip


def _large(rng: random.Random) -> Any:
    many = rng.choice([10, 1000, 3000])
    kind = rng.randrange(6)
    if kind == 0:
        return [rng.choice(NASTY_NUMBERS)] * many
    if kind == 1:
        return [float(i) for i in range(many)]
    if kind == 2:
        return "x" * many * 10
    if kind == 3:
        return {f"k{i}": i for i in range(many)}
    deep: Any = 1
    for _ in range(min(many, 90)):
        deep = [deep] if kind == 4 else {"a": deep}
    return deep
