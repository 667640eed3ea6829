"""Absorption inside a medium, described in the scene in any of the ways that data come in."""

from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from scenes.columns import refuse_uneven_columns
from scenes.errors import Problem, refusal, shown
from scenes.fields import WAVELENGTH_RANGE_NM, InverseLength, Number, Size, Wavelength
from scenes.model import SceneModel, plain_or_table
from spectra import Absorption

__all__ = [
    "PUBLISHED",
    "AbsorptionChoice",
    "AbsorptionSpec",
    "CoefficientTable",
    "DecadicAbsorption",
    "DescribedAbsorption",
    "ExtinctionAbsorption",
    "ExtinctionTable",
    "InternalTransmittance",
    "NapierianAbsorption",
    "TransmittanceTable",
    "describe_absorption",
]

_SOURCE = "described in the scene"
_LARGEST_K = 100.0


_Extinction = Annotated[Number, Field(ge=0, le=_LARGEST_K)]
_Transmittance = Annotated[Number, Field(gt=0, le=1)]

_Wavelengths = Annotated[
    tuple[Wavelength, ...],
    Field(min_length=2, max_length=10_000, fail_fast=True,
    description="wavelengths, strictly increasing [nm]"),
]


class CoefficientTable(SceneModel):
    """An absorption coefficient against wavelength: linear between the entries."""

    wavelength_nm: _Wavelengths
    values: tuple[InverseLength, ...] = Field(
        min_length=2,
        max_length=10_000, fail_fast=True,
        description="coefficient at each wavelength, 0 or more [1 / length unit]",
    )

    @model_validator(mode="after")
    def _columns_match(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "values", self.values)
        return self


class ExtinctionTable(SceneModel):
    """An extinction coefficient against wavelength: linear between the entries."""

    wavelength_nm: _Wavelengths
    values: tuple[_Extinction, ...] = Field(
        min_length=2, max_length=10_000, fail_fast=True,
        description="k at each wavelength, 0 or more"
    )

    @model_validator(mode="after")
    def _columns_match(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "values", self.values)
        return self


class TransmittanceTable(SceneModel):
    """Internal transmittance against wavelength: its logarithm is linear between the entries."""

    wavelength_nm: _Wavelengths
    values: tuple[_Transmittance, ...] = Field(
        min_length=2,
        max_length=10_000, fail_fast=True,
        description="internal transmittance at each wavelength, above 0 and at most 1",
    )

    @model_validator(mode="after")
    def _columns_match(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "values", self.values)
        return self


class DescribedAbsorption(SceneModel):
    """Absorption that the scene itself describes; the subclasses say by what quantity."""

    def resolved(self, range_nm: tuple[float, float]) -> Absorption:
        """The absorption, ready to be asked for its coefficient at a wavelength.

        Args:
            range_nm: Where the medium's index is known [nm].
        """
        raise NotImplementedError


_CoefficientOrTable = Annotated[
    Annotated[InverseLength, Tag("<plain>")] | Annotated[CoefficientTable, Tag("<table>")],
    Discriminator(plain_or_table),
]


class NapierianAbsorption(DescribedAbsorption):
    """A way d leaves exp(-coefficient · d) of the light."""

    type: Literal["napierian"] = Field(
        default="napierian", description="Napierian coefficient: exp(-coefficient · length)"
    )
    coefficient: _CoefficientOrTable = Field(
        description="0 or more [1 / length unit], or a table against wavelength"
    )

    def resolved(self, range_nm: tuple[float, float]) -> Absorption:
        """The absorption; constants are known everywhere, whatever `range_nm`."""
        if isinstance(self.coefficient, CoefficientTable):
            table = self.coefficient
            return Absorption(table.values, table.wavelength_nm, _SOURCE)
        return Absorption((self.coefficient,), source=_SOURCE)


def describe_absorption(absorption: Absorption) -> NapierianAbsorption:
    """The absorption as a scene describes it, to the last digit."""
    if absorption.wavelength_nm:
        return NapierianAbsorption(
            coefficient=CoefficientTable(
                wavelength_nm=absorption.wavelength_nm, values=absorption.napierian_per_m
            )
        )
    return NapierianAbsorption(coefficient=absorption.napierian_per_m[0])


