"""Meshes as device arrays."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from scenes.shapes import Surface, Triangulated
from sim.device_arrays import struct_array
from sim.mesh_borders import distance_to_border, neighbours_in_patch
from sim.mesh_structs import make_mesh_structs
from sim.mesh_tree import MeshTree, build_tree
from sim.photons.photon_structs import MAX_PARTS
from sim.precision import precision_types

__all__ = ["PlacedMesh", "compile_meshes"]

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_SLACK_ULPS = 64.0
_EDGE_ULPS = 8.0
"""Units in the last place: by which points are off their plane, and products of coordinates."""


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh among a scene's objects.

    Attributes:
        shape: of the object.
        centre: (3,) its position in the local frame [m].
        prim: number of the object.
        receives: whether photons are gathered on it.
    """

    shape: Triangulated
    centre: FloatArray
    prim: int
    receives: bool = True


def compile_meshes(placed: list[PlacedMesh], *, precision: str, device: str) -> Any:
    """The device-side Meshes struct.

    Args:
        placed: the meshes.
        precision: what the kernels compute with.
        device: where the arrays live.
    """
    structs, types = make_mesh_structs(precision), precision_types(precision)
    eps = float(np.finfo(types.dtype).eps)
    rows: list[Any] = []
    nodes, triangles, borders, normals = (_Blocks() for _ in range(4))
    for one in placed:
        surface = one.shape.surface()
        tree = build_tree(surface.corners)
        reach = float(np.abs(surface.vertices).max())
        is_smooth = surface.corner_normals is not None
        rows.append((
            one.centre, nodes.count, tree.inner_nodes, triangles.count, tree.leaf_size,
            normals.count if is_smooth else -1, int(one.shape.is_closed),
            _SLACK_ULPS * eps * reach, _EDGE_ULPS * eps, one.prim,
        ))  # fmt: skip
        _, first, rows_of = np.unique(tree.order, return_index=True, return_inverse=True)
        faces = triangles.count + first[rows_of]
        if one.receives:
            borders.fill_up(triangles.count, structs.Border.numpy_dtype())
            borders.add(_border_rows(structs.Border, surface, tree.order, faces))
        nodes.add(_box_rows(structs.Box, tree, 8.0 * eps * reach))
        triangles.add(_triangle_rows(structs.Triangle, surface, tree.order, faces))
        if surface.corner_normals is not None:
            normals.add(surface.corner_normals[tree.order].reshape(-1, 3).astype(types.dtype))
    data = structs.Meshes()
    data.rows = struct_array(structs.Mesh, rows, device)
    data.nodes = _device_array(structs.Box, nodes.joined(), device)
    data.triangles = _device_array(structs.Triangle, triangles.joined(), device)
    data.borders = _device_array(structs.Border, borders.joined(), device)
    data.corner_normals = _device_array(types.vec3, normals.joined(), device)
    data.count = len(rows)
    return data


def _box_rows(struct: Any, tree: MeshTree, margin: float) -> npt.NDArray[Any]:
    """Boxes, wider by more than rounding to fewer digits takes off."""
    boxes = np.zeros(len(tree.low), dtype=struct.numpy_dtype())
    boxes["low"], boxes["high"] = tree.low - margin, tree.high + margin
    return boxes


def _triangle_rows(
    struct: Any, surface: Surface, order: IntArray, faces: IntArray
) -> npt.NDArray[Any]:
    """Triangles in the leaves' order."""
    block = np.zeros(len(order), dtype=struct.numpy_dtype())
    corners = surface.corners[order]
    corners[order < 0] = corners[order < 0][:, :1]  # a point, which no ray meets
    block["a"], block["b"], block["c"] = np.moveaxis(corners, 1, 0)
    block["patch"] = surface.patches[order] % MAX_PARTS  # more than that share numbers
    block["face"] = faces
    return block


def _border_rows(
    struct: Any, surface: Surface, order: IntArray, faces: IntArray
) -> npt.NDArray[Any]:
    """How far from its patch's border each triangle is, and what is across its sides."""
    block = np.zeros(len(order), dtype=struct.numpy_dtype())
    face_of = np.zeros(len(surface.triangles), dtype=np.int64)
    face_of[order[order >= 0]] = faces[order >= 0]
    there = neighbours_in_patch(surface)
    block["clearance"] = distance_to_border(surface)[order]
    block["across"] = np.where(there >= 0, face_of[there], -1)[order]
    return block


class _Blocks:
    """Arrays that are going to be one."""

    def __init__(self) -> None:
        self.count = 0
        self._blocks: list[npt.NDArray[Any]] = []

    def add(self, block: npt.NDArray[Any]) -> None:
        self._blocks.append(block)
        self.count += len(block)

    def fill_up(self, count: int, dtype: npt.DTypeLike) -> None:
        """Add rows of zeros until there are `count`."""
        if count > self.count:
            self.add(np.zeros(count - self.count, dtype=dtype))

    def joined(self) -> npt.NDArray[Any] | None:
        if not self._blocks:
            return None
        whole = np.empty((self.count, *self._blocks[0].shape[1:]), self._blocks[0].dtype)
        return np.concatenate(self._blocks, out=whole)  # which keeps the gaps between its fields


def _device_array(dtype: Any, host: npt.NDArray[Any] | None, device: str) -> Any:
    """A device array; never of length zero: see `struct_array`."""
    if host is None:
        return wp.zeros(1, dtype=dtype, device=device)
    return wp.array(host, dtype=dtype, device=device)
