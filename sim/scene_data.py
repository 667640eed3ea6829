"""A scene as device arrays, in a local frame.

The scene is recentred on its finite objects, so that a bench a kilometre from its file's origin
is traced with the digits of one at the origin. Results that carry positions add `origin` back.
"""

import itertools
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from scenes.frames import frame_about
from sim.device_arrays import struct_array
from sim.features import Features, find_features
from sim.mesh_data import PlacedMesh, compile_meshes
from sim.method import Method
from sim.precision import precision_types
from sim.scene_media import SceneMedia, collect_media
from sim.scene_neighbours import (
    find_neighbours,
    rank_media,
    refuse_merged_sheets,
    touch_distance,
)
from sim.scene_optics import fill_optics
from sim.scene_structs import (
    ABSORBER,
    DIELECTRIC,
    LAMBERTIAN,
    METAL,
    MIRROR,
    POLARISER,
    SHAPE_FLAT,
    SHAPE_LENS,
    SHAPE_MESH,
    SHAPE_POLYHEDRON,
    SHAPE_SPHERE,
    make_scene_structs,
)
from spectra import Medium

__all__ = ["CompiledScene", "bounding_radius", "compile_scene", "find_origin"]

FloatArray = npt.NDArray[np.float64]
Row = tuple[Any, ...]

_NEARNESS = 4.0
"""Objects whose shapes come within this many touches are asked at each vertex: more than one, for
the rounding of their extents."""


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
        """Radius about the local origin that holds every finite object and sensor [m].

        It is 1 if there is none.
        """
        return bounding_radius(self.scene, self.origin, with_sensors=True)


def find_origin(scene: scenes.Scene) -> FloatArray:
    """Centre of the finite objects' bounding box, (3,) [m].

    Without any it is that of the sensors, and without these the world's origin.
    """
    spheres = [
        item.shape.bounding_sphere()
        for item in scene.objects
        if not isinstance(item.shape, scenes.Plane)
    ]
    spheres = spheres or [sensor.shape.bounding_sphere() for sensor in scene.sensors]
    if not spheres:
        return np.zeros(3)
    low = np.min([np.asarray(centre) - radius for centre, radius in spheres], axis=0)
    high = np.max([np.asarray(centre) + radius for centre, radius in spheres], axis=0)
    middle: FloatArray = 0.5 * (low + high)
    return middle


def bounding_radius(
    scene: scenes.Scene, origin: FloatArray, *, with_sensors: bool = False
) -> float:
    """Radius about `origin` that holds every finite object [m]; 1 if there is none.

    Args:
        scene: the scene.
        origin: (3,) [m].
        with_sensors: sensors count as objects: light must be able to reach them.
    """
    items = (*scene.objects, *(scene.sensors if with_sensors else ()))
    reach = [
        float(np.linalg.norm(np.subtract(centre, origin))) + radius
        for centre, radius in (
            item.shape.bounding_sphere()
            for item in items
            if not isinstance(item.shape, scenes.Plane)
        )
    ]
    return max(reach, default=1.0)


def compile_scene(
    scene: scenes.Scene,
    *,
    precision: str = "float64",
    device: str = "cpu",
    features: Features | None = None,
    method: Method | None = None,
    polarisation: str = "auto",
) -> CompiledScene:
    """Lay `scene` out as device arrays.

    Args:
        scene: a validated scene.
        precision: what the kernels compute with.
        device: where the arrays live.
        features: what the kernels must handle; None: all that could change anything.
        method: how light is followed; None: as a rendering does, or as `features` say.
        polarisation: the setting of this name, where `features` are None.
    """
    origin = find_origin(scene)
    media = collect_media(scene)
    if features is None:
        features = find_features(
            scene, media.media, media.air_powers, polarisation=polarisation
        )
    if method is not None:
        features = replace(features, method=method)
    structs = make_scene_structs(precision)
    data = structs.Scene()
    places = _fill_shapes(data, scene, origin, precision, device)
    touch = touch_distance(bounding_radius(scene, origin), precision)
    refuse_merged_sheets(scene, touch, precision)
    near: list[list[int]] = [[] for _ in scene.objects]
    if features.interfaces:
        near = find_neighbours(scene, _NEARNESS * touch)
    bodies = _bodies(media, scene, near, disperses=features.dispersion)
    rows = [(*place, *body) for place, body in zip(places, bodies, strict=True)]
    data.bodies = struct_array(structs.Body, rows, device)
    neighbours = np.array([*itertools.chain(*near), -1], dtype=np.int32)
    data.neighbours = wp.array(neighbours, dtype=int, device=device)
    data.touch = touch
    data.absorbing_axes = wp.array(
        _absorbing_axes(scene), dtype=structs.vec3, device=device
    )
    fill_optics(data, media, precision, device, disperses=features.dispersion)
    return CompiledScene(scene, precision, device, features, media.media, origin, data)


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
    meshes: list[PlacedMesh] = []
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
            receives = isinstance(item.material, scenes.Lambertian)
            meshes.append(PlacedMesh(shape, centre, prim, receives))
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


def _bodies(
    media: SceneMedia, scene: scenes.Scene, near: list[list[int]], *, disperses: bool
) -> list[Row]:
    """Each object's columns of a Body behind its shape's, see `sim.scene_structs`."""
    rows: list[Row] = []
    ranks = rank_media(scene)
    first = 0
    for prim, item in enumerate(scene.objects):
        material, medium, finish = item.material, media.medium_of[prim], media.finish_of[prim]
        varies = False
        if isinstance(material, scenes.Dielectric):
            kind = DIELECTRIC
            varies = medium != 0 and (media.varies[medium] or media.varies[0])
        elif isinstance(material, scenes.Mirror | scenes.Metal):
            kind = MIRROR if isinstance(material, scenes.Mirror) else METAL
            varies = material.is_coloured
        elif isinstance(material, scenes.Polariser):
            kind = POLARISER
        else:
            kind = LAMBERTIAN if isinstance(material, scenes.Lambertian) else ABSORBER
        count = len(near[prim])
        rows.append(
            (int(kind), medium, ranks[prim], finish, int(disperses and varies), first, count)
        )
        first += count
    return rows


def _absorbing_axes(scene: scenes.Scene) -> FloatArray:
    """(n, 3), each object's absorbing axis, 0 where it has none; never of length zero."""
    axes = np.zeros((max(1, len(scene.objects)), 3))
    for prim, item in enumerate(scene.objects):
        if isinstance(item.material, scenes.Polariser):
            assert isinstance(item.shape, scenes.Rectangle | scenes.Disk | scenes.Plane)
            axes[prim] = item.material.absorbing_axis(item.shape.normal)
    return axes
