"""Files that a scene names: beside it, and nowhere else."""

import os

import pytest

import scenes

MESH = """
[[objects]]
shape = {{ type = "mesh", position = [0, 0, 0], file = "{}" }}
material = {{ type = "absorber" }}
"""
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture
def folder(tmp_path):
    inside = tmp_path / "scenes"
    (inside / "parts").mkdir(parents=True)
    for path in (tmp_path / "outside.obj", inside / "one.obj", inside / "parts" / "two.obj"):
        path.write_text(TRIANGLE)
    return inside


def load(folder, file):
    path = folder / "bench.toml"
    path.write_text(MESH.format(file))
    return scenes.load(path)


@pytest.mark.parametrize("file", ["one.obj", "parts/two.obj", "parts/../one.obj", "./one.obj"])
def test_files_are_found_beside_the_scene(folder, file) -> None:
    shape = load(folder, file).objects[0].shape
    assert len(shape.local_surface().triangles) == 1


@pytest.mark.parametrize("up", ["../outside.obj", "parts/../../outside.obj"])
def test_no_path_climbs_out(folder, up) -> None:
    with pytest.raises(scenes.SceneError, match=r"relative to the scene's folder") as caught:
        load(folder, up)
    assert caught.value.problems[0].path == "objects[0].shape.file"


def test_no_path_is_absolute(folder) -> None:
    with pytest.raises(scenes.SceneError, match=r"relative to the scene's folder"):
        load(folder, (folder / "one.obj").as_posix())


def test_no_link_leads_out(folder) -> None:
    os.symlink(folder.parent / "outside.obj", folder / "link.obj")
    with pytest.raises(scenes.SceneError, match=r"relative to the scene's folder"):
        load(folder, "link.obj")


@pytest.mark.parametrize("outside", [False, True])
def test_a_link_to_itself_is_no_file(folder, outside) -> None:
    os.symlink("loop.obj", folder / "loop.obj")
    (folder / "bench.toml").write_text(MESH.format("loop.obj"))
    with pytest.raises(scenes.SceneError) as caught:
        scenes.load(folder / "bench.toml", allow_outside=outside)
    (problem,) = caught.value.problems
    assert problem.path == "objects[0].shape.file"
    assert "'loop.obj'" in problem.message


@pytest.mark.parametrize("file", ["three.obj", "parts", "", "a\\u0000b", "x" * 5000])
def test_what_is_no_file_is_said(folder, file) -> None:
    with pytest.raises(scenes.SceneError) as caught:
        load(folder, file)
    assert caught.value.problems[0].path == "objects[0].shape.file"


def test_a_text_without_a_file_looks_in_the_folder_it_is_given(folder) -> None:
    scene = scenes.loads(MESH.format("one.obj"), folder=folder)
    assert scene.objects[0].shape.type == "mesh"
    with pytest.raises(scenes.SceneError, match="there is no file"):
        scenes.loads(MESH.format("one.obj"))


def test_a_model_built_in_python_may_name_any_file(folder) -> None:
    shape = scenes.Mesh(position=(0, 0, 0), file=str(folder.parent / "outside.obj"))
    assert len(shape.local_surface().triangles) == 1


def test_a_name_without_end_is_not_told_in_full(tmp_path) -> None:
    text = """
    [[objects]]
    shape = {{ type = "mesh", position = [0, 0, 0], file = "{}.ply" }}
    material = {{ type = "absorber" }}
    """
    with pytest.raises(scenes.SceneError, match="cannot be a path") as caught:
        scenes.loads(text.format("x" * 5000), folder=tmp_path)
    assert max(len(one.message) for one in caught.value.problems) < 500
