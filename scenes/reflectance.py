"""Reflectance: a number, or a table against wavelength."""

from typing import Annotated, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Discriminator, Field, Tag, model_validator

from scenes.columns import refuse_uneven_columns
from scenes.fields import Number, Wavelength
from scenes.model import SceneModel, plain_or_table

__all__ = ["Fraction", "Reflectance", "ReflectanceTable", "depends_on_wavelength", "reflectance_at"]

Fraction = Annotated[Number, Field(ge=0, le=1)]
"""A share, 0 to 1."""


class ReflectanceTable(SceneModel):
    """Reflectance against wavelength: linear between the entries, constant beyond them."""

    wavelength_nm: tuple[Wavelength, ...] = Field(
        min_length=1, max_length=10_000, fail_fast=True,
        description="wavelengths, strictly increasing [nm]"
    )
    values: tuple[Fraction, ...] = Field(
        min_length=1, max_length=10_000, fail_fast=True,
        description="reflectance at each wavelength, 0 to 1"
    )

    @model_validator(mode="after")
    def _columns_match(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "values", self.values)
        return self


Reflectance: TypeAlias = Annotated[
    Annotated[Fraction, Tag("<plain>")] | Annotated[ReflectanceTable, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""Fraction of light reflected, one for all wavelengths or a table."""


def reflectance_at(
    reflectance: float | ReflectanceTable, wavelength_nm: ArrayLike
) -> NDArray[np.float64]:
    """Reflectance at wavelengths [nm], of the same shape, 0 to 1."""
    wavelength = np.asarray(wavelength_nm, dtype=np.float64)
    if isinstance(reflectance, ReflectanceTable):
        return np.interp(wavelength, reflectance.wavelength_nm, reflectance.values)
    return np.full_like(wavelength, reflectance)


def depends_on_wavelength(reflectance: float | ReflectanceTable) -> bool:
    """Whether a reflectance is another one at another wavelength."""
    return isinstance(reflectance, ReflectanceTable) and len(set(reflectance.values)) > 1
