"""Whatever a file contains, nothing but a SceneError comes out of it."""

import contextlib
import copy
import tomllib
from typing import Any

import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

import scenes

# A junk value may also be one that looks like a slip; that is told, and no error.
pytestmark = pytest.mark.filterwarnings("ignore::scenes.SceneWarning")

KEYS = st.sampled_from(
    sorted(
        {
            key
            for model in [scenes.schema(), *scenes.schema()["$defs"].values()]
            for key in model["properties"]
        }
    )
)
TYPES = st.sampled_from(
    [
        *("sphere", "plane", "box", "prism", "polyhedron", "lens", "dielectric", "lambertian"),
        *("mirror", "conductor", "napierian", "decadic", "extinction", "internal_transmittance"),
        *("beam", "point", "spot", "rectangle", "round", "slit", "cauchy", "table", "lines"),
    ]
)
NUMBERS = st.one_of(
    st.floats(),
    st.integers(-(2**70), 2**70),
    st.sampled_from([0, 1, -1, 0.5, 1e-300, 1e308, -1e308, 5e-324, 400, 700, 589.3]),
)
SCALARS = st.one_of(
    NUMBERS, st.booleans(), st.text(max_size=5), TYPES, st.dates(), st.sampled_from(["D65", "SF11"])
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.one_of(KEYS, st.text()), inner, max_size=4)
    ),
    max_leaves=12,
)
GALLERY = [
    tomllib.loads(scenes.gallery_path(name).read_text(encoding="utf-8"))
    for name in scenes.gallery()
]


def load_or_refuse(text: str) -> None:
    with contextlib.suppress(scenes.SceneError):
        scenes.loads(text)


@given(st.text())
@settings(deadline=None)
def test_any_text(text: str) -> None:
    load_or_refuse(text)


@given(st.dictionaries(KEYS, VALUES, max_size=6))
@settings(deadline=None)
def test_any_tables_with_our_keys(data: dict[str, Any]) -> None:
    load_or_refuse(tomli_w.dumps(data))


@given(st.data())
@settings(deadline=None, max_examples=300)
def test_any_change_of_a_scene_of_the_gallery(data: st.DataObject) -> None:
    document = copy.deepcopy(data.draw(st.sampled_from(GALLERY)))
    for _ in range(data.draw(st.integers(1, 3))):
        place: Any = document
        while True:
            keys = list(place) if isinstance(place, dict) else list(range(len(place)))
            key = data.draw(st.sampled_from(keys)) if keys else None
            deeper = key is not None and isinstance(place[key], dict | list) and place[key]
            if not deeper or data.draw(st.integers(0, 5)) == 0:
                break
            place = place[key]
        if key is not None:
            place[key] = data.draw(st.one_of(NUMBERS, VALUES))
        elif isinstance(place, dict):
            place[data.draw(KEYS)] = data.draw(VALUES)
    load_or_refuse(tomli_w.dumps(document))


@pytest.mark.parametrize("value", ["0x" + "f" * 5000, "-1e-400", "1e400", "-0.0", "nan"])
def test_numbers_beyond_the_ordinary(value: str) -> None:
    load_or_refuse(f"[film]\nwidth = {value}")
    load_or_refuse(f"[camera]\nposition = [{value}, 0, 0]\nlook_at = [0, 0, 0]\nfov_deg = {value}")
