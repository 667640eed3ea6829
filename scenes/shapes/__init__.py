"""Shapes: where surfaces are. Pure descriptions, in metres and in the world's orientation."""

from typing import Annotated

from pydantic import Field

from scenes.shapes.bounds import Bounds
from scenes.shapes.box import Box
from scenes.shapes.convex import ConvexSolid, Faces
from scenes.shapes.flat import Disk, FlatRectangle, Plane, Rectangle
from scenes.shapes.heightfield import HeightField, Wave
from scenes.shapes.lens import Lens, LensSurface
from scenes.shapes.mesh import Mesh
from scenes.shapes.polyhedron import Polyhedron
from scenes.shapes.prism import Prism
from scenes.shapes.sphere import Sphere
from scenes.shapes.surface import Surface
from scenes.shapes.triangulated import Triangulated

__all__ = [
    "Bounds",
    "Box",
    "ConvexSolid",
    "Disk",
    "Faces",
    "FlatRectangle",
    "HeightField",
    "Lens",
    "LensSurface",
    "Mesh",
    "Plane",
    "Polyhedron",
    "Prism",
    "Rectangle",
    "Shape",
    "Sphere",
    "Surface",
    "Triangulated",
    "Wave",
]

Shape = Annotated[
    Sphere | Plane | Rectangle | Disk | Box | Prism | Polyhedron | Lens | Mesh | HeightField,
    Field(discriminator="type"),
]
"""Any shape."""
