"""Transparent media: by name from the glass catalogue, or described in the scene itself."""

from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from scenes.columns import refuse_disorder, refuse_uneven_columns
from scenes.errors import Problem, refusal
from scenes.fields import WAVELENGTH_RANGE_NM, Number, Wavelength
from scenes.model import SceneModel, plain_or_table
from spectra import (
    Cauchy,
    Dispersion,
    Medium,
    Sellmeier,
    SpectraError,
    Tabulated,
    UnknownGlass,
    glass,
    glasses,
)

__all__ = [
    "AMBIENT_NAMES",
    "AmbientSpec",
    "CauchyMedium",
    "ConstantMedium",
    "DescribedMedium",
    "InlineMedium",
    "MediumSpec",
    "SellmeierMedium",
    "TableMedium",
    "resolve_medium",
]

_SAMPLES_OF_RANGE: Final = 2001
_LARGEST_INDEX: Final = 100.0

_Index = Annotated[Number, Field(gt=0, le=_LARGEST_INDEX)]
_Range = Annotated[
    tuple[Wavelength, Wavelength],
    Field(description="[lowest, highest] wavelength at which the formula holds [nm]"),
]
_Source = Annotated[str, Field(description="where the numbers come from")]
_RelativeTo = Annotated[
    Literal["air", "vacuum"],
    Field(description="what the index was measured against: standard air, or vacuum"),
]


class DescribedMedium(SceneModel):
    """A medium that the scene itself describes; the subclasses say by what formula."""

    source: _Source = "described in the scene"
    relative_to: _RelativeTo = "air"

    def _dispersion(self) -> Dispersion:
        raise NotImplementedError

    def _range_nm(self) -> tuple[float, float]:
        raise NotImplementedError

    def resolved(self) -> Medium:
        """The medium, ready to be asked for its index at a wavelength."""
        return Medium(
            name="medium described in the scene",
            dispersion=self._dispersion(),
            wavelength_range_nm=self._range_nm(),
            source=self.source,
            relative_to=self.relative_to,
        )

    def _refuse_unphysical(self) -> None:
        """Refuse a formula without a positive index somewhere in its range.

        `spectra` looks for resonances exactly; between them the index is sampled densely.
        """
        try:
            eta = self.resolved().eta(np.linspace(*self._range_nm(), _SAMPLES_OF_RANGE))
        except SpectraError as error:
            allowed = "a positive index over the whole range"
            raise refusal(Problem("", f"{error}", None, allowed)) from None
        if eta.max() > _LARGEST_INDEX:
            allowed = f"an index of at most {_LARGEST_INDEX:g}"
            message = f"must give {allowed}, gives {eta.max():g}"
            raise refusal(Problem("", message, None, allowed))


class SellmeierMedium(DescribedMedium):
    """n² - 1 = Σ Bλ²/(λ² - C), λ in micrometres; C is not squared again."""

    type: Literal["sellmeier"] = Field(default="sellmeier", description="Sellmeier formula")
    b: tuple[Number, ...] = Field(min_length=1, max_length=4, description="coefficients B")
    c_um2: tuple[Number, ...] = Field(
        min_length=1, max_length=4, description="coefficients C [µm²], as many as B"
    )
    range_nm: _Range

    @model_validator(mode="after")
    def _holds_over_its_range(self) -> Self:
        if len(self.b) != len(self.c_um2):
            allowed = f"as many numbers as b has ({len(self.b)})"
            message = f"must have {allowed}, has {len(self.c_um2)}"
            raise refusal(Problem("c_um2", message, self.c_um2, allowed))
        refuse_disorder(self.range_nm)
        self._refuse_unphysical()
        return self

    def _range_nm(self) -> tuple[float, float]:
        return self.range_nm

    def _dispersion(self) -> Sellmeier:
        return Sellmeier(b=self.b, c_um2=self.c_um2)


class CauchyMedium(DescribedMedium):
    """n = a₀ + a₁/λ² + a₂/λ⁴ + a₃/λ⁶, λ in micrometres."""

    type: Literal["cauchy"] = Field(default="cauchy", description="Cauchy's formula")
    a: tuple[Number, ...] = Field(
        min_length=1, max_length=4, description="coefficients a, the k-th in µm to the power 2k"
    )
    range_nm: _Range

    @model_validator(mode="after")
    def _holds_over_its_range(self) -> Self:
        refuse_disorder(self.range_nm)
        self._refuse_unphysical()
        return self

    def _range_nm(self) -> tuple[float, float]:
        return self.range_nm

    def _dispersion(self) -> Cauchy:
        return Cauchy(a=self.a)


class TableMedium(DescribedMedium):
    """A measured index, interpolated by a cubic that keeps its monotony."""

    type: Literal["table"] = Field(default="table", description="a table of the index")
    wavelength_nm: tuple[Wavelength, ...] = Field(
        min_length=2, max_length=10_000, description="wavelengths, strictly increasing [nm]"
    )
    eta: tuple[_Index, ...] = Field(
        min_length=2, max_length=10_000, description="refractive index at each wavelength"
    )

    @model_validator(mode="after")
    def _columns_match(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "eta", self.eta)
        self._refuse_unphysical()
        return self

    def _range_nm(self) -> tuple[float, float]:
        return (self.wavelength_nm[0], self.wavelength_nm[-1])

    def _dispersion(self) -> Tabulated:
        return Tabulated(wavelength_nm=self.wavelength_nm, index=self.eta)


class ConstantMedium(DescribedMedium):
    """The same index at every wavelength."""

    type: Literal["constant"] = Field(default="constant", description="no dispersion at all")
    eta: _Index = Field(description="refractive index")

    def _range_nm(self) -> tuple[float, float]:
        return WAVELENGTH_RANGE_NM

    def _dispersion(self) -> Cauchy:
        return Cauchy(a=(self.eta,))


AMBIENT_NAMES: Final = ("reference", "air", "vacuum")
"""What can surround the objects, apart from a medium."""


def _known_glass(name: str) -> str:
    try:
        glass(name)
    except UnknownGlass as error:
        allowed = f"{', '.join(glasses())}, or a table that describes the medium"
        raise refusal(Problem("", str(error), name, allowed)) from None
    return name


def _known_ambient(name: str) -> str:
    if name in AMBIENT_NAMES:
        return name
    try:
        return _known_glass(name)
    except PydanticCustomError:
        error = UnknownGlass(name, (*AMBIENT_NAMES, *glasses()))
        allowed = f"{', '.join(error.known)}, or a table that describes a medium"
        message = f"{error}; {', '.join(AMBIENT_NAMES)} are allowed as well as a glass"
        raise refusal(Problem("", message, name, allowed)) from None


InlineMedium = Annotated[
    SellmeierMedium | CauchyMedium | TableMedium | ConstantMedium, Field(discriminator="type")
]
"""A table with a `type` that describes a medium."""

MediumSpec = Annotated[
    Annotated[str, AfterValidator(_known_glass), Tag("<plain>")]
    | Annotated[InlineMedium, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""The exact name of a medium that `spectra.glass` knows, or a description."""

AmbientSpec = Annotated[
    Annotated[str, AfterValidator(_known_ambient), Tag("<plain>")]
    | Annotated[InlineMedium, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""What surrounds the objects: one of `AMBIENT_NAMES`, or a medium."""


def resolve_medium(medium: str | DescribedMedium) -> Medium:
    """The medium that a scene names or describes."""
    return glass(medium) if isinstance(medium, str) else medium.resolved()
