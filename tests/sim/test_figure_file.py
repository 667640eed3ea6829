"""Figures as files: whole, in the format of their ending, and the same each time."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from sim.errors import OutputError
from sim.figure_file import save_figure


def figure():
    made = Figure(figsize=(2.0, 1.0), dpi=100, facecolor="black")
    made.add_subplot().plot([1, 2], [3, 4], label="a line")
    return made


def test_png(tmp_path):
    save_figure(figure(), tmp_path / "out.PNG")
    with Image.open(tmp_path / "out.PNG") as image:
        assert image.size == (200, 100)
        assert np.asarray(image)[0, 0, :3].tolist() == [0, 0, 0]


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_equal_figures_give_equal_files(tmp_path, suffix):
    for name in ("one", "two"):
        save_figure(figure(), tmp_path / f"{name}.{suffix}")
    assert (tmp_path / f"one.{suffix}").read_bytes() == (tmp_path / f"two.{suffix}").read_bytes()


def test_a_missing_folder_is_told(tmp_path):
    with pytest.raises(OutputError, match="there is no folder"):
        save_figure(figure(), tmp_path / "missing" / "out.svg")
