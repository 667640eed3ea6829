"""Surfaces of triangles: their edges, parts, normals and volume.

A triangle's corners run counter-clockwise seen from outside. Reference for what closes a surface:
Botsch, Kobbelt, Pauly, Alliez & Lévy (2010), *Polygon Mesh Processing*, §1.3.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

__all__ = ["Seams", "Surface"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_CREASE_COSINE = float(np.cos(np.radians(40.0)))
"""An edge whose faces' normals differ by more is sharp: it parts smooth patches."""


@dataclass(frozen=True)
class Seams:
    """What keeps a surface from enclosing a volume.

    Attributes:
        open_edges: edges of one triangle only.
        crowded_edges: edges of more than two.
        turned_edges: edges whose two triangles disagree about which side is outside.
    """

    open_edges: int
    crowded_edges: int
    turned_edges: int

    @property
    def text(self) -> str:
        """What is wrong, in words; "" if nothing is."""
        found = (
            (self.open_edges, "open", "only one triangle has"),
            (self.crowded_edges, "crowded", "more than two triangles share"),
            (self.turned_edges, "turned", "two triangles of opposite winding share"),
        )
        return "; ".join(
            f"{count} {kind} edge{'' if count == 1 else 's'}, which {why}"
            for count, kind, why in found
            if count
        )


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles.

    Attributes:
        vertices: (k, 3) [m]; no two are the same point.
        triangles: (m, 3) rows of `vertices`, counter-clockwise seen from outside.
        corner_normals: (m, 3, 3) unit normals at each triangle's corners, or None: flat facets.
    """

    vertices: FloatArray
    triangles: IntArray
    corner_normals: FloatArray | None = None

    @cached_property
    def corners(self) -> FloatArray:
        """(m, 3, 3): of each triangle, its corners [m]."""
        return self.vertices[self.triangles]

    @cached_property
    def area_vectors(self) -> FloatArray:
        """(m, 3): outward normals as long as twice the triangles' areas [m²]."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return np.cross(b - a, c - a)

    @cached_property
    def facet_normals(self) -> FloatArray:
        """(m, 3) outward unit normals; 0 for a triangle without area."""
        lengths = np.linalg.norm(self.area_vectors, axis=1, keepdims=True)
        return _divided(self.area_vectors, lengths)

    @property
    def volume(self) -> float:
        """Enclosed by the surface, if it is closed [m³]; negative if it is inside out."""
        a, b, c = np.moveaxis(self.corners - self.vertices.mean(axis=0), 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    @cached_property
    def seams(self) -> Seams:
        """What keeps it from enclosing a volume."""
        _, _, counts, directions = self._edges
        return Seams(
            open_edges=int(np.count_nonzero(counts == 1)),
            crowded_edges=int(np.count_nonzero(counts > 2)),
            turned_edges=int(np.count_nonzero((counts == 2) & (directions != 0))),
        )

    @cached_property
    def neighbours(self) -> IntArray:
        """(m, 3): the triangle across each edge (corner i to i + 1), −1 where there is not one."""
        order, edge_of, counts, _ = self._edges
        found = np.full(edge_of.size, -1)
        firsts = np.concatenate([[0], np.cumsum(counts)[:-1]])[counts == 2]
        one, other = order[firsts], order[firsts + 1]
        found[one], found[other] = other // 3, one // 3
        return found.reshape(-1, 3)

    @cached_property
    def patches(self) -> IntArray:
        """(m,): numbers from 0 of the parts that sharp edges and borders part."""
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components

        count = len(self.triangles)
        here = np.repeat(np.arange(count), 3)
        there = self.neighbours.ravel()
        normals = self.facet_normals
        bend = np.einsum("ij,ij->i", normals[here], normals[there])
        joined = (there >= 0) & (bend >= _CREASE_COSINE)
        ones = np.ones(np.count_nonzero(joined), dtype=np.int8)
        graph = coo_matrix((ones, (here[joined], there[joined])), shape=(count, count))
        _, labels = connected_components(graph, directed=False)
        return np.asarray(labels, dtype=np.int64)

    def smoothed(self) -> "Surface":
        """The same with normals that are means over each patch: exact where it lies on a sphere.

        A facet with sides e₁ and e₂ at the corner counts as e₁ × e₂ / (|e₁|² |e₂|²) (Max 1999,
        "Weights for computing vertex normals from facet normals", Journal of Graphics Tools 4(2)).
        """
        sides2 = np.sum((np.roll(self.corners, -1, axis=1) - self.corners) ** 2, axis=2)
        weights = (sides2 * np.roll(sides2, 1, axis=1))[:, :, None]
        vectors = np.repeat(self.area_vectors[:, None, :], 3, axis=1)
        weighted = _divided(vectors, weights).reshape(-1, 3)
        keys = self.patches[:, None] * len(self.vertices) + self.triangles
        _, rows = np.unique(keys.ravel(), return_inverse=True)
        sums = np.zeros((int(rows.max()) + 1, 3))
        np.add.at(sums, rows, weighted)
        normals = _divided(sums, np.linalg.norm(sums, axis=1, keepdims=True))
        return Surface(self.vertices, self.triangles, normals[rows].reshape(-1, 3, 3))

    def moved(self, rotation: FloatArray) -> "Surface":
        """The same, turned by a rotation matrix (3, 3)."""
        normals = None if self.corner_normals is None else self.corner_normals @ rotation.T
        return Surface(self.vertices @ rotation.T, self.triangles, normals)

    @cached_property
    def _edges(self) -> tuple[IntArray, IntArray, IntArray, IntArray]:
        """Triangles' sides sorted by edge, the edge of each side, and of each edge two sums.

        Side 3t + i is that from corner i of triangle t to the next. The sums are how many
        triangles the edge has, and in which direction they run along it (0: opposite ones).
        """
        start = self.triangles.ravel()
        end = np.roll(self.triangles, -1, axis=1).ravel()
        keys = np.minimum(start, end) * len(self.vertices) + np.maximum(start, end)
        _, edge_of, counts = np.unique(keys, return_inverse=True, return_counts=True)
        directions = np.bincount(edge_of, weights=np.sign(end - start)).astype(np.int64)
        return np.argsort(edge_of, kind="stable"), edge_of, counts, directions


def _divided(vectors: FloatArray, lengths: FloatArray) -> FloatArray:
    """Vectors over their lengths; 0 where that is 0."""
    units = np.zeros_like(vectors)
    np.divide(vectors, lengths, out=units, where=lengths > 0.0)
    return units
