"""Triangles from a file: PLY, OBJ, STL or GLB, read by trimesh."""

import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from scenes.fields import MAX_LENGTH_M, MIN_SIZE_M
from scenes.file_content import file_content
from scenes.shapes.mesh_claims import is_text_stl, refuse_false_claims
from scenes.shapes.surface import Surface

__all__ = ["MAX_TRIANGLES", "MESH_FORMATS", "NormalsChoice", "read_surface"]

MESH_FORMATS = ("ply", "obj", "stl", "glb")
"""Endings of files that can be read."""

MAX_TRIANGLES = 1 << 20

_MAX_BYTES = 64 * 1024 * 1024

NormalsChoice = Literal["file", "smooth", "flat"]


def read_surface(path: Path, unit: float, normals: NormalsChoice, *, turned: bool) -> Surface:
    """The triangles of a file.

    Args:
        path: of an existing file.
        unit: length of the file's unit [m].
        normals: "file": as the file has them, flat facets where it has none; "smooth": means over
            the triangles around each corner, sharp edges aside; "flat": facets.
        turned: the file's triangles run clockwise seen from outside.

    Raises:
        ValueError: it is no file of triangles that can be used; says why.
    """
    status = path.stat()
    return _read(path, (status.st_mtime_ns, status.st_size), unit, normals, turned)


@lru_cache(maxsize=32)
def _read(
    path: Path, _version: tuple[int, int], unit: float, normals: NormalsChoice, turned: bool
) -> Surface:
    kind = path.suffix.lower().removeprefix(".")
    if kind not in MESH_FORMATS:
        raise ValueError(f"its name must end in one of: {', '.join(MESH_FORMATS)}")
    content = file_content(path, _MAX_BYTES)
    try:
        refuse_false_claims(content, kind, MAX_TRIANGLES)
    except ValueError as error:
        raise ValueError(f"it is not a valid {kind.upper()} file: {error}") from None
    corners, corner_normals = _corners(content, kind)
    if not len(corners):
        raise ValueError("it holds no triangles")
    if not np.isfinite(corners).all():
        raise ValueError("it holds coordinates that are not finite numbers")
    _require_size(corners, unit)
    if normals != "file":
        corner_normals = None
    if turned:
        corners = corners[:, ::-1]
        corner_normals = None if corner_normals is None else corner_normals[:, ::-1]
    surface = _joined(corners * unit, corner_normals)
    return surface.smoothed() if normals == "smooth" else surface


def _require_size(corners: NDArray[np.float64], unit: float) -> None:
    """Refuse what is larger or smaller than a length in a scene may be.

    Raises:
        ValueError: it is.
    """
    farthest = float(np.abs(corners).max()) * unit
    if farthest > MAX_LENGTH_M:
        raise ValueError(
            f"it reaches {farthest:.6g} m from its origin; allowed: at most {MAX_LENGTH_M:g} m"
        )
    width = float(np.ptp(corners.reshape(-1, 3), axis=0).max()) * unit
    if width < MIN_SIZE_M:
        raise ValueError(f"it is {width:.6g} m wide; allowed: at least {MIN_SIZE_M:g} m")


def _corners(
    content: bytes, kind: str
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """(m, 3, 3) corners of all the triangles of a file's content, and their normals if it has any.

    Raises:
        ValueError: the content is not of this kind.
    """
    import io

    import trimesh

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            file = io.BytesIO(_plain(content, kind))
            scene = trimesh.load_scene(file, file_type=kind, process=False, skip_materials=True)
            _refuse_too_many(scene)
            parts = [_part(scene, node) for node in scene.graph.nodes_geometry]
    except _TooManyError as error:
        raise ValueError(str(error)) from None
    except Exception as error:  # a damaged file ends in any of Python's exceptions
        raise ValueError(f"it is not a valid {kind.upper()} file: {error}") from None
    parts = [part for part in parts if part is not None]
    if not parts:
        return np.zeros((0, 3, 3)), None
    corners = np.concatenate([corners for corners, _ in parts])
    if any(normals is None for _, normals in parts):
        return corners, None
    return corners, np.concatenate([normals for _, normals in parts])


def _plain(content: bytes, kind: str) -> bytes:
    """Text in UTF-8, whatever it was in: its numbers are ASCII, and all else does not count."""
    if kind == "obj" or (kind == "stl" and is_text_stl(content)):
        return content.decode("latin-1").encode("utf-8")
    return content


class _TooManyError(ValueError):
    """The file is right, but too large."""


def _refuse_too_many(scene: Any) -> None:
    """Refuse a scene with too many triangles in all of the places that its meshes are put in."""
    meshes = [scene.geometry[scene.graph[node][1]] for node in scene.graph.nodes_geometry]
    count = sum(len(getattr(mesh, "faces", ())) for mesh in meshes)
    if count > MAX_TRIANGLES:
        raise _TooManyError(f"it holds {count} triangles; allowed: at most {MAX_TRIANGLES}")


def _part(scene: Any, node: str) -> Any:
    """Corners and normals (None: the file has none) of one of a file's meshes, where it is put."""
    place, name = scene.graph[node]
    mesh = scene.geometry[name]
    if not hasattr(mesh, "faces"):
        return None  # points or lines
    linear = place[:3, :3]
    faces = np.asarray(mesh.faces, dtype=np.int64)
    if len(faces) and not (0 <= faces.min() and faces.max() < len(mesh.vertices)):
        raise ValueError(f"a triangle has a corner that is none of the {len(mesh.vertices)}")
    if np.linalg.det(linear) < 0.0:
        faces = faces[:, ::-1]  # mirrored
    corners = np.asarray(mesh.vertices, dtype=np.float64)[faces] @ linear.T + place[:3, 3]
    # Asked for its `vertex_normals`, a mesh without any would make some up.
    known = mesh._cache.cache.get("vertex_normals")
    if known is None or len(known) != len(mesh.vertices):
        return corners, None
    normals = np.asarray(known, dtype=np.float64)[faces] @ np.linalg.inv(linear)
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    if not (np.isfinite(lengths).all() and (lengths > 0.0).all()):
        return corners, None
    return corners, normals / lengths


def _joined(corners: NDArray[np.float64], normals: NDArray[np.float64] | None) -> Surface:
    """The surface: corners at the same point are one vertex, triangles of fewer than three gone."""
    points = corners.reshape(-1, 3) + 0.0  # -0.0 and 0.0 are the same place
    vertices, rows = _distinct(points)
    triangles = rows.reshape(-1, 3)
    a, b, c = triangles.T
    whole = (a != b) & (b != c) & (c != a)
    if not whole.any():
        raise ValueError("it holds no triangle of three different corners")
    flat = Surface(vertices, triangles[whole])
    if normals is None:
        return flat
    # Outside is where the winding says; a normal only says how the surface bends there.
    heights = np.einsum("mij,mj->mi", normals[whole], flat.facet_normals)
    outward = normals[whole] * np.where(heights < 0.0, -1.0, 1.0)[:, :, None]
    return Surface(flat.vertices, flat.triangles, outward)


def _distinct(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Different points (k, 3), sorted by x, y, z; and the row of each given one among them.

    What `numpy.unique` gives along an axis, in a third of the time.
    """
    order = np.lexsort(points.T[::-1])
    ordered = points[order]
    is_new = np.ones(len(points), dtype=bool)
    is_new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    rows = np.empty(len(points), dtype=np.int64)
    rows[order] = np.cumsum(is_new) - 1
    return ordered[is_new], rows
