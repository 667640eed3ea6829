"""Metals: by name from the tables of complex indices, or described in the scene itself."""

from typing import Annotated, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from scenes.columns import refuse_uneven_columns
from scenes.errors import Problem, refusal
from scenes.fields import Number, Wavelength
from scenes.model import SceneModel, plain_or_table
from spectra import Conductor, UnknownConductor, conductor, conductors

__all__ = ["MetalSpec", "MetalTable", "resolve_metal"]

_LARGEST_INDEX = 1000.0


class MetalTable(SceneModel):
    """A complex index n + ik against wavelength, linear between the entries."""

    wavelength_nm: tuple[Wavelength, ...] = Field(
        min_length=2, max_length=10_000, fail_fast=True,
        description="wavelengths, strictly increasing [nm]"
    )
    n: tuple[Annotated[Number, Field(gt=0, le=_LARGEST_INDEX)], ...] = Field(
        min_length=2, max_length=10_000, fail_fast=True,
        description="real part of the index at each wavelength"
    )
    k: tuple[Annotated[Number, Field(ge=0, le=_LARGEST_INDEX)], ...] = Field(
        min_length=2,
        max_length=10_000, fail_fast=True,
        description="imaginary part at each wavelength, the extinction coefficient, 0 or more",
    )
    source: str = Field(default="described in the scene", description="where the numbers come from")

    @model_validator(mode="after")
    def _columns_match(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "n", self.n)
        refuse_uneven_columns(self.wavelength_nm, "k", self.k)
        return self

    def resolved(self) -> Conductor:
        """The metal, ready to be asked for its index at a wavelength."""
        return Conductor(
            name="metal described in the scene",
            wavelength_nm=self.wavelength_nm,
            eta_values=self.n,
            k_values=self.k,
            source=self.source,
        )


def _known_metal(name: str) -> str:
    try:
        conductor(name)
    except UnknownConductor as error:
        allowed = f"{', '.join(conductors())}, or a table that describes the metal"
        raise refusal(Problem("", str(error), name, allowed)) from None
    return name


MetalSpec = Annotated[
    Annotated[str, AfterValidator(_known_metal), Tag("<plain>")]
    | Annotated[MetalTable, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""The exact name of a metal that `spectra.conductor` knows, or a description."""


def resolve_metal(metal: str | MetalTable) -> Conductor:
    """The metal that a scene names or describes."""
    return conductor(metal) if isinstance(metal, str) else metal.resolved()
