"""Grids of heights, and the triangles over them."""

import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationInfo

from scenes.budget import charge
from scenes.fields import MAX_LENGTH_M, length_text
from scenes.file_content import file_content
from scenes.shapes.surface import Surface

__all__ = ["HeightGrid", "grid_surface", "read_heights"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_MAX_BYTES = 64 * 1024 * 1024


@dataclass(frozen=True, eq=False)
class HeightGrid:
    """Heights at the corners of a grid's cells.

    Attributes:
        heights: (rows along z, columns along x) [m].
        slopes: of the heights along x and along z, each of the same shape; None: not known.
    """

    heights: FloatArray
    slopes: tuple[FloatArray, FloatArray] | None = None


def read_heights(path: Path, info: ValidationInfo, *, unit: float, largest: int) -> HeightGrid:
    """The heights in a file.

    Args:
        path: of a .npy file, or of text: numbers in rows, parted by blanks or commas.
        info: of the validation, which keeps the budget.
        unit: of the file's numbers [m].
        largest: how many numbers a side may have.

    Raises:
        ValueError: it holds no such grid; says why.
    """
    content = file_content(path, _MAX_BYTES)
    charge(info, "bytes of other files", len(content), "file")
    is_array = path.suffix.lower() == ".npy"
    table = _array(content, largest) if is_array else _rows(content, largest)
    if table.ndim != 2 or not all(2 <= side <= largest for side in table.shape):
        raise ValueError(f"it holds an array of shape {table.shape}")
    heights = table * unit
    if not (np.abs(heights) <= MAX_LENGTH_M).all():
        limit = length_text(MAX_LENGTH_M, info)
        raise ValueError(f"its heights must be numbers of at most {limit}")
    return HeightGrid(heights)


def _array(content: bytes, largest: int) -> FloatArray:
    """What a .npy file holds, as its header says, which is read before any memory is taken."""
    file = io.BytesIO(content)
    try:
        version = np.lib.format.read_magic(file)
        read_header = np.lib.format.read_array_header_1_0
        if version != (1, 0):
            read_header = np.lib.format.read_array_header_2_0
        shape, columns_first, kind = read_header(file)
    except Exception as error:  # a damaged header ends in any of Python's exceptions
        raise ValueError(f"it is no .npy file: {error}") from None
    if kind.kind not in "fiub":
        raise ValueError(f"it holds no real numbers, but {kind}")
    if len(shape) != 2 or not all(2 <= side <= largest for side in shape):
        raise ValueError(f"it holds an array of shape {shape}")
    data = content[file.tell() :]
    count = shape[0] * shape[1]
    if len(data) < count * kind.itemsize:
        raise ValueError("it is cut off")
    numbers = np.frombuffer(data, dtype=kind, count=count).astype(np.float64)
    return numbers.reshape(shape, order="F" if columns_first else "C")


def _rows(content: bytes, largest: int) -> FloatArray:
    """A table of text; no more of it than may be is taken apart."""
    rows: list[list[float]] = []
    for line in content.decode("utf-8").splitlines():
        words = line.replace(",", " ").split(maxsplit=largest + 1)
        if not words:
            continue
        if len(words) > largest or len(rows) == largest:
            raise ValueError(f"it has more than {largest} numbers a side")
        rows.append([float(word) for word in words])
        if len(rows[-1]) != len(rows[0]):
            raise ValueError("its rows differ in length")
    return np.array(rows)


def grid_surface(grid: HeightGrid, size: tuple[float, float], depth: float | None) -> Surface:
    """The triangles over a grid, smooth on top; closed by sides and a bottom if it has a depth.

    Args:
        grid: the heights.
        size: of the rectangle along x and z, about the origin [m].
        depth: of the bottom [m]; None: there is none.
    """
    rows, columns = grid.heights.shape
    x = np.linspace(-0.5 * size[0], 0.5 * size[0], columns)
    z = np.linspace(-0.5 * size[1], 0.5 * size[1], rows)
    top = np.stack(
        [np.tile(x, rows), grid.heights.ravel(), np.repeat(z, columns)], axis=1
    )
    numbers = np.arange(rows * columns).reshape(rows, columns)
    a, b = numbers[:-1, :-1].ravel(), numbers[:-1, 1:].ravel()
    c, d = numbers[1:, 1:].ravel(), numbers[1:, :-1].ravel()
    triangles = np.concatenate([np.stack([a, d, c], axis=1), np.stack([a, c, b], axis=1)])
    smooth = _normals(grid, x, z)[triangles]
    if depth is None:
        return Surface(top, triangles, smooth)
    vertices, rest = _walls(top, numbers, triangles, depth)
    closed = Surface(vertices, np.concatenate([triangles, rest]))
    flat = np.repeat(closed.facet_normals[len(triangles) :, None, :], 3, axis=1)
    return Surface(vertices, closed.triangles, np.concatenate([smooth, flat]))


def _normals(grid: HeightGrid, x: FloatArray, z: FloatArray) -> FloatArray:
    """(rows * columns, 3) unit normals at a grid's corners, by central differences if need be."""
    if grid.slopes is not None:
        along_x, along_z = grid.slopes
    else:
        along_z, along_x = _slope(grid.heights, z), _slope(grid.heights.T, x).T
    normals = np.stack([-along_x, np.ones_like(along_x), -along_z], axis=-1).reshape(-1, 3)
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def _slope(heights: FloatArray, places: FloatArray) -> FloatArray:
    """Of heights along the first axis: by central differences, at the ends by one-sided ones."""
    spacing = float(places[1] - places[0])
    if len(places) < 3:
        return np.gradient(heights, spacing, axis=0)
    return np.gradient(heights, spacing, axis=0, edge_order=2)


def _walls(
    top: FloatArray, numbers: IntArray, triangles: IntArray, depth: float
) -> tuple[FloatArray, IntArray]:
    """All the vertices, and the triangles of the sides and of a bottom cut up as the top is.

    A bottom of few triangles would be of long ones, which a tree of boxes finds hard to part.
    """
    around = np.concatenate(  # from corner to corner, as a right hand turns about -y
        [numbers[0, :-1], numbers[:-1, -1], numbers[-1, :0:-1], numbers[:0:-1, 0]]
    )
    bottom = top * [1.0, 0.0, 1.0] - [0.0, depth, 0.0]
    ahead, count = np.roll(around, -1), len(top)
    sides = [around, ahead, ahead + count], [around, ahead + count, around + count]
    walls = [np.stack(side, axis=1) for side in sides]
    return np.concatenate([top, bottom]), np.concatenate([*walls, triangles[:, ::-1] + count])
