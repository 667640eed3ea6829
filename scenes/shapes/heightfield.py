"""The height field: water with waves, a rippled sheet, a relief."""

from functools import lru_cache
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from scenes.budget import charge
from scenes.errors import Problem, reason_of, refusal, shown
from scenes.fields import Coordinate, Degrees, Size, length_text
from scenes.model import SceneModel
from scenes.nearby_files import nearby_file
from scenes.shapes.height_grid import HeightGrid, grid_surface, read_heights
from scenes.shapes.surface import Surface
from scenes.shapes.triangulated import Triangulated

__all__ = ["HeightField", "Wave"]

_MAX_CELLS = 1000

FloatArray = NDArray[np.float64]

_Row = Annotated[
    tuple[Coordinate, ...], Field(min_length=2, max_length=_MAX_CELLS + 1, fail_fast=True)
]
_Rows = Annotated[tuple[_Row, ...], Field(min_length=2, max_length=_MAX_CELLS + 1, fail_fast=True)]
_Cells = Annotated[int, Field(strict=True, ge=1, le=_MAX_CELLS)]


class Wave(SceneModel):
    """A sine wave: height = amplitude · sin(2π s / period + phase), s along its direction."""

    amplitude: Size = Field(description="greatest height (length)")
    period: Size = Field(description="distance from crest to crest (length)")
    direction_deg: Degrees = Field(
        default=0.0, description="direction it runs in, from +x toward +z [deg]"
    )
    phase_deg: Degrees = Field(default=0.0, description="phase at the local origin [deg]")


class HeightField(Triangulated):
    """Heights over a rectangle: an open sheet, or with a depth the solid below it.

    The local y axis is up; heights are along it, over a grid of `size` along x and z about the
    local origin.
    """

    type: Literal["heightfield"] = Field(
        default="heightfield", description="heights over a rectangle: water, a relief"
    )
    size: tuple[Size, Size] = Field(description="[along x, along z] (lengths)")
    heights: _Rows | None = Field(
        default=None,
        description="rows of heights (lengths), the rows from -z to +z, each from -x to +x",
    )
    file: str | None = Field(
        default=None,
        description="in place of heights, a file of them (lengths): .npy, or a table of text",
    )
    unit: Size = Field(
        default=1.0, validate_default=True,
        description="length of the file's unit (length); the scene file's if not given",
    )  # fmt: skip
    waves: Annotated[tuple[Wave, ...], Field(min_length=1, max_length=100)] | None = Field(
        default=None, description="in place of heights, waves that add up"
    )
    cells: tuple[_Cells, _Cells] = Field(
        default=(200, 200), description="[along x, along z] into which waves are cut, 1 to 1000"
    )
    depth: Size | None = Field(
        default=None,
        description="of the flat bottom below the local origin (length); makes it a solid",
    )

    _read: HeightGrid | None = PrivateAttr(default=None)

    def local_surface(self) -> Surface:
        """The triangles in the local frame, smooth on top."""
        return _surface(self.grid(), self.size, self.depth)

    def grid(self) -> HeightGrid:
        """Heights, and slopes where they are known."""
        if self.waves is not None:
            return _wavy(self.waves, self.size, self.cells)
        if self._read is not None:
            return self._read
        assert self.heights is not None  # the validator below has made sure
        return HeightGrid(np.array(self.heights))

    def _draw_on_budget(self, info: ValidationInfo) -> None:
        """Make sure that there is room for the samples and the triangles, before they are made."""
        along_x, along_z = self.cells
        if self.waves is not None:
            samples = (along_x + 1) * (along_z + 1) * len(self.waves)
            charge(info, "samples of waves", samples, "waves")
        else:
            rows, columns = self.grid().heights.shape
            along_x, along_z = columns - 1, rows - 1
        faces = 2 * along_x * along_z
        walls = 0 if self.depth is None else faces + 4 * (along_x + along_z)
        field = "cells" if self.waves is not None else "file" if self.file else "heights"
        charge(info, "triangles", faces + walls, field)

    def _from_file(self, name: str, info: ValidationInfo) -> HeightGrid:
        path = nearby_file(name, info)
        try:
            return read_heights(path, info, unit=self.unit, largest=_MAX_CELLS + 1)
        except PydanticCustomError:  # is a ValueError too
            raise
        except (OSError, ValueError) as error:
            allowed = f"a grid of 2 to {_MAX_CELLS + 1} numbers a side, as .npy or as text"
            message = f"{shown(name)} cannot be used: {reason_of(error)}; allowed: {allowed}"
            raise refusal(Problem("file", message, name, allowed)) from None

    @model_validator(mode="after")
    def _has_heights(self, info: ValidationInfo) -> Self:
        given = [name for name in ("heights", "file", "waves") if getattr(self, name) is not None]
        if len(given) != 1:
            allowed = "exactly one of heights, file and waves"
            message = f"{allowed} must be given, not {' and '.join(given) or 'none'}"
            raise refusal(Problem("heights", message, None, allowed))
        if self.heights is not None and len({len(row) for row in self.heights}) != 1:
            allowed = "rows of equal length"
            raise refusal(Problem("heights", f"must be {allowed}", None, allowed))
        if self.file is not None:
            self._read = self._from_file(self.file, info)
        self._draw_on_budget(info)
        lowest = float(self.grid().heights.min())
        if self.depth is not None and lowest <= -self.depth:
            allowed = f"more than {length_text(-lowest, info)}, below the lowest height"
            message = f"must be {allowed}; is {length_text(self.depth, info)}"
            raise refusal(Problem("depth", message, self.depth, allowed))
        return self


@lru_cache(maxsize=16)
def _wavy(
    waves: tuple[Wave, ...], size: tuple[float, float], cells: tuple[int, int]
) -> HeightGrid:
    """Heights and slopes of a sum of waves at a grid's corners."""
    x = np.linspace(-0.5 * size[0], 0.5 * size[0], cells[0] + 1)
    z = np.linspace(-0.5 * size[1], 0.5 * size[1], cells[1] + 1)
    height, slope_x, slope_z = (np.zeros((len(z), len(x))) for _ in range(3))
    for wave in waves:
        angle = np.radians(wave.direction_deg)
        along_x, along_z = np.cos(angle), np.sin(angle)
        number = 2.0 * np.pi / wave.period
        phase = number * (x * along_x + z[:, None] * along_z) + np.radians(wave.phase_deg)
        height += wave.amplitude * np.sin(phase)
        slope = wave.amplitude * number * np.cos(phase)
        slope_x += slope * along_x
        slope_z += slope * along_z
    return HeightGrid(height, (slope_x, slope_z))


@lru_cache(maxsize=16)
def _surface(grid: HeightGrid, size: tuple[float, float], depth: float | None) -> Surface:
    return grid_surface(grid, size, depth)
