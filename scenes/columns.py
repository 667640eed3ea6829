"""Tables of values against wavelength: the checks that all of them share."""

from collections.abc import Sequence
from itertools import pairwise

from scenes.errors import Problem, refusal

__all__ = ["refuse_disorder", "refuse_uneven_columns"]


def refuse_disorder(wavelength_nm: Sequence[float], field: str = "range_nm") -> None:
    """Refuse wavelengths that do not increase strictly.

    Args:
        wavelength_nm: The wavelengths [nm].
        field: Their key, relative to the table that is validated.

    Raises:
        PydanticCustomError: naming the first pair that is out of order.
    """
    for index, (lower, upper) in enumerate(pairwise(wavelength_nm), start=1):
        if not lower < upper:
            allowed = "strictly increasing wavelengths"
            message = f"must have {allowed}; {upper:g} nm does not come after {lower:g} nm"
            raise refusal(Problem(f"{field}[{index}]", message, upper, allowed))


def refuse_uneven_columns(
    wavelength_nm: Sequence[float], values_field: str, values: Sequence[float]
) -> None:
    """Refuse a table whose columns differ in length or whose wavelengths do not increase.

    Args:
        wavelength_nm: The column `wavelength_nm` [nm].
        values_field: The key of the other column.
        values: The other column.

    Raises:
        PydanticCustomError: saying which of the two it is.
    """
    if len(values) != len(wavelength_nm):
        allowed = f"as many numbers as wavelength_nm has ({len(wavelength_nm)})"
        message = f"must have {allowed}, has {len(values)}"
        raise refusal(Problem(values_field, message, tuple(values), allowed))
    refuse_disorder(wavelength_nm, "wavelength_nm")
