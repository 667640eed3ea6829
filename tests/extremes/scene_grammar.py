"""Random scenes, grown from the JSON Schema of scene files.

What the schema says is kept most of the time: keys, types, bounds, lengths of arrays. So most
tables are right in themselves, and the checks behind the first are reached too.
"""

from __future__ import annotations

import random
import string
from typing import Any

import scenes

__all__ = ["NASTY_NUMBERS", "NASTY_TEXTS", "WORDS", "grow_scene"]

NASTY_NUMBERS: list[Any] = [
    0, -1, 1, 2, 3, 255, 1000, 16384, 2**31, 2**63, -(2**63), 10**30,
    0.0, -0.0, 1e-300, 5e-324, -5e-324, 1e300, -1e300, 1.7976931348623157e308,
    float("inf"), float("-inf"), float("nan"), 1e-9, 1e9, 1.0000001e9, 1e-10, 0.55, 550.0, 89.99999,
    90, 180, 360, 1e15, 80, 100,
]  # fmt: skip
"""Numbers at, within and beyond the bounds of what some field allows."""

NASTY_TEXTS = [
    "", " ", "\x00", "\n", "é", "𝔘𝔫𝔦", "\u202e", "\ud7ff", "x" * 500, "../..", "/dev/zero",
    "/etc/passwd", "loop", "pipe", "folder", "outside.obj", "none", "null", "0", "1e9", "{}", "%s",
    "$HOME", "~", "CON", "a" * 300 + ".obj", "type", "D65", "N-BK7", "gold",
]  # fmt: skip

WORDS = {
    "medium": ["N-BK7", "SF11", "N-SF11", "water", "air", "vacuum", "diamond", "fused silica"],
    "ambient": ["reference", "air", "vacuum", "water"],
    "metal": ["gold", "silver", "copper", "aluminium"],
    "spectrum": ["D65", "A", "E", "sodium", "mercury"],
    "absorption": ["published"],
    "file": [
        "one.obj", "one.ply", "one.stl", "one.glb", "cube.obj", "heights.npy", "heights.txt",
        "mask.png", "none.obj", "pipe", "folder", "outside.obj", "/dev/zero", "../scene.toml",
    ],
}  # fmt: skip
"""What fields of these names may well hold."""

_MAX_DEPTH = 12

_AS_LONG_AS = {"wavelength_nm": ["values", "weights", "eta", "n", "k"], "b": ["c_um2"]}
_ONE_OF = [("radius", "curvature"), ("heights", "file", "waves"), ("values", "file")]


def grow_scene(rng: random.Random) -> dict[str, Any]:
    """A scene file's content that looks right; now and then something in it is not."""
    grower = _Grower(rng)
    data: dict[str, Any] = grower.table(_SCHEMA, "", 0)
    data["length_unit"] = rng.choice(["m", "mm"])
    scale = rng.choice([1.0, 100.0]) * (1000.0 if data["length_unit"] == "mm" else 1.0)
    for plural, kind in (("objects", "SceneObject"), ("emitters", None), ("sensors", None)):
        if kind is not None:
            model = grower.defs[kind]
            entries = [grower.table(model, kind, 1) for _ in range(rng.randrange(5))]
        else:
            items = _SCHEMA["properties"][plural]["items"]
            entries = [grower.value(items, plural, 1) for _ in range(rng.randrange(3))]
        for one in entries:
            if isinstance(one, dict):
                one.pop("name", None)
        data[plural] = entries
    _place(data, rng, scale)
    return data


def _place(data: Any, rng: random.Random, scale: float) -> None:
    """Positions and sizes of one scale, so that things lie beside and in one another."""
    if isinstance(data, list):
        for one in data:
            _place(one, rng, scale)
    if not isinstance(data, dict):
        return
    for key, value in data.items():
        if key in ("position", "look_at"):
            data[key] = [rng.uniform(-scale, scale) for _ in range(3)]
        elif key in ("radius", "size", "base", "length", "aperture", "width", "height"):
            if rng.random() < 0.7 and not isinstance(value, int):
                many = isinstance(value, list)
                sizes = [rng.uniform(0.01, 0.5) * scale for _ in range(len(value) if many else 1)]
                data[key] = sizes if many else sizes[0]
        _place(value, rng, scale)


