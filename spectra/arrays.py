"""Functions of a wavelength that take a number or an array and answer alike."""

from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from spectra.errors import SpectraError

__all__ = ["FloatArray", "FloatOrArray", "float_tuple", "like", "read_only"]

FloatArray = npt.NDArray[np.float64]

FloatOrArray = TypeVar("FloatOrArray", float, FloatArray)
"""A number, or a float64 array of any shape: the answer is of the same kind as the question."""


def like(values: FloatArray, question: FloatOrArray) -> FloatOrArray:
    """``values`` as a Python float when ``question`` was a number, else as the array it is."""
    answer: Any = values.item() if np.ndim(question) == 0 else values
    return answer  # type: ignore[no-any-return]


def read_only(values: npt.ArrayLike) -> FloatArray:
    """A contiguous float64 copy that nobody can write to, so that it may be shared and cached."""
    copied = np.array(values, dtype=np.float64, order="C")
    copied.flags.writeable = False
    return copied


def float_tuple(values: Iterable[float], what: str) -> tuple[float, ...]:
    """``values`` as a tuple of finite Python floats.

    Raises:
        SpectraError: If one of them is not a finite number; ``what`` names them.
    """
    numbers = tuple(float(value) for value in values)
    if not np.all(np.isfinite(numbers)):
        raise SpectraError(f"{what} must be finite numbers, not {numbers}")
    return numbers
