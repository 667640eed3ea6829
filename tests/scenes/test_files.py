from pathlib import Path
from typing import Any

import pytest

import scenes
from scenes import SceneError

VALID = 'title = "ähnlich"\n'


def test_a_file_is_read_by_its_path(tmp_path: Path) -> None:
    path = tmp_path / "bench.toml"
    path.write_text(VALID, encoding="utf-8")
    for given in (path, str(path)):
        scene = scenes.load(given)
        assert (scene.title, scene.source_name, scene.source_text) == ("ähnlich", "bench", VALID)


def test_a_byte_order_mark_and_windows_lines_are_read(tmp_path: Path) -> None:
    path = tmp_path / "bench.toml"
    path.write_bytes(b"\xef\xbb\xbf" + VALID.replace("\n", "\r\n").encode())
    assert scenes.load(path).title == "ähnlich"


def test_errors_name_the_file(tmp_path: Path) -> None:
    path = tmp_path / "bench.toml"
    path.write_text("titel = 1", encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        scenes.load(path)
    assert str(caught.value).startswith(f"{path}: 1 problem\n  titel: unknown key 'titel'")


def test_an_unknown_scene_lists_the_nearest_and_all() -> None:
    with pytest.raises(SceneError) as caught:
        scenes.load("prsm")
    assert "unknown scene 'prsm'; nearest: prism" in str(caught.value)
    assert ", ".join(scenes.gallery()) in str(caught.value)
    with pytest.raises(SceneError, match="unknown scene 'prsm'"):
        scenes.gallery_path("prsm")


@pytest.mark.parametrize("name", ["", ".", "nowhere/at/all.toml", "bench.toml", "a\0b", "x" * 5000])
def test_files_that_are_not_there(name: str, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SceneError, match=r"cannot be read|unknown scene"):
        scenes.load(name)


def test_a_folder_is_no_scene(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="cannot be read: Is a directory"):
        scenes.load(tmp_path)


def test_a_binary_file_is_no_scene(tmp_path: Path) -> None:
    path = tmp_path / "picture.toml"
    path.write_bytes(b"\x76\x2f\x31\x01\xff\xfe")
    with pytest.raises(SceneError, match="cannot be read: it is not UTF-8 text: byte 0xff at 4"):
        scenes.load(path)


@pytest.mark.parametrize(
    "text",
    [
        "title =",
        "title = 1\ntitle = 2",
        "a = " + "[" * 100_000,
        "width = " + "9" * 5000,
        "\0",
    ],
)
def test_text_that_is_not_toml(text: str) -> None:
    with pytest.raises(SceneError, match="<string>: 1 problem\n  not TOML: "):
        scenes.loads(text)


def test_syntax_errors_say_where() -> None:
    with pytest.raises(SceneError, match="line 2, column 11"):
        scenes.loads("title = 'x'\nfilm = [ ]]\n")


def test_the_gallery_holds_the_scenes_of_the_project() -> None:
    assert set(scenes.gallery()) >= {"ball", "lens", "prism"}
    assert list(scenes.gallery()) == sorted(scenes.gallery())


def test_a_gallery_scene_carries_its_name_and_text() -> None:
    scene = scenes.load("prism")
    assert scene.source_name == "prism"
    assert scene.source_text == scenes.gallery_path("prism").read_text(encoding="utf-8")