class _Grower:
    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.defs = _SCHEMA["$defs"]

    def value(self, rule: dict[str, Any], key: str, depth: int) -> Any:  # noqa: PLR0911
        """A value that a rule of the schema describes."""
        rng = self.rng
        if rng.random() < 0.002:
            return rng.choice([*NASTY_NUMBERS, *NASTY_TEXTS, [], {}, True])
        if "$ref" in rule:
            return self.value(self.defs[rule["$ref"].rsplit("/", 1)[1]], key, depth)
        for union in ("anyOf", "oneOf"):
            if union in rule:
                return self.value(rng.choice(rule[union]), key, depth + 1)
        if "const" in rule:
            return rule["const"]
        if "enum" in rule:
            return rng.choice(rule["enum"])
        kind = rule.get("type")
        if kind == "object":
            return self.table(rule, key, depth)
        if kind == "array":
            return self.array(rule, key, depth)
        return self.scalar(kind, rule, key)

    def table(self, rule: dict[str, Any], key: str, depth: int) -> dict[str, Any]:
        required = set(rule.get("required", ())) | {"type"}
        chance = 0.25 if depth < _MAX_DEPTH else 0.0
        if not key:  # the scene itself: its lists of things are grown apart
            chance = 0.7
        kept = {}
        for name, inner in rule.get("properties", {}).items():
            if name in required or self.rng.random() < chance:
                value = self.value(inner, name, depth + 1)
                if value is not None:
                    kept[name] = value
        if self.rng.random() < 0.98:
            self._agree(kept, rule.get("properties", {}), depth)
        return kept

    def _agree(self, table: dict[str, Any], rules: dict[str, Any], depth: int) -> None:
        """Make the keys of a table agree, as the schema cannot say."""
        rng = self.rng
        for one, others in _AS_LONG_AS.items():
            for other in others:
                if isinstance(table.get(one), list) and isinstance(table.get(other), list):
                    count = min(len(table[one]), len(table[other]))
                    table[one], table[other] = table[one][:count], table[other][:count]
        for group in _ONE_OF:
            if all(key in rules for key in group):
                kept = rng.choice(group)
                for key in group:
                    table.pop(key, None)
                value = None
                while value is None:
                    value = self.value(rules[kept], kept, depth + 1)
                table[kept] = value
        rows = table.get("heights")
        if isinstance(rows, list) and rows and all(isinstance(row, list) and row for row in rows):
            width = min(map(len, table["heights"]))
            table["heights"] = [row[:width] for row in table["heights"]]
        if "shape" in table and "material" in table:
            self._fit(table, depth)
        if "first_nm" in table or "last_nm" in table:
            table |= {"first_nm": 420.0, "last_nm": rng.uniform(500.0, 700.0)}
            table.pop("band_width_nm", None)
        if "width_nm" in table:
            table["width_nm"] = rng.uniform(0.0, 20.0)
        if "focus_distance" in table or "exposure" in table:
            table.pop("f_number", None)
            table["aperture_radius"] = 0.01

    def _fit(self, thing: dict[str, Any], depth: int) -> None:
        """A material that the shape can have."""
        shape, material = thing["shape"], thing["material"]
        if not isinstance(shape, dict) or not isinstance(material, dict):
            return
        kind = material.get("type")
        sheet = shape.get("type") in ("plane", "rectangle", "disk")
        closed = not sheet and (shape.get("type") != "heightfield" or "depth" in shape)
        if (kind == "polariser" and not sheet) or (kind == "dielectric" and not closed):
            thing["material"] = {"type": self.rng.choice(["absorber", "mirror"])}

    def array(self, rule: dict[str, Any], key: str, depth: int) -> list[Any]:
        if key == "range_nm":
            return [self.rng.uniform(300, 420), self.rng.uniform(600, 900)]
        if "prefixItems" in rule:
            return [self.value(one, key, depth + 1) for one in rule["prefixItems"]]
        low, high = rule.get("minItems", 0), rule.get("maxItems", 4)
        count = self.rng.randint(low, max(low, min(high, low + 3)))
        items = [self.value(rule.get("items", {}), key, depth + 1) for _ in range(count)]
        if key in ("wavelength_nm", "range_nm") and self.rng.random() < 0.95:
            inner = {self.rng.uniform(420, 700) for _ in range(count - 2)}
            items = sorted({380.0, *inner, 720.0})
        return [one for one in items if one is not None]

    def scalar(self, kind: str | None, rule: dict[str, Any], key: str) -> Any:
        rng = self.rng
        if kind == "string":
            if key in WORDS and rng.random() < 0.97:
                return rng.choice(WORDS[key])
            return "".join(rng.choices(string.printable + "äλ", k=rng.randrange(8)))
        if kind == "boolean":
            return rng.random() < 0.5
        if kind == "null":
            return None
        low = rule.get("minimum", rule.get("exclusiveMinimum", -5.0))
        high = rule.get("maximum", rule.get("exclusiveMaximum", low + 10.0))
        if key.endswith("_nm"):
            low, high = max(low, 350.0), 800.0
        if kind == "integer":
            low, high = int(low), int(min(high, low + 40))
            return rng.choice([low, high, rng.randint(low, high)]) or 1
        return rng.choice([rng.uniform(low, high), round(rng.uniform(low, high), 1)])


_SCHEMA = scenes.schema()
