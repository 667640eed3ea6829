"""Units: a file in millimetres is the same scene as the file in metres."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest

import scenes

Load = Callable[[str], dict[str, scenes.Problem]]

EVERYTHING = """
[film]
width = 8
height = 8
[camera]
position = [1, 2, 3]
look_at = [0, 0, 1]
up = [0, 3, 4]
fov_deg = 40
aperture_radius = 3
focus_distance = 20
sensor_height = 30
[render]
radius = 0.25
photons = 10
[[objects]]
shape = { type = "sphere", position = [1, 2, 3], radius = 4 }
material = { type = "dielectric", medium = "N-BK7" }
[[objects]]
shape = { type = "plane", position = [1, 2, 3], normal = [0, 1, 0] }
material = { type = "lambertian", reflectance = 0.5 }
[[objects]]
shape = { type = "rectangle", position = [1, 2.5, 3], size = [4, 5], up = [1, 0, 0] }
material = { type = "absorber" }
[[objects]]
shape = { type = "disk", position = [1, 2.25, 3], radius = 4, normal = [0, 1, 0] }
material = { type = "absorber" }
[[objects]]
shape = { type = "box", position = [1, 2, 3], size = [4, 5, 6], rotation_deg = [10, 20, 30] }
material = { type = "absorber" }
[[objects]]
shape = { type = "prism", position = [1, 2, 3], apex_deg = 60, base = 4, length = 5, height = 2 }
material = { type = "absorber" }
[[objects]]
material = { type = "absorber" }
[objects.shape]
type = "polyhedron"
position = [1, 2, 3]
vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
[[objects]]
material = { type = "absorber" }
[objects.shape]
type = "lens"
position = [1, 2, 3]
thickness = 1
aperture = 4
first = { radius = 5, conic = -0.5 }
second = { curvature = -0.25 }
[[objects]]
material = { type = "absorber" }
[objects.shape]
type = "heightfield"
position = [1, 2, 3]
size = [4, 5]
depth = 3
waves = [{ amplitude = 1, period = 2, direction_deg = 30 }]
cells = [2, 2]
[[objects]]
material = { type = "absorber" }
[objects.shape]
type = "heightfield"
position = [1, 2, 3]
size = [4, 5]
heights = [[0, 1], [2, 3]]
[[emitters]]
type = "beam"
flux = 2
spectrum = { type = "laser", wavelength_nm = 532 }
position = [1, 2, 3]
direction = [1, 0, 0]
profile = { type = "round", radius = 4 }
divergence_deg = 1
[[emitters]]
type = "beam"
flux = 2
spectrum = "D65"
position = [1, 2, 3]
direction = [1, 0, 0]
profile = { type = "slit", width = 4, height = 5 }
[[emitters]]
type = "point"
flux = 2
spectrum = "D65"
position = [1, 2, 3]
[[emitters]]
type = "spot"
flux = 2
spectrum = "D65"
position = [1, 2, 3]
direction = [1, 0, 0]
half_angle_deg = 5
[[emitters]]
type = "sphere"
flux = 2
spectrum = "D65"
position = [1, 2, 3]
radius = 4
[[emitters]]
type = "rectangle"
flux = 2
spectrum = "D65"
position = [1, 2, 3]
size = [4, 5]
[[emitters]]
type = "sun"
direction = [1, 0, 0]
irradiance = 2
spectrum = "D65"
[[emitters]]
type = "environment"
radiance = 2
spectrum = "D65"
"""

LENGTHS = {
    "position", "look_at", "radius", "size", "base", "length", "thickness", "aperture",
    "aperture_radius", "focus_distance", "sensor_height",
}  # fmt: skip
LENGTHS_OF = {"prism": {"height"}, "slit": {"width", "height"}, "polyhedron": {"vertices"},
              "heightfield": {"unit"}}  # fmt: skip
LENGTHS |= {"amplitude", "period", "depth", "heights"}
IN_FILES = {"file", "unit"}
"""Lengths that stand in files of their own, and the length of these files' unit."""


def leaves(value: Any, path: str = "", kind: str = "", key: str = "") -> Iterator[tuple[Any, ...]]:
    """Every number and text of a dump: its path, the `type` of its table, its key, itself."""
    if isinstance(value, dict):
        for name, entry in value.items():
            yield from leaves(entry, f"{path}.{name}", value.get("type", ""), name)
    elif isinstance(value, tuple | list):
        for index, entry in enumerate(value):
            yield from leaves(entry, f"{path}[{index}]", kind, key)
    else:
        yield path, kind, key, value


