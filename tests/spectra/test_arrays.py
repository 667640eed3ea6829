import numpy as np
import pytest

from spectra import SpectraError
from spectra.arrays import float_tuple, like, read_only


def test_a_number_is_answered_with_a_float() -> None:
    answer = like(np.array(1.5), 500.0)
    assert type(answer) is float


def test_an_array_is_answered_with_the_array() -> None:
    values = np.ones((2, 3))
    assert like(values, np.zeros((2, 3))) is values


def test_read_only_is_a_copy_nobody_can_write_to() -> None:
    original = np.arange(3)
    shared = read_only(original)
    original[0] = 7
    assert shared.dtype == np.float64
    assert shared.tolist() == [0.0, 1.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        shared[0] = 1.0


def test_coefficients_are_finite_floats() -> None:
    assert float_tuple([1, np.float64(2.5)], "b") == (1.0, 2.5)
    with pytest.raises(SpectraError, match="b must be finite numbers"):
        float_tuple([1.0, float("nan")], "b")
