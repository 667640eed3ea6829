"""The device-side layout of meshes."""

import functools
from types import SimpleNamespace

import warp as wp

from sim.precision import precision_types

__all__ = ["make_mesh_structs"]


@functools.cache
def make_mesh_structs(precision: str) -> SimpleNamespace:
    """Structs of one precision: Box, Triangle, Border, Mesh, and Meshes: the arrays of all.

    Triangle: its corners; the `patch` that it is of, see `scenes.shapes.surface`; and, since a
    large triangle has several rows, the first of them, its `face`.

    Border, one a triangle: `clearance`, no more than the distance [m] of any of its points to where
    its patch ends; and the `face` across each side that is of the same patch, else −1.

    Mesh: `centre`, which its coordinates are relative to; its tree, with `inner_nodes` nodes above
    its leaves, and `leaf_size` triangles in each of those, in the leaves' order; `first_normal`,
    the row of its first corner's normal, or −1 for facets; `closed`, 1 if it encloses a volume;
    `slack`, the distance that rounding can be wrong by; `rounding`, that of products, relative.
    """
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3

    @wp.struct
    class Box:
        low: vec3
        high: vec3

    @wp.struct
    class Triangle:
        a: vec3
        b: vec3
        c: vec3
        patch: int
        face: int

    @wp.struct
    class Border:
        clearance: real
        across: wp.vec3i

    @wp.struct
    class Mesh:
        centre: vec3
        first_node: int
        inner_nodes: int
        first_triangle: int
        leaf_size: int
        first_normal: int
        closed: int
        slack: real
        rounding: real
        prim: int

    @wp.struct
    class Meshes:
        rows: wp.array(dtype=Mesh)
        nodes: wp.array(dtype=Box)
        triangles: wp.array(dtype=Triangle)
        borders: wp.array(dtype=Border)
        corner_normals: wp.array(dtype=vec3)
        count: int

    return SimpleNamespace(
        Box=Box, Triangle=Triangle, Border=Border, Mesh=Mesh, Meshes=Meshes
    )
