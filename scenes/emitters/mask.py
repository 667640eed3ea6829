"""Masks: what part of a lamp's surface, or of a beam's profile, light comes through."""

import io
import warnings
from pathlib import Path
from typing import Annotated, Final, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from scenes.budget import charge
from scenes.errors import Problem, reason_of, refusal, shown
from scenes.fields import Number
from scenes.file_content import file_content
from scenes.model import SceneModel
from scenes.nearby_files import nearby_file

__all__ = ["Mask"]

MAX_CELLS: Final = 2048
"""A side."""

IMAGE_FORMATS: Final = ("BMP", "GIF", "JPEG", "PNG", "PPM", "TIFF", "WEBP")
"""Formats of images; Pillow knows more, some of which run other programs."""

_MAX_BYTES = 64 * 1024 * 1024

_Row = Annotated[
    tuple[Annotated[Number, Field(ge=0, le=1)], ...],
    Field(min_length=1, max_length=MAX_CELLS, fail_fast=True),
]
_Rows = Annotated[
    tuple[_Row, ...], Field(min_length=1, max_length=MAX_CELLS, fail_fast=True)
]


class Mask(SceneModel):
    """Transmittances of the cells of a rectangle, as they are seen by who looks into the light.

    The emitter's flux is that of the light that comes through.
    """

    values: _Rows | None = Field(
        default=None,
        description="transmittances of the cells, 0 to 1, in rows of equal length, the first on"
        " top, at most 2048 a side",
    )
    file: str | None = Field(
        default=None,
        description="an image in place of values: its grey levels, black 0 and white 1, as they"
        " are stored; relative to the scene's folder and inside it",
    )

    _cells: NDArray[np.float64] | None = PrivateAttr(default=None)

    def cells(self) -> NDArray[np.float64]:
        """(rows, columns) transmittances, row 0 on top."""
        assert self._cells is not None  # the validator below has read them
        return self._cells

    @model_validator(mode="after")
    def _lets_light_through(self, info: ValidationInfo) -> Self:
        if (self.values is None) == (self.file is None):
            allowed = "values or file, one of the two"
            raise refusal(Problem("", f"must have {allowed}", None, allowed))
        if self.file is not None:
            cells, field = _read_image(nearby_file(self.file, info), self.file, info), "file"
        else:
            cells, field = _even_rows(self.values or ()), "values"
        if not cells.any():
            allowed = "at least one cell that lets light through"
            raise refusal(Problem(field, f"must have {allowed}", None, allowed))
        self._cells = cells
        return self


def _even_rows(rows: tuple[tuple[float, ...], ...]) -> NDArray[np.float64]:
    widths = {len(row) for row in rows}
    if len(widths) != 1:
        allowed = "rows of the same length"
        message = f"must be {allowed}; there are some of {min(widths)} and some of {max(widths)}"
        raise refusal(Problem("values", message, None, allowed))
    return np.array(rows, dtype=np.float64)


def _read_image(path: Path, name: str, info: ValidationInfo) -> NDArray[np.float64]:
    """Grey levels of an image, 0 to 1."""
    from PIL import Image, UnidentifiedImageError

    allowed = f"an image ({', '.join(IMAGE_FORMATS)}) of at most {MAX_CELLS} pixels a side"
    try:
        content = file_content(path, _MAX_BYTES)
        charge(info, "bytes of other files", len(content), "file")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of what is too large, and refused here anyway
            with Image.open(io.BytesIO(content), formats=IMAGE_FORMATS) as image:
                if max(image.size) > MAX_CELLS:
                    width, height = image.size
                    message = f"must be {allowed}; {shown(name)} has {width} × {height}"
                    raise refusal(Problem("file", message, name, allowed))
                charge(info, "mask cells", image.size[0] * image.size[1], "file")
                grey = image.convert("I" if image.mode.startswith("I") else "L")
        white = 65535.0 if grey.mode == "I" else 255.0
        return np.clip(np.asarray(grey, dtype=np.float64) / white, 0.0, 1.0)
    except PydanticCustomError:
        raise
    except Exception as error:  # a damaged file ends in any of Python's exceptions
        is_none = isinstance(error, UnidentifiedImageError)
        reason = "it is no such image, or damaged" if is_none else reason_of(error)
        message = f"{shown(name)} cannot be read: {reason}; allowed: {allowed}"
        raise refusal(Problem("file", message, name, allowed)) from None
