"""Materials: what a surface does to the light that meets it."""

from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Discriminator, Field, Strict, Tag, model_validator

from scenes.columns import refuse_uneven_columns
from scenes.fields import Number, Wavelength
from scenes.media import MediumSpec, resolve_medium
from scenes.model import SceneModel, plain_or_table
from spectra import Medium

__all__ = ["Absorber", "Dielectric", "Lambertian", "Material", "ReflectanceTable"]

_Fraction = Annotated[Number, Field(ge=0, le=1)]


class Dielectric(SceneModel):
    """A transparent medium fills the shape; outside is the ambient one, or another solid's."""

    type: Literal["dielectric"] = Field(default="dielectric", description="glass, water, …")
    medium: MediumSpec = Field(description="name of a glass, or a table that describes a medium")
    priority: Annotated[int, Strict(), Field(ge=-1000, le=1000)] = Field(
        default=0,
        description="where solids overlap, the one of the highest priority fills the space,"
        " -1000 to 1000",
    )

    def resolved(self) -> Medium:
        """The medium inside."""
        return resolve_medium(self.medium)


class ReflectanceTable(SceneModel):
    """Reflectance against wavelength: linear between the entries, constant beyond them."""

    wavelength_nm: tuple[Wavelength, ...] = Field(
        min_length=1, max_length=10_000, description="wavelengths, strictly increasing [nm]"
    )
    values: tuple[_Fraction, ...] = Field(
        min_length=1, max_length=10_000, description="reflectance at each wavelength, 0 to 1"
    )

    @model_validator(mode="after")
    def _columns_match(self) -> Self:
        refuse_uneven_columns(self.wavelength_nm, "values", self.values)
        return self


class Lambertian(SceneModel):
    """Reflects diffusely, equally bright from everywhere; receives and shows photons."""

    type: Literal["lambertian"] = Field(default="lambertian", description="diffuse reflector")
    reflectance: Annotated[
        Annotated[_Fraction, Tag("<plain>")] | Annotated[ReflectanceTable, Tag("<table>")],
        Discriminator(plain_or_table),
    ] = Field(description="fraction of light reflected, 0 to 1, or a table against wavelength")

    def reflectance_at(self, wavelength_nm: ArrayLike) -> NDArray[np.float64]:
        """Reflectance at wavelengths [nm], of the same shape, 0 to 1."""
        wavelength = np.asarray(wavelength_nm, dtype=np.float64)
        if isinstance(self.reflectance, ReflectanceTable):
            table = self.reflectance
            return np.interp(wavelength, table.wavelength_nm, table.values)
        return np.full_like(wavelength, self.reflectance)


class Absorber(SceneModel):
    """Swallows all light."""

    type: Literal["absorber"] = Field(default="absorber", description="black")


Material = Annotated[Dielectric | Lambertian | Absorber, Field(discriminator="type")]
"""Any material."""
