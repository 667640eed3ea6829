from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import scenes
from scenes import Mask, SceneError

BEAM = """
[[emitters]]
type = "rectangle"
flux = 1.0
spectrum = "E"
position = [0.0, 0.0, 0.0]
size = [1.0, 1.0]
mask = { file = "NAME" }
"""


def load(folder: Path, name: str) -> Mask:
    (folder / "scene.toml").write_text(BEAM.replace("NAME", name), encoding="utf-8")
    emitter = scenes.load(folder / "scene.toml").emitters[0]
    assert isinstance(emitter, scenes.RectangleLamp)
    assert emitter.mask is not None
    return emitter.mask


def test_values_are_rows_from_the_top() -> None:
    cells = Mask(values=((0.0, 1.0), (0.5, 0.25))).cells()
    np.testing.assert_array_equal(cells, [[0.0, 1.0], [0.5, 0.25]])


@pytest.mark.parametrize(("mode", "white"), [("L", 255), ("I;16", 65535)])
def test_an_image_beside_the_scene_is_read(tmp_path: Path, mode: str, white: int) -> None:
    levels = np.array([[0, white], [white // 2, 51]])
    kind = np.uint8 if mode == "L" else np.uint16
    Image.fromarray(levels.astype(kind)).save(tmp_path / "mask.png")
    np.testing.assert_allclose(load(tmp_path, "mask.png").cells(), levels / white, rtol=1e-12)


def test_a_colour_image_is_taken_grey(tmp_path: Path) -> None:
    Image.new("RGB", (3, 2), (255, 255, 255)).save(tmp_path / "mask.png")
    np.testing.assert_array_equal(load(tmp_path, "mask.png").cells(), np.ones((2, 3)))


def test_an_image_outside_the_scenes_folder(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    Image.new("L", (2, 2), 255).save(tmp_path / "mask.png")
    with pytest.raises(SceneError, match=r"mask\.file: must be a path relative to the scene's"):
        load(tmp_path / "inside", "../mask.png")


def test_an_image_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "mask.png").write_bytes(b"not an image")
    with pytest.raises(SceneError, match=r"mask\.file: 'mask.png' cannot be read"):
        load(tmp_path, "mask.png")
    Image.new("L", (2049, 1), 255).save(tmp_path / "wide.png")
    with pytest.raises(SceneError, match=r"at most 2048 pixels a side; 'wide.png' has 2049"):
        load(tmp_path, "wide.png")


@pytest.mark.parametrize(
    ("fields", "problem"),
    [
        ({}, "must have values or file"),
        ({"values": ((1.0,),), "file": "a.png"}, "must have values or file"),
        ({"values": ((0.0, 0.0),)}, "values: must have at least one cell that lets light through"),
        ({"values": ((0.0, 1.0), (1.0,))}, "values: must be rows of the same length"),
        ({"values": ((1.5,),)}, "values.*must be"),
        ({"values": ()}, "values"),
        ({"file": "no such file.png"}, "file: there is no file"),
    ],
)
def test_a_mask_that_cannot_be(fields: dict[str, object], problem: str) -> None:
    with pytest.raises(SceneError, match=problem):
        Mask(**fields)
