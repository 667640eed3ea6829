"""A scene as device arrays, in a local frame.

The scene is recentred on its finite objects, so that a bench a kilometre from its file's origin
is traced with the digits of one at the origin. Results that carry positions add `origin` back.
"""

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from scenes.frames import frame_about
from sim.features import Features, Subject, find_features
from sim.mesh_data import compile_meshes
from sim.method import Method
from sim.optics.dispersion import DISPERSION_COEFFICIENTS
from sim.precision import precision_types
from sim.scene_media import collect_media
from sim.scene_structs import (
    ABSORBER,
    CAUCHY,
    DIELECTRIC,
    LAMBERTIAN,
    SELLMEIER,
    SHAPE_FLAT,
    SHAPE_LENS,
    SHAPE_MESH,
    SHAPE_POLYHEDRON,
    SHAPE_SPHERE,
    TABULATED,
    make_scene_structs,
)
from spectra import Cauchy, Medium, Sellmeier, Tabulated

__all__ = ["CompiledScene", "compile_scene", "find_origin"]

FloatArray = npt.NDArray[np.float64]
Row = tuple[Any, ...]


@dataclass(frozen=True)
class CompiledScene:
    """What kernels need of a scene, and what the host needs to speak about it.

    Attributes:
        scene: the description this was compiled from.
        precision: "float32" or "float64".
        device: Warp's name of the device the arrays live on.
        features: what the kernels must handle.
        media: the media in the order of their indices, the ambient one first.
        origin: (3,), world position of the local frame's origin [m].
        data: the device-side Scene struct.
    """

    scene: scenes.Scene
    precision: str
    device: str
    features: Features
    media: tuple[Medium, ...]
    origin: FloatArray
    data: Any

    @property
    def structs(self) -> SimpleNamespace:
        """The structs that `data` is made of."""
        return make_scene_structs(self.precision)

    def to_local(self, position: npt.ArrayLike) -> FloatArray:
        """World position(s) (..., 3) [m] in the local frame."""
        return np.asarray(position, dtype=np.float64) - self.origin

    @property
    def bounding_radius(self) -> float:
        """Radius about the local origin that holds every finite object [m]; 1 if there is none."""
        reach = [
            float(np.linalg.norm(self.to_local(centre))) + radius
            for centre, radius in (
                item.shape.bounding_sphere()
                for item in self.scene.objects
                if not isinstance(item.shape, scenes.Plane)
            )
        ]
        return max(reach, default=1.0)


def find_origin(scene: scenes.Scene) -> FloatArray:
    """Centre of the finite objects' bounding box, (3,) [m]; the world's origin if there is none."""
    spheres = [
        item.shape.bounding_sphere()
        for item in scene.objects
        if not isinstance(item.shape, scenes.Plane)
    ]
    if not spheres:
        return np.zeros(3)
    low = np.min([np.asarray(centre) - radius for centre, radius in spheres], axis=0)
    high = np.max([np.asarray(centre) + radius for centre, radius in spheres], axis=0)
    middle: FloatArray = 0.5 * (low + high)
    return middle


def compile_scene(
    scene: scenes.Scene,
    *,
    precision: str = "float64",
    device: str = "cpu",
    features: Features | None = None,
    method: Method | None = None,
) -> CompiledScene:
    """Lay `scene` out as device arrays.

    Args:
        scene: a validated scene.
        precision: what the kernels compute with.
        device: where the arrays live.
        features: what the kernels must handle; None: all that could change anything.
        method: how light is followed; None: as a rendering does, or as `features` say.
    """
    origin = find_origin(scene)
    media, medium_of, air_powers = collect_media(scene)
    if features is None:
        features = find_features(scene, media, air_powers)
    if method is not None:
        features = replace(features, method=method)
    structs = make_scene_structs(precision)
    data = structs.Scene()
    places = _fill_shapes(data, scene, origin, precision, device)
    rows = [
        (*place, *material)
        for place, material in zip(
            places, _materials(scene, media, medium_of, air_powers, features), strict=True
        )
    ]
    data.bodies = struct_array(structs.Body, rows, device)
    _fill_media(data, media, air_powers, precision, device)
    return CompiledScene(scene, precision, device, features, tuple(media), origin, data)


def struct_array(struct: Any, rows: list[Row], device: str) -> Any:
    """A device array of `struct` from tuples in the order of its fields; never of length zero.

    Warp's empty arrays have a null pointer; one zero element that no count mentions is simpler
    than a guard at each use.
    """
    dtype = struct.numpy_dtype()
    host = np.zeros(max(1, len(rows)), dtype=dtype)
    for i, row in enumerate(rows):
        host[i] = row
    return wp.array(host, dtype=struct, device=device)


def axis_frame(axis: tuple[float, float, float]) -> FloatArray:
    """(3, 3), rows u, v and the unit `axis`: a right-handed frame about it."""
    frame = frame_about(axis)
    assert frame is not None  # only a chosen "up" can be parallel to the axis
    return np.stack(frame)


