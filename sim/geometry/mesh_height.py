"""Where a point is: inside a mesh, on it or outside.

Reference:
    Ericson (2005), *Real-Time Collision Detection*, §5.1.5: the nearest point of a triangle.
"""

from typing import Any

import warp as wp

from sim.geometry.mesh import area_vector, facet_normal, intersect_mesh

__all__ = ["height_above_mesh"]


@wp.func
def nearest_on_triangle(point: Any, triangle: Any):
    """Vector from `point` to the nearest point of a triangle."""
    zero = type(point[0])(0.0)
    one = type(point[0])(1.0)
    ab = triangle.b - triangle.a
    ac = triangle.c - triangle.a
    a = triangle.a - point
    normal = wp.cross(ab, ac)
    area2 = wp.dot(normal, normal)
    b = triangle.b - point
    c = triangle.c - point
    if area2 > zero:
        foot = normal * (wp.dot(a, normal) / area2)
        inside = wp.dot(wp.cross(b - foot, c - foot), normal) >= zero
        inside = inside and wp.dot(wp.cross(c - foot, a - foot), normal) >= zero
        if inside and wp.dot(wp.cross(a - foot, b - foot), normal) >= zero:
            return foot
    best = a
    for side in range(3):
        start = wp.where(side == 0, a, wp.where(side == 1, b, c))
        end = wp.where(side == 0, b, wp.where(side == 1, c, a))
        along = end - start
        length2 = wp.dot(along, along)
        s = zero
        if length2 > zero:
            s = wp.clamp(-wp.dot(start, along) / length2, zero, one)
        candidate = start + along * s
        if wp.dot(candidate, candidate) < wp.dot(best, best):
            best = candidate
    return best


@wp.func
def height_above_mesh(meshes: Any, mesh: Any, point: Any, tolerance: Any):
    """Height [m] above a mesh, the nearest triangle and its outward normal; see `sim.surroundings`.

    Only on the surface it is a distance: elsewhere it is infinite, negative inside a closed mesh.

    Args:
        meshes: struct with the arrays of all meshes.
        mesh: struct of this one.
        point: relative to the mesh's centre.
        tolerance: distance up to which a point is on the surface [m].
    """
    zero = type(tolerance)(0.0)
    best = tolerance * tolerance
    face = int(-1)
    stack = wp.zeros(shape=(32,), dtype=int)
    depth = int(0)
    node = int(0)
    while node >= 0:
        box = meshes.nodes[mesh.first_node + node]
        gap = wp.max(wp.max(box.low - point, point - box.high), type(point)())
        if wp.dot(gap, gap) <= best:
            if node < mesh.inner_nodes:
                stack[depth] = node + node + 2
                depth += 1
                node = node + node + 1
                continue
            row = int(mesh.first_triangle + (node - mesh.inner_nodes) * mesh.leaf_size)
            stop = row + mesh.leaf_size
            while row < stop:
                offset = nearest_on_triangle(point, meshes.triangles[row])
                distance2 = wp.dot(offset, offset)
                if distance2 <= best:
                    best = distance2
                    face = meshes.triangles[row].face
                row += 1
        node = -1
        if depth > 0:
            depth -= 1
            node = stack[depth]
    normal = type(point)()
    if face >= 0:
        return zero, face, facet_normal(meshes, face)
    if mesh.closed == 0:
        return type(tolerance)(wp.inf), face, normal
    # Any ray tells; this one is parallel to nothing that people build.
    direction = wp.normalize(
        type(point)(
            type(tolerance)(0.5773), type(tolerance)(0.4142), type(tolerance)(0.7236)
        )
    )
    t, face = intersect_mesh(meshes, mesh, point, direction, -1, type(tolerance)(wp.inf))
    if t >= zero and wp.dot(direction, area_vector(meshes.triangles[face])) > zero:
        return -type(tolerance)(wp.inf), face, normal
    return type(tolerance)(wp.inf), face, normal