@pytest.mark.filterwarnings("ignore::scenes.SceneWarning")  # of sizes that are made up
def test_every_length_is_scaled_and_nothing_else() -> None:
    in_m = list(leaves(scenes.loads(EVERYTHING).model_dump()))
    in_mm = list(leaves(scenes.loads('length_unit = "mm"\n' + EVERYTHING).model_dump()))
    for (path, kind, key, value), (other_path, _, _, other) in zip(in_m, in_mm, strict=True):
        assert path == other_path
        if value is None:
            assert other is None, path
        elif key in LENGTHS or key in LENGTHS_OF.get(kind, set()):
            assert other == pytest.approx(value / 1000.0, rel=1e-15), path
        elif key == "curvature":
            assert other == pytest.approx(value * 1000.0, rel=1e-15), path
        else:
            assert other == value, path


def test_every_field_called_a_length_is_among_the_scaled_ones() -> None:
    described = {
        key
        for model in [scenes.schema(), *scenes.schema()["$defs"].values()]
        for key, field in model["properties"].items()
        if "(length" in field["description"]
    }
    assert described == LENGTHS | IN_FILES | set().union(*LENGTHS_OF.values())


def test_millimetres_become_the_nearest_metres() -> None:
    # A product with 0.001 would give 0.012699999999999999.
    scene = scenes.loads(
        'length_unit = "mm"\n[[objects]]\nmaterial = { type = "absorber" }\n'
        'shape = { type = "sphere", position = [0, 0, 0], radius = 12.7 }'
    )
    shape = scene.objects[0].shape
    assert isinstance(shape, scenes.Sphere)
    assert shape.radius == 0.0127
    assert scene.length_unit == "m"


def test_models_in_python_are_in_metres() -> None:
    with pytest.raises(scenes.SceneError, match=r"length_unit: must be 'm': only files"):
        scenes.Scene(length_unit="mm")


@pytest.mark.parametrize("given", [(0.0, 0.0, 2.0), (0.0, 0.0, 1e-300), (0.0, 0.0, 1e308)])
def test_directions_are_normalised_without_overflow(given: tuple[float, float, float]) -> None:
    plane = scenes.Plane(position=(0.0, 0.0, 0.0), normal=given)
    assert plane.normal == (0.0, 0.0, 1.0)


def test_a_unit_vector_stays_bit_for_bit_the_same() -> None:
    once = scenes.Plane(position=(0.0, 0.0, 0.0), normal=(1.0, 2.0, 3.0))
    again = scenes.Plane(position=(0.0, 0.0, 0.0), normal=once.normal)
    assert again.normal == once.normal


@pytest.mark.parametrize(
    ("line", "path", "message"),
    [
        ("normal = [0, 0, 0]", "normal", "must not be the zero vector"),
        ("position = [0, 2e12, 0]", "position[1]", "must be at most 1e+12 mm from the origin"),
        ("size = [1e-7, 1]", "size[0]", "must be between 1e-06 mm and 1e+12 mm, is 1e-07"),
        ("size = [nan, 1]", "size[0]", "must be a finite number, is nan"),
        ("size = [-1, 1]", "size[0]", "must be greater than 0, is -1"),
    ],
)
def test_lengths_and_directions_out_of_bounds(
    problems: Load, line: str, path: str, message: str
) -> None:
    keys = {"type": '"rectangle"', "position": "[0, 0, 0]", "size": "[1, 1]"}
    key, _, value = line.partition(" = ")
    table = ", ".join(f"{name} = {entry}" for name, entry in {**keys, key: value}.items())
    text = f'length_unit = "mm"\n[[objects]]\nshape = {{ {table} }}\nmaterial.type = "absorber"'
    assert problems(text)[f"objects[0].shape.{path}"].message.startswith(message)


def test_a_wavelength_in_micrometres_is_recognised(problems: Load) -> None:
    message = problems("[film]\nfirst_nm = 0.4")["film.first_nm"].message
    looks = "0.4 looks like micrometres; did you mean 400 nm?"
    assert message == f"must be 10 to 1e+06 nm, is 0.4 ({looks})"