def _fill_shapes(
    data: Any, scene: scenes.Scene, origin: FloatArray, precision: str, device: str
) -> list[tuple[int, int]]:
    """Fill the arrays of shapes and their counts; return each object's kind and row there."""
    rows: dict[str, list[Row]] = {
        name: [] for name in ("spheres", "flats", "polyhedra", "planes", "lenses")
    }
    meshes: list[tuple[scenes.Triangulated, FloatArray, int]] = []
    places: list[tuple[int, int]] = []
    for prim, item in enumerate(scene.objects):
        shape = item.shape
        centre = np.asarray(shape.position, dtype=np.float64) - origin
        if isinstance(shape, scenes.Sphere):
            places.append((int(SHAPE_SPHERE), len(rows["spheres"])))
            rows["spheres"].append((centre, shape.radius, prim))
        elif isinstance(shape, scenes.Lens):
            places.append((int(SHAPE_LENS), len(rows["lenses"])))
            rows["lenses"].append(_lens_row(shape, centre, prim, precision))
        elif isinstance(shape, scenes.Rectangle | scenes.Disk | scenes.Plane):
            places.append((int(SHAPE_FLAT), len(rows["flats"])))
            rows["flats"].append(_flat_row(shape, centre, prim))
        elif isinstance(shape, scenes.Triangulated):
            places.append((int(SHAPE_MESH), len(meshes)))
            meshes.append((shape, centre, prim))
        else:
            places.append((int(SHAPE_POLYHEDRON), len(rows["polyhedra"])))
            normals, offsets = shape.faces()
            rows["polyhedra"].append((centre, len(rows["planes"]), len(normals), prim))
            rows["planes"].extend(zip(normals, offsets, strict=True))
    structs = make_scene_structs(precision)
    data.spheres = struct_array(structs.Sphere, rows["spheres"], device)
    data.flats = struct_array(structs.Flat, rows["flats"], device)
    data.polyhedra = struct_array(structs.Polyhedron, rows["polyhedra"], device)
    data.planes = struct_array(structs.Plane, rows["planes"], device)
    data.lenses = struct_array(structs.Lens, rows["lenses"], device)
    data.meshes = compile_meshes(meshes, precision=precision, device=device)
    data.sphere_count = len(rows["spheres"])
    data.flat_count = len(rows["flats"])
    data.polyhedron_count = len(rows["polyhedra"])
    data.lens_count = len(rows["lenses"])
    return places


def _flat_row(
    shape: scenes.Rectangle | scenes.Disk | scenes.Plane, centre: FloatArray, prim: int
) -> Row:
    """Row of a Flat: the limits it does not have are infinite."""
    if isinstance(shape, scenes.Rectangle):
        frame = np.stack(shape.frame())
        return centre, frame, 0.5 * shape.size[0], 0.5 * shape.size[1], np.inf, prim
    frame = axis_frame(shape.normal)
    radius2 = shape.radius**2 if isinstance(shape, scenes.Disk) else np.inf
    return centre, frame, np.inf, np.inf, radius2, prim


def _lens_row(lens: scenes.Lens, centre: FloatArray, prim: int, precision: str) -> Row:
    """Row of a Lens, with the height of its rim from the sags at the edge."""
    radius, half = 0.5 * lens.aperture, 0.5 * lens.thickness
    front, back = lens.first, lens.second
    # The seams between caps and rim overlap by a few ulps, so that no ray slips between.
    ulps = 8.0 * float(np.finfo(precision_types(precision).dtype).eps)
    low, high = -half + front.sag(radius), half + back.sag(radius)
    slack = ulps * (abs(low) + abs(high) + radius)
    return (
        centre, axis_frame(lens.axis), half,
        front.curvature, 1.0 + front.conic, back.curvature, 1.0 + back.conic,
        radius, radius * radius * (1.0 + ulps), low - slack, high + slack, prim,
    )


def _materials(
    scene: scenes.Scene,
    media: list[Medium],
    medium_of: list[int],
    air_powers: list[int],
    features: Features,
) -> list[tuple[int, int, int, int]]:
    """Each object's material, media outside and inside, and whether its boundary disperses."""
    varies = Subject(scene, tuple(media), tuple(air_powers)).varying_media
    rows = []
    for item, medium in zip(scene.objects, medium_of, strict=True):
        if isinstance(item.material, scenes.Dielectric):
            disperses = features.dispersion and (varies[medium] or varies[0])
            rows.append((int(DIELECTRIC), 0, medium, int(disperses)))
        elif isinstance(item.material, scenes.Lambertian):
            rows.append((int(LAMBERTIAN), 0, 0, 0))
        else:
            rows.append((int(ABSORBER), 0, 0, 0))
    return rows


def _fill_media(
    data: Any, media: list[Medium], air_powers: list[int], precision: str, device: str
) -> None:
    """Fill the dispersion coefficients and the knots and cubics of tables."""
    types, structs = precision_types(precision), make_scene_structs(precision)
    coefficients = np.zeros((len(media), DISPERSION_COEFFICIENTS))
    knots: list[FloatArray] = []
    cubics: list[FloatArray] = []
    rows: list[Row] = []
    for i, (medium, air_power) in enumerate(zip(media, air_powers, strict=True)):
        formula = medium.dispersion
        if isinstance(formula, Sellmeier):
            count = len(formula.b)
            coefficients[i, 0 : 2 * count : 2] = formula.b
            coefficients[i, 1 : 2 * count : 2] = formula.c_um2
            rows.append((int(SELLMEIER), 0, 0, air_power))
        elif isinstance(formula, Cauchy):
            coefficients[i, : len(formula.a)] = formula.a
            rows.append((int(CAUCHY), 0, 0, air_power))
        else:
            assert isinstance(formula, Tabulated)
            first = sum(len(k) for k in knots)
            knots.append(np.asarray(formula.knots_nm))
            cubics.append(np.vstack([formula.coefficients, np.zeros(4)]))
            rows.append((int(TABULATED), first, len(knots[-1]), air_power))
    data.media = struct_array(structs.Medium, rows, device)
    data.coefficients = wp.array(coefficients.astype(types.dtype), dtype=types.real, device=device)
    all_knots = np.concatenate([*knots, np.zeros(1)]).astype(types.dtype)
    all_cubics = np.vstack([*cubics, np.zeros((1, 4))]).astype(types.dtype)
    data.knots_nm = wp.array(all_knots, dtype=types.real, device=device)
    data.cubics = wp.array(all_cubics, dtype=types.real, device=device)
