"""Every kind of mistake in a file: its path as written, the value, and what is allowed."""

from collections.abc import Callable

import pytest

from scenes import Problem

Load = Callable[[str], dict[str, Problem]]

SPHERE = """
[[objects]]
shape = {{ type = "sphere", position = [0, 0, 0], radius = 1 {extra} }}
material = {{ type = "dielectric", medium = {medium} }}
"""


def test_all_problems_are_reported_at_once_with_the_paths_of_the_file(problems: Load) -> None:
    found = problems("""
        titel = "x"
        [film]
        width = 0
        [camera]
        position = [0, 0, "high"]
        look_at = [0, 0]
        fov_deg = 180
        [[objects]]
        shape = { type = "sphere", position = [0, 0, 0], raduis = 1 }
        material = { type = "dielectric", medium = "BK9" }
        [[objects]]
        shape = { type = "box", position = [0, inf, 0], size = [1, -1, 1] }
        material = { type = "lambertian", reflectance = 1.5 }
        [[emitters]]
        type = "beem"
        [[emitters]]
        type = "point"
        position = [0, 0, 0]
        flux = nan
        spectrum = "D66"
    """)
    assert list(found) == [
        "film.width",
        "camera.position[2]",
        "camera.look_at",
        "camera.fov_deg",
        "objects[0].shape.radius",
        "objects[0].shape.raduis",
        "objects[0].material.medium",
        "objects[1].shape.position[1]",
        "objects[1].shape.size[1]",
        "objects[1].material.reflectance",
        "emitters[0].type",
        "emitters[1].spectrum",
        "emitters[1].flux",
        "titel",
    ]
    assert found["film.width"].value == 0
    assert found["film.width"].allowed == "at least 1"
    assert found["camera.look_at"].message == "must be an array of 3 numbers, is [0, 0]"
    assert found["titel"].message.startswith("unknown key 'titel'; did you mean 'title'? allowed: ")


def test_an_unknown_key_names_the_nearest_and_all_valid_ones(problems: Load) -> None:
    found = problems(SPHERE.format(extra=", raduis = 2", medium='"N-BK7"'))
    assert str(found["objects[0].shape.raduis"]) == (
        "objects[0].shape.raduis: unknown key 'raduis'; did you mean 'radius'?"
        " allowed: position, radius, type"
    )


def test_an_unknown_glass_names_the_nearest(problems: Load) -> None:
    line = str(problems(SPHERE.format(extra="", medium='"BK9"'))["objects[0].material.medium"])
    assert line.startswith("objects[0].material.medium: unknown glass 'BK9'; nearest: N-BK7")


def test_an_unknown_type_names_the_nearest(problems: Load) -> None:
    found = problems(SPHERE.format(extra="", medium='{ type = "sellmaier" }'))
    assert found["objects[0].material.medium.type"].message == (
        "unknown type 'sellmaier'; did you mean 'sellmeier'?"
        " allowed: cauchy, constant, sellmeier, table"
    )


def test_a_missing_type_lists_all(problems: Load) -> None:
    found = problems("[[objects]]\nshape = {}\nmaterial = { type = 3 }")
    assert found["objects[0].shape.type"].message.startswith("missing; required, one of: box, disk")
    assert found["objects[0].material.type"].message.startswith("unknown type 3; allowed: absorber")


@pytest.mark.parametrize(
    ("text", "path", "message"),
    [
        ("objects = 3", "objects", "must be an array, is 3"),
        ("objects = [3]", "objects[0]", "must be a table with the keys material, name, "),
        ("film = []", "film", "must be a table with the keys "),
        ("title = 3", "title", "must be a string, is 3"),
        ("[film]\nwidth = 1.0", "film.width", "must be an integer, is 1.0"),
        ("[film]\nwidth = 20000", "film.width", "must be at most 16384, is 20000"),
        ("[film]\nwidth = true", "film.width", "must be an integer, is True"),
        ("[film]\nfirst_nm = '400'", "film.first_nm", "must be a number, is '400'"),
        ("length_unit = 'cm'", "length_unit", "must be 'm' or 'mm', is 'cm'"),
        ("[render]\nphotons = 0", "render.photons", "must be greater than 0, is 0"),
        ("'odd key' = 1", "'odd key'", "unknown key 'odd key'; allowed: ambient, camera"),
        ("[camera]", "camera.fov_deg", "missing; required: vertical field of view"),
        (
            "[[objects]]\nshape = 3\nmaterial = 'glass'",
            "objects[0].shape",
            'must be a table with a key "type", one of: box, disk, heightfield, ',
        ),
        (
            SPHERE.format(extra="", medium="[1]"),
            "objects[0].material.medium",
            'must be a string, or a table with a key "type", one of: cauchy, constant, ',
        ),
        (
            SPHERE.format(extra="", medium='{ type = "cauchy", range_nm = [400, 700], a = [] }'),
            "objects[0].material.medium.a",
            "must be an array of at least 1 elements, is []",
        ),
        (
            "[camera]\nposition = [1, 2, 3, 4]",
            "camera.position",
            "must be an array of 3 numbers, is [1, 2, 3, 4]",
        ),
        (
            '[[objects]]\nshape = { type = "polyhedron", vertices = [[0, 0], [1]] }',
            "objects[0].shape.vertices[0]",
            "must be an array of 3 numbers, is [0, 0]",
        ),
    ],
)
def test_what_is_allowed_is_said_in_the_terms_of_toml(
    problems: Load, text: str, path: str, message: str
) -> None:
    assert problems(text)[path].message.startswith(message)
