"""The mesh: triangles from a file."""

from typing import Literal, Self

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from scenes.budget import charge
from scenes.errors import Problem, reason_of, refusal, shown
from scenes.fields import Size
from scenes.nearby_files import nearby_file
from scenes.shapes.mesh_file import MESH_FORMATS, NormalsChoice, read_surface
from scenes.shapes.surface import Surface
from scenes.shapes.triangulated import Triangulated

__all__ = ["Mesh"]


class Mesh(Triangulated):
    """Triangles from a file; for shapes that have no formula."""

    type: Literal["mesh"] = Field(default="mesh", description="triangles from a file")
    file: str = Field(
        description="a PLY, OBJ, STL or GLB file, relative to the scene's folder and inside it"
    )
    unit: Size = Field(
        default=1.0, validate_default=True,
        description="length of the mesh file's unit (length); the scene file's if not given",
    )  # fmt: skip
    normals: NormalsChoice = Field(
        default="file",
        description='"file": smooth where the file has normals; "smooth": means over the triangles'
        ' around each corner, but for edges sharper than 40 degrees; "flat": facets',
    )
    turned: bool = Field(
        default=False, description="whether the file's triangles are clockwise seen from outside"
    )

    _surface: Surface | None = PrivateAttr(default=None)

    def local_surface(self) -> Surface:
        """The triangles as the file has them, in metres."""
        assert self._surface is not None  # the validator below has read it
        return self._surface

    @model_validator(mode="after")
    def _can_be_read(self, info: ValidationInfo) -> Self:
        path = nearby_file(self.file, info)
        try:
            charge(info, "bytes of other files", path.stat().st_size, "file")
            self._surface = read_surface(path, self.unit, self.normals, turned=self.turned)
        except PydanticCustomError:  # is a ValueError too
            raise
        except (OSError, ValueError) as error:
            allowed = f"a file of triangles ({', '.join(kind.upper() for kind in MESH_FORMATS)})"
            message = f"{shown(self.file)} cannot be used: {reason_of(error)}; allowed: {allowed}"
            raise refusal(Problem("file", message, self.file, allowed)) from None
        charge(info, "triangles", len(self._surface.triangles), "file")
        return self
