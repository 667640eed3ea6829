"""The JSON Schema: complete for editors, and in agreement with the gallery."""

import json
import tomllib
from typing import Any

import pytest

import scenes

SCHEMA = scenes.schema()

PYTHON_TYPES: dict[str, tuple[type, ...]] = {
    "number": (int, float),
    "integer": (int,),
    "string": (str,),
    "null": (type(None),),
}


def resolve(schema: dict[str, Any]) -> dict[str, Any]:
    reference = schema.get("$ref")
    return SCHEMA["$defs"][reference.rsplit("/", 1)[1]] if reference else schema


def matches(value: Any, schema: dict[str, Any]) -> bool:
    """Whether a value satisfies the parts of JSON Schema that this schema uses."""
    schema = resolve(schema)
    for keyword in ("oneOf", "anyOf"):
        if keyword in schema:
            return any(matches(value, choice) for choice in schema[keyword])
    if "const" in schema:
        return bool(value == schema["const"])
    if "enum" in schema:
        return value in schema["enum"]
    kind = schema["type"]
    if kind == "object":
        return (
            isinstance(value, dict)
            and set(schema.get("required", [])) <= set(value) <= set(schema["properties"])
            and all(matches(entry, schema["properties"][key]) for key, entry in value.items())
        )
    if kind == "array":
        items = schema.get("prefixItems") or [schema["items"]] * len(value)
        return isinstance(value, list) and all(map(matches, value, items))
    return isinstance(value, PYTHON_TYPES[kind])


@pytest.mark.parametrize("name", scenes.gallery())
def test_the_gallery_satisfies_it(name: str) -> None:
    data = tomllib.loads(scenes.gallery_path(name).read_text(encoding="utf-8"))
    assert matches(data, SCHEMA)
    assert not matches({**data, "titel": "x"}, SCHEMA)


def test_every_field_is_described() -> None:
    for name, model in {"Scene": SCHEMA, **SCHEMA["$defs"]}.items():
        assert model["description"], name
        for key, field in model["properties"].items():
            assert field.get("description"), f"{name}.{key}"


def test_unions_are_told_apart_by_their_type() -> None:
    shape = SCHEMA["$defs"]["SceneObject"]["properties"]["shape"]
    assert shape["discriminator"]["propertyName"] == "type"
    assert set(shape["discriminator"]["mapping"]) == {
        "box",
        "disk",
        "heightfield",
        "lens",
        "mesh",
        "plane",
        "polyhedron",
        "prism",
        "rectangle",
        "sphere",
    }


def test_it_is_json_of_a_stated_dialect() -> None:
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA
    assert SCHEMA["$schema"].endswith("2020-12/schema")
    assert "NaN" not in json.dumps(SCHEMA)
