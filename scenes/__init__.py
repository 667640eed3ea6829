"""Scenes: what there is, described and checked; nothing here traces a ray.

A scene is a TOML file or a tree of frozen models. Models hold SI units (lengths in metres),
wavelengths in nanometres (`…_nm`) and angles in degrees (`…_deg`); files may use millimetres.

    >>> import scenes
    >>> scene = scenes.load("prism")
    >>> scene.objects[0].shape.apex_deg
    60.0
"""

from scenes.absorption import (
    CoefficientTable,
    DecadicAbsorption,
    ExtinctionAbsorption,
    ExtinctionTable,
    InternalTransmittance,
    NapierianAbsorption,
    TransmittanceTable,
)
from scenes.camera import Camera
from scenes.doubts import SceneWarning
from scenes.emission import Blackbody, Laser, Lines, SpectrumTable
from scenes.emitters import (
    Beam,
    Environment,
    Mask,
    Point,
    RectangleLamp,
    RoundProfile,
    SlitProfile,
    SphereLamp,
    Spot,
    Sun,
)
from scenes.errors import Problem, SceneError
from scenes.exposure import SensorExposure
from scenes.files import gallery, gallery_path, load, loads, schema
from scenes.film import Film
from scenes.frames import rotation_matrix
from scenes.materials import Absorber, Dielectric, Lambertian, Metal, Mirror, is_specular
from scenes.media import CauchyMedium, ConstantMedium, SellmeierMedium, TableMedium
from scenes.metals import MetalTable
from scenes.objects import SceneObject
from scenes.pixel_filter import BoxFilter, GaussianFilter, TentFilter
from scenes.polarisation import Polarisation
from scenes.polariser import Polariser
from scenes.reflectance import ReflectanceTable
from scenes.scene import RenderDefaults, Scene
from scenes.sensors import IrradianceSensor, RaySensor
from scenes.shapes import (
    Box,
    Disk,
    HeightField,
    Lens,
    LensSurface,
    Mesh,
    Plane,
    Polyhedron,
    Prism,
    Rectangle,
    Sphere,
    Triangulated,
    Wave,
)

__all__ = [
    "Absorber",
    "Beam",
    "Blackbody",
    "Box",
    "BoxFilter",
    "Camera",
    "CauchyMedium",
    "CoefficientTable",
    "ConstantMedium",
    "DecadicAbsorption",
    "Dielectric",
    "Disk",
    "Environment",
    "ExtinctionAbsorption",
    "ExtinctionTable",
    "Film",
    "GaussianFilter",
    "HeightField",
    "InternalTransmittance",
    "IrradianceSensor",
    "Lambertian",
    "Laser",
    "Lens",
    "LensSurface",
    "Lines",
    "Mask",
    "Mesh",
    "Metal",
    "MetalTable",
    "Mirror",
    "NapierianAbsorption",
    "Plane",
    "Point",
    "Polarisation",
    "Polariser",
    "Polyhedron",
    "Prism",
    "Problem",
    "RaySensor",
    "Rectangle",
    "RectangleLamp",
    "ReflectanceTable",
    "RenderDefaults",
    "RoundProfile",
    "Scene",
    "SceneError",
    "SceneObject",
    "SceneWarning",
    "SellmeierMedium",
    "SensorExposure",
    "SlitProfile",
    "SpectrumTable",
    "Sphere",
    "SphereLamp",
    "Spot",
    "Sun",
    "TableMedium",
    "TentFilter",
    "TransmittanceTable",
    "Triangulated",
    "Wave",
    "gallery",
    "gallery_path",
    "is_specular",
    "load",
    "loads",
    "rotation_matrix",
    "schema",
]
