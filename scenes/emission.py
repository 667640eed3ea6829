"""Spectra of emitters: by name from `spectra`, or described in the scene itself."""

from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from scenes.columns import refuse_uneven_columns
from scenes.errors import Problem, refusal
from scenes.fields import NonNegative, Number, Wavelength
from scenes.model import SceneModel, plain_or_table
from spectra import EmissionSpectrum, SpectraError, blackbody, laser, spectrum, table

__all__ = [
    "Blackbody",
    "DescribedSpectrum",
    "InlineSpectrum",
    "Laser",
    "Lines",
    "SpectrumSpec",
    "SpectrumTable",
    "resolve_spectrum",
]

_COLDEST_K: Final = 100.0
_HOTTEST_K: Final = 1e6


class DescribedSpectrum(SceneModel):
    """A spectrum that the scene itself describes; the subclasses say how."""

    def emission(self) -> EmissionSpectrum:
        """The relative spectrum."""
        raise NotImplementedError

    def _refuse_darkness(self) -> None:
        """Refuse a spectrum whose total is not a positive, finite number."""
        try:
            with np.errstate(over="ignore"):  # an infinite total is refused, not warned of
                self.emission()
        except SpectraError as error:
            allowed = "a total that is positive and finite"
            raise refusal(Problem("", f"{error}", None, allowed)) from None


class Blackbody(DescribedSpectrum):
    """Thermal radiation by Planck's law, 360 to 830 nm."""

    type: Literal["blackbody"] = Field(default="blackbody", description="thermal radiation")
    temperature_k: Number = Field(
        ge=_COLDEST_K, le=_HOTTEST_K, description="temperature [K], 100 to 1000000"
    )

    def emission(self) -> EmissionSpectrum:
        """The relative spectrum."""
        return blackbody(self.temperature_k)


class Laser(DescribedSpectrum):
    """One Gaussian line."""

    type: Literal["laser"] = Field(default="laser", description="one line")
    wavelength_nm: Wavelength = Field(description="centre of the line [nm]")
    width_nm: NonNegative = Field(
        default=0.0, description="full width at half maximum [nm]; 0 is a single wavelength"
    )

    @model_validator(mode="after")
    def _is_narrow(self) -> Self:
        highest = 0.1 * self.wavelength_nm
        if self.width_nm > highest:
            allowed = f"at most a tenth of the wavelength, {highest:g} nm"
            message = f"must be {allowed}, is {self.width_nm:g}"
            raise refusal(Problem("width_nm", message, self.width_nm, allowed))
        return self

    def emission(self) -> EmissionSpectrum:
        """The relative spectrum."""
        return laser(self.wavelength_nm, self.width_nm)


class Lines(DescribedSpectrum):
    """Sharp lines."""

    type: Literal["lines"] = Field(default="lines", description="sharp lines")
    wavelength_nm: tuple[Wavelength, ...] = Field(
        min_length=1, max_length=1000, fail_fast=True,
        description="wavelengths, strictly increasing [nm]"
    )
    weights: tuple[NonNegative, ...] = Field(
        min_length=1, max_length=1000, fail_fast=True, description="relative flux of each line"
    )

    @model_validator(mode="after")
    def _emits(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "weights", self.weights)
        self._refuse_darkness()
        return self

    def emission(self) -> EmissionSpectrum:
        """The relative spectrum."""
        return EmissionSpectrum(
            name="lines described in the scene",
            line_wavelength_nm=np.array(self.wavelength_nm),
            line_flux=np.array(self.weights),
        )


class SpectrumTable(DescribedSpectrum):
    """Relative flux per nm against wavelength: linear between the entries, none beyond them."""

    type: Literal["table"] = Field(default="table", description="a table of the spectrum")
    wavelength_nm: tuple[Wavelength, ...] = Field(
        min_length=2, max_length=10_000, fail_fast=True,
        description="wavelengths, strictly increasing [nm]"
    )
    values: tuple[NonNegative, ...] = Field(
        min_length=2, max_length=10_000, fail_fast=True,
        description="relative flux per nm at each wavelength"
    )

    @model_validator(mode="after")
    def _emits(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "values", self.values)
        self._refuse_darkness()
        return self

    def emission(self) -> EmissionSpectrum:
        """The relative spectrum."""
        return table(self.wavelength_nm, self.values)


def _known_spectrum(name: str) -> str:
    try:
        spectrum(name)
    except SpectraError as error:
        allowed = "the name of a known spectrum, or a table that describes one"
        raise refusal(Problem("", str(error), name, allowed)) from None
    return name


InlineSpectrum = Annotated[Blackbody | Laser | Lines | SpectrumTable, Field(discriminator="type")]
"""A table with a `type` that describes a spectrum."""

SpectrumSpec = Annotated[
    Annotated[str, AfterValidator(_known_spectrum), Tag("<plain>")]
    | Annotated[InlineSpectrum, Tag("<table>")],
    Discriminator(plain_or_table),
]
"""The exact name of a spectrum that `spectra.spectrum` knows, or a description."""


def resolve_spectrum(spec: str | DescribedSpectrum) -> EmissionSpectrum:
    """The spectrum that a scene names or describes."""
    return spectrum(spec) if isinstance(spec, str) else spec.emission()
