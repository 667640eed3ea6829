"""Materials: what a surface does to the light that meets it."""

from dataclasses import replace
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, Strict, model_validator

from scenes.absorption import PUBLISHED, AbsorptionChoice
from scenes.errors import Problem, refusal
from scenes.media import DescribedMedium, MediumSpec, coloured, resolve_medium
from scenes.metals import MetalSpec, resolve_metal
from scenes.model import SceneModel
from scenes.polariser import Polariser
from scenes.reflectance import Reflectance, depends_on_wavelength, reflectance_at
from spectra import Conductor, Medium, absorbing_media, published_absorption

__all__ = ["Absorber", "Dielectric", "Lambertian", "Material", "Metal", "Mirror", "is_specular"]


class Dielectric(SceneModel):
    """A transparent medium fills the shape; outside is the ambient one, or another solid's."""

    type: Literal["dielectric"] = Field(default="dielectric", description="glass, water, …")
    medium: MediumSpec = Field(
        description='name of a glass, "air" or "vacuum" (a bubble), or a table that describes a'
        " medium"
    )
    absorption: AbsorptionChoice | None = Field(
        default=None,
        description='what the medium takes of the light on its way: "published" takes what is known'
        " of a glass by name, a table describes it; nothing if absent",
    )
    priority: Annotated[int, Strict(), Field(ge=-1000, le=1000)] = Field(
        default=0,
        description="where solids overlap, the one of the highest priority fills the space,"
        " -1000 to 1000",
    )

    @model_validator(mode="after")
    def _absorbs_once(self) -> Self:
        described = self.medium.absorption if isinstance(self.medium, DescribedMedium) else None
        if described is not None and self.absorption is not None:
            allowed = "one absorption, here or in the medium's own table"
            message = f"is given twice; allowed: {allowed}"
            raise refusal(Problem("absorption", message, self.absorption, allowed))
        return self

    @model_validator(mode="after")
    def _is_published(self) -> Self:
        if self.absorption == PUBLISHED and self.medium not in absorbing_media():
            allowed = f"{PUBLISHED!r} for {', '.join(absorbing_media())}; else a table"
            named = self.medium if isinstance(self.medium, str) else "a medium of the scene's own"
            message = f"nothing is published of {named}; allowed: {allowed}"
            raise refusal(Problem("absorption", message, self.absorption, allowed))
        return self

    def resolved(self) -> Medium:
        """The medium inside, with its absorption."""
        medium = resolve_medium(self.medium)
        if isinstance(self.absorption, str):
            return replace(medium, absorption=published_absorption(medium.name))
        return coloured(medium, self.absorption)


class Lambertian(SceneModel):
    """Reflects diffusely, equally bright from everywhere; receives and shows photons."""

    type: Literal["lambertian"] = Field(default="lambertian", description="diffuse reflector")
    reflectance: Reflectance = Field(
        description="fraction of light reflected, 0 to 1, or a table against wavelength"
    )

    def reflectance_at(self, wavelength_nm: ArrayLike) -> NDArray[np.float64]:
        """Reflectance at wavelengths [nm], of the same shape, 0 to 1."""
        return reflectance_at(self.reflectance, wavelength_nm)

    @property
    def is_coloured(self) -> bool:
        """Whether what it reflects depends on the wavelength."""
        return depends_on_wavelength(self.reflectance)


class Mirror(SceneModel):
    """Reflects like a mirror, the same share at any angle; the rest is swallowed."""

    type: Literal["mirror"] = Field(default="mirror", description="ideal mirror")
    reflectance: Reflectance = Field(
        default=1.0,
        description="fraction of light reflected, 0 to 1, or a table against wavelength",
    )

    def reflectance_at(self, wavelength_nm: ArrayLike) -> NDArray[np.float64]:
        """Reflectance at wavelengths [nm], of the same shape, 0 to 1."""
        return reflectance_at(self.reflectance, wavelength_nm)

    @property
    def is_coloured(self) -> bool:
        """Whether what it reflects depends on the wavelength."""
        return depends_on_wavelength(self.reflectance)


class Metal(SceneModel):
    """The polished surface of a metal: reflects as Fresnel says of its complex index."""

    type: Literal["conductor"] = Field(default="conductor", description="polished metal")
    metal: MetalSpec = Field(
        description="gold, silver, aluminium, copper, or a table of the complex index"
    )

    @property
    def is_coloured(self) -> bool:
        """Whether what it reflects depends on the wavelength; all metals count as coloured."""
        return True

    def resolved(self) -> Conductor:
        """The metal."""
        return resolve_metal(self.metal)


class Absorber(SceneModel):
    """Swallows all light."""

    type: Literal["absorber"] = Field(default="absorber", description="black")


def is_specular(material: object) -> bool:
    """Whether a surface sends light on in single directions: refracted, reflected or straight."""
    return isinstance(material, Dielectric | Mirror | Metal | Polariser)


Material = Annotated[
    Dielectric | Lambertian | Mirror | Metal | Polariser | Absorber,
    Field(discriminator="type"),
]
"""Any material."""
