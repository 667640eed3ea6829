"""Meshes as device arrays."""

from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from scenes import Triangulated
from sim.device_arrays import struct_array
from sim.mesh_structs import make_mesh_structs
from sim.mesh_tree import build_tree
from sim.photons.photon_structs import MAX_PARTS
from sim.precision import precision_types

__all__ = ["compile_meshes"]

FloatArray = npt.NDArray[np.float64]

_SLACK_ULPS = 64.0
_EDGE_ULPS = 8.0
"""Units in the last place: by which points are off their plane, and products of coordinates."""


def compile_meshes(
    shapes: list[tuple[Triangulated, FloatArray, int]], *, precision: str, device: str
) -> Any:
    """The device-side Meshes struct.

    Args:
        shapes: of each mesh its shape, its position in the local frame (3,) [m], and the number of
            its object.
        precision: what the kernels compute with.
        device: where the arrays live.
    """
    structs, types = make_mesh_structs(precision), precision_types(precision)
    eps = float(np.finfo(types.dtype).eps)
    rows: list[Any] = []
    nodes, triangles, normals = (_Blocks() for _ in range(3))
    for shape, centre, prim in shapes:
        surface = shape.surface()
        tree = build_tree(surface.corners)
        is_filler = tree.order < 0
        reach = float(np.abs(surface.vertices).max())
        boxes = np.zeros(len(tree.low), dtype=structs.Box.numpy_dtype())
        # Wider by more than rounding to fewer digits takes off.
        boxes["low"], boxes["high"] = tree.low - 8.0 * eps * reach, tree.high + 8.0 * eps * reach
        block = np.zeros(len(tree.order), dtype=structs.Triangle.numpy_dtype())
        corners = surface.corners[tree.order]
        corners[is_filler] = corners[is_filler][:, :1]  # a point, which no ray meets
        block["a"], block["b"], block["c"] = np.moveaxis(corners, 1, 0)
        block["patch"] = surface.patches[tree.order] % MAX_PARTS  # more than that share numbers
        _, first, rows_of = np.unique(tree.order, return_index=True, return_inverse=True)
        block["face"] = triangles.count + first[rows_of]
        is_smooth = surface.corner_normals is not None
        rows.append((
            centre, nodes.count, tree.inner_nodes, triangles.count, tree.leaf_size,
            normals.count if is_smooth else -1, int(shape.is_closed), _SLACK_ULPS * eps * reach,
            _EDGE_ULPS * eps, prim,
        ))  # fmt: skip
        nodes.add(boxes)
        triangles.add(block)
        if surface.corner_normals is not None:
            normals.add(surface.corner_normals[tree.order].reshape(-1, 3).astype(types.dtype))
    data = structs.Meshes()
    data.rows = struct_array(structs.Mesh, rows, device)
    data.nodes = _device_array(structs.Box, nodes.joined(), device)
    data.triangles = _device_array(structs.Triangle, triangles.joined(), device)
    data.corner_normals = _device_array(types.vec3, normals.joined(), device)
    data.count = len(rows)
    return data


class _Blocks:
    """Arrays that are going to be one."""

    def __init__(self) -> None:
        self.count = 0
        self._blocks: list[npt.NDArray[Any]] = []

    def add(self, block: npt.NDArray[Any]) -> None:
        self._blocks.append(block)
        self.count += len(block)

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