class DecadicAbsorption(DescribedAbsorption):
    """A way d leaves 10^(-coefficient · d) of the light."""

    type: Literal["decadic"] = Field(
        default="decadic", description="decadic coefficient: 10^(-coefficient · length)"
    )
    coefficient: _CoefficientOrTable = Field(
        description="0 or more [1 / length unit], or a table against wavelength"
    )

    def resolved(self, range_nm: tuple[float, float]) -> Absorption:
        """The absorption; constants are known everywhere, whatever `range_nm`."""
        if isinstance(self.coefficient, CoefficientTable):
            table = self.coefficient
            return Absorption.from_decadic(table.values, table.wavelength_nm, source=_SOURCE)
        return Absorption.from_decadic((self.coefficient,), source=_SOURCE)


class ExtinctionAbsorption(DescribedAbsorption):
    """The imaginary part k of the index: a way d leaves exp(-4π k d / λ) of the light."""

    type: Literal["extinction"] = Field(
        default="extinction", description="extinction coefficient: exp(-4π k · length / λ)"
    )
    k: Annotated[
        Annotated[_Extinction, Tag("<plain>")] | Annotated[ExtinctionTable, Tag("<table>")],
        Discriminator(plain_or_table),
    ] = Field(description="0 or more, or a table against wavelength")

    def resolved(self, range_nm: tuple[float, float]) -> Absorption:
        """The absorption; a constant k is known over the medium's range `range_nm`."""
        if isinstance(self.k, ExtinctionTable):
            table = self.k
            return Absorption.from_extinction(table.values, table.wavelength_nm, source=_SOURCE)
        low, high = WAVELENGTH_RANGE_NM
        ends_nm = max(low, range_nm[0]), min(high, range_nm[1])
        return Absorption.from_extinction((self.k, self.k), ends_nm, source=_SOURCE)


class InternalTransmittance(DescribedAbsorption):
    """What a thickness lets pass inside, reflections at its faces left out."""

    type: Literal["internal_transmittance"] = Field(
        default="internal_transmittance",
        description="share of light that a thickness lets pass, without reflections",
    )
    thickness: Size = Field(description="the thickness that it is stated for (length)")
    transmittance: Annotated[
        Annotated[_Transmittance, Tag("<plain>")] | Annotated[TransmittanceTable, Tag("<table>")],
        Discriminator(plain_or_table),
    ] = Field(
        description="above 0 and at most 1, or a table against wavelength; a printed 0 is a bound:"
        " write half of its last digit"
    )

    def resolved(self, range_nm: tuple[float, float]) -> Absorption:
        """The absorption; constants are known everywhere, whatever `range_nm`."""
        thickness_m = self.thickness
        if isinstance(self.transmittance, TransmittanceTable):
            table = self.transmittance
            return Absorption.from_internal_transmittance(
                table.values, table.wavelength_nm, thickness_m=thickness_m, source=_SOURCE
            )
        return Absorption.from_internal_transmittance(
            (self.transmittance,), thickness_m=thickness_m, source=_SOURCE
        )


AbsorptionSpec = Annotated[
    NapierianAbsorption | DecadicAbsorption | ExtinctionAbsorption | InternalTransmittance,
    Field(discriminator="type"),
]
"""A table with a `type` that describes an absorption."""

PUBLISHED: Final = "published"
"""The word for the absorption that is published of a glass by name."""


def _known_word(word: str) -> str:
    if word != PUBLISHED:
        allowed = f"{PUBLISHED!r}, or a table that describes the absorption"
        raise refusal(Problem("", f"must be {allowed}, is {shown(word)}", word, allowed))
    return word


AbsorptionChoice = Annotated[
    Annotated[str, AfterValidator(_known_word), Tag("<plain>")]
    | Annotated[AbsorptionSpec, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""`PUBLISHED`, or a description."""
