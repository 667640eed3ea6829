"""Objects: a shape made of a material."""

from typing import Self

from pydantic import Field, model_validator

from scenes.errors import Problem, refusal
from scenes.materials import Dielectric, Material
from scenes.model import SceneModel
from scenes.polariser import Polariser
from scenes.shapes import Disk, Plane, Rectangle, Shape, Triangulated

__all__ = ["SceneObject"]


class SceneObject(SceneModel):
    """A thing in the scene."""

    name: str = Field(
        default="",
        max_length=200,
        description='name in messages, unique; "objects[i]" if not given',
    )
    shape: Shape = Field(description="where its surface is")
    material: Material = Field(description="what its surface does to light")

    @model_validator(mode="after")
    def _medium_is_enclosed(self) -> Self:
        if isinstance(self.material, Dielectric) and not self.shape.is_closed:
            allowed = (
                "lambertian, mirror, conductor or absorber,"
                " or a closed shape: sphere, box, prism, lens, …"
            )
            why = f" ({self.shape.openness})" if isinstance(self.shape, Triangulated) else ""
            message = (
                f"a {self.shape.type} encloses no volume that a dielectric could fill{why};"
                f" allowed: {allowed}"
            )
            raise refusal(Problem("material.type", message, self.material.type, allowed))
        return self

    @model_validator(mode="after")
    def _polariser_is_a_sheet(self) -> Self:
        if not isinstance(self.material, Polariser):
            return self
        if not isinstance(self.shape, Rectangle | Disk | Plane):
            allowed = "rectangle, disk or plane"
            message = f"a polariser is a sheet, and a {self.shape.type} is none; allowed: {allowed}"
            raise refusal(Problem("shape.type", message, self.shape.type, allowed))
        if self.material.absorbing_axis(self.shape.normal) is None:
            allowed = "any direction but the sheet's normal"
            message = f"is perpendicular to the sheet; allowed: {allowed}"
            raise refusal(Problem("material.axis", message, self.material.axis, allowed))
        return self
