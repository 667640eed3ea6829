"""Transparent media: by name from the glass catalogue, or described in the scene itself."""

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from scenes.absorption import AbsorptionSpec, DescribedAbsorption
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
    "REFERENCE_MEDIA",
    "AmbientSpec",
    "CauchyMedium",
    "ConstantMedium",
    "DescribedMedium",
    "InlineMedium",
    "MediumSpec",
    "SellmeierMedium",
    "TableMedium",
    "coloured",
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
    absorption: AbsorptionSpec | None = Field(
        default=None, description="what the medium takes of the light on its way; nothing if absent"
    )

    def _dispersion(self) -> Dispersion:
        raise NotImplementedError

    def _range_nm(self) -> tuple[float, float]:
        raise NotImplementedError

    def resolved(self) -> Medium:
        """The medium, ready to be asked for its index at a wavelength."""
        clear = Medium(
            name="medium described in the scene",
            dispersion=self._dispersion(),
            wavelength_range_nm=self._range_nm(),
            source=self.source,
            relative_to=self.relative_to,
        )
        return coloured(clear, self.absorption)

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
        min_length=2, max_length=10_000, fail_fast=True,
        description="wavelengths, strictly increasing [nm]"
    )
    eta: tuple[_Index, ...] = Field(
        min_length=2, max_length=10_000, fail_fast=True,
        description="refractive index at each wavelength"
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


_REFERENCES: Final[tuple[Literal["air", "vacuum"], ...]] = ("air", "vacuum")

REFERENCE_MEDIA: Final[Mapping[str, Medium]] = MappingProxyType(
    {
        name: Medium(
            name=name,
            dispersion=Cauchy((1.0,)),
            wavelength_range_nm=(0.0, math.inf),
            source="the index is relative to it",
            relative_to=name,
        )
        for name in _REFERENCES
    }
)
"""What indices are measured against, as media: of index 1, each relative to itself."""

AMBIENT_NAMES: Final = ("reference", *REFERENCE_MEDIA)
"""What can surround the objects, apart from a medium."""


def _known_medium(name: str) -> str:
    return _known(name, tuple(REFERENCE_MEDIA))


def _known_ambient(name: str) -> str:
    return _known(name, AMBIENT_NAMES)


def _known(name: str, other_names: tuple[str, ...]) -> str:
    """A name that is one of `other_names` or a glass's."""
    error = UnknownGlass(name, (*other_names, *glasses()))
    if name in error.known:
        return name
    allowed = f"{', '.join(error.known)}, or a table that describes the medium"
    message = f"{error}; {', '.join(other_names)} are allowed as well as a glass"
    raise refusal(Problem("", message, name, allowed))


InlineMedium = Annotated[
    SellmeierMedium | CauchyMedium | TableMedium | ConstantMedium, Field(discriminator="type")
]
"""A table with a `type` that describes a medium."""

MediumSpec = Annotated[
    Annotated[str, AfterValidator(_known_medium), Tag("<plain>")]
    | Annotated[InlineMedium, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""The exact name of a medium that `spectra.glass` knows, "air", "vacuum", or a description."""

AmbientSpec = Annotated[
    Annotated[str, AfterValidator(_known_ambient), Tag("<plain>")]
    | Annotated[InlineMedium, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""What surrounds the objects: one of `AMBIENT_NAMES`, or a medium."""


def resolve_medium(medium: str | DescribedMedium) -> Medium:
    """The medium that a scene names or describes."""
    if isinstance(medium, DescribedMedium):
        return medium.resolved()
    return REFERENCE_MEDIA.get(medium) or glass(medium)


def coloured(medium: Medium, absorption: DescribedAbsorption | None) -> Medium:
    """The medium with an absorption; itself, if there is none."""
    if absorption is None:
        return medium
    return replace(medium, absorption=absorption.resolved(medium.wavelength_range_nm))
