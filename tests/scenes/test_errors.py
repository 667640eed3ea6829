import pickle

import pytest

import scenes
from scenes import Problem, SceneError
from scenes.errors import nearest_names, shown


def test_the_message_has_a_header_and_a_line_for_each_problem() -> None:
    error = SceneError(
        "bench.toml",
        [Problem("objects[0].shape.radius", "must be greater than 0, is -1"), Problem("", "odd")],
    )
    assert str(error).splitlines() == [
        "bench.toml: 2 problems",
        "  objects[0].shape.radius: must be greater than 0, is -1",
        "  odd",
    ]


def test_it_is_a_value_error_and_survives_pickling() -> None:
    error = SceneError("bench.toml", [Problem("camera", "missing", None, "a table")])
    assert isinstance(error, ValueError)
    copy = pickle.loads(pickle.dumps(error))
    assert str(copy) == str(error)
    assert copy.problems == error.problems


def test_a_source_that_cannot_be_printed_is_escaped() -> None:
    assert str(SceneError("a\nb", [])).startswith(r"'a\nb': 0 problems")


def test_a_problem_below_a_parent_has_the_parents_path_first() -> None:
    assert Problem("up", "x").below("camera").path == "camera.up"
    assert Problem("[2]", "x").below("objects").path == "objects[2]"
    assert Problem("", "x").below("camera").path == "camera"
    assert Problem("up", "x").below("").path == "up"


def test_models_built_in_python_raise_the_same_exception() -> None:
    with pytest.raises(SceneError) as caught:
        scenes.Sphere(position=(0.0, float("nan"), 0.0), radius=-1.0)
    assert [problem.path for problem in caught.value.problems] == ["position[1]", "radius"]
    assert str(caught.value).startswith("Sphere: 2 problems")


def test_nested_models_built_at_once_give_one_list_with_full_paths() -> None:
    with pytest.raises(SceneError) as caught:
        scenes.SceneObject(
            shape={"type": "sphere", "position": (0, 0, 0), "radius": 0},
            material={"type": "lambertian", "reflectance": 2},
        )
    assert [problem.path for problem in caught.value.problems] == [
        "shape.radius",
        "material.reflectance",
    ]


def test_nearest_names_ignore_letter_case() -> None:
    assert nearest_names("PRISM", ["prism", "lens"]) == ["prism"]
    assert nearest_names("zzz", ["prism", "lens"]) == []


def test_any_value_can_be_shown() -> None:
    assert shown(16**5000) == "a huge number"
    assert len(shown("x" * 1000)) < 100
