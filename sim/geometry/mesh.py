"""Ray and mesh: triangles in a tree of boxes, met in the digits that tracing is done with.

`wp.Mesh` answers in float32, accepts what lies at distance 0, and cannot be told which triangle a
ray has just left. So the tree is our own: complete and binary, node i above nodes 2i + 1 and
2i + 2, with as many triangles in each leaf. A ray goes to the nearer child first.

Neighbours share their corners to the last bit and judge their common edge by the same products,
so no ray slips between them. A ray that has left a closed surface inward can only meet it from
inside next, and outward from outside: on edges and corners too.

References:
    Woop, Benthin & Wald (2013), "Watertight ray/triangle intersection", JCGT 2(1): the triangle
    sheared into the ray's frame.
"""

from typing import Any

import warp as wp

__all__ = ["area_vector", "facet_normal", "intersect_mesh", "mesh_normal"]

@wp.func
def area_vector(triangle: Any):
    """Outward normal, twice as long as the triangle's area."""
    return wp.cross(triangle.b - triangle.a, triangle.c - triangle.a)


@wp.func
def facet_normal(meshes: Any, face: int):
    """Outward unit normal of a triangle's plane."""
    return wp.normalize(area_vector(meshes.triangles[face]))


@wp.func
def inverse(x: Any):
    """1/x, and something huge of the same sign in place of infinity, whose product with 0 is 0."""
    tiny = type(x)(1.0e-30)
    if wp.abs(x) < tiny:
        return type(x)(1.0) / wp.where(x < type(x)(0.0), -tiny, tiny)
    return type(x)(1.0) / x


@wp.func
def enter_box(box: Any, origin: Any, inverses: Any, t_low: Any, t_high: Any):
    """Distance at which a ray enters a box, infinite where it misses it between the limits."""
    one = wp.cw_mul(box.low - origin, inverses)
    other = wp.cw_mul(box.high - origin, inverses)
    first = wp.min(one, other)
    last = wp.max(one, other)
    t_in = wp.max(wp.max(first[0], first[1]), wp.max(first[2], t_low))
    t_out = wp.min(wp.min(last[0], last[1]), wp.min(last[2], t_high))
    if t_in > t_out:
        return type(t_low)(wp.inf)
    return t_in


@wp.func
def shear_rows(direction: Any):
    """Two rows whose products with a vector are 0 along the ray: coordinates across it."""
    zero = type(direction[0])(0.0)
    one = type(direction[0])(1.0)
    x = wp.abs(direction[0])
    y = wp.abs(direction[1])
    z = wp.abs(direction[2])
    across = type(direction)(one, zero, -direction[0] / direction[2])
    up = type(direction)(zero, one, -direction[1] / direction[2])
    if x >= y and x >= z:
        across = type(direction)(-direction[1] / direction[0], one, zero)
        up = type(direction)(-direction[2] / direction[0], zero, one)
    elif y >= z:
        across = type(direction)(one, -direction[0] / direction[1], zero)
        up = type(direction)(zero, -direction[2] / direction[1], one)
    return across, up


@wp.func
def edge_side(x0: Any, y0: Any, x1: Any, y1: Any, rounding: Any):
    """Which side of an edge the ray passes: 1 or −1, and 0 on it, to rounding."""
    one = x0 * y1
    other = y0 * x1
    if wp.abs(one - other) <= rounding * (wp.abs(one) + wp.abs(other)):
        return 0
    return wp.where(one > other, 1, -1)


@wp.func
def meets_triangle(triangle: Any, origin: Any, across: Any, up: Any, rounding: Any):
    """Whether the ray's line passes through a triangle, its edges included."""
    a = triangle.a - origin
    b = triangle.b - origin
    c = triangle.c - origin
    ax = wp.dot(across, a)
    ay = wp.dot(up, a)
    bx = wp.dot(across, b)
    by = wp.dot(up, b)
    cx = wp.dot(across, c)
    cy = wp.dot(up, c)
    u = edge_side(bx, by, cx, cy, rounding)
    v = edge_side(cx, cy, ax, ay, rounding)
    w = edge_side(ax, ay, bx, by, rounding)
    return (u >= 0 and v >= 0 and w >= 0) or (u <= 0 and v <= 0 and w <= 0)


@wp.func
def reaches_ahead(triangle: Any, origin: Any, ahead: Any, slack: Any):
    """Whether a triangle right at the start is in the way, not the other side of an edge.

    It is where it lies ahead of the face that the ray has left.
    """
    a = wp.dot(triangle.a - origin, ahead)
    b = wp.dot(triangle.b - origin, ahead)
    c = wp.dot(triangle.c - origin, ahead)
    return wp.max(a, wp.max(b, c)) > slack


@wp.func
def intersect_mesh(
    meshes: Any, mesh: Any, origin: Any, direction: Any, leaving_face: int, t_high: Any
):
    """Distance and triangle (row of `meshes.triangles`) of the first hit, or (−1, −1).

    Args:
        meshes: struct with the arrays of all meshes' nodes and triangles.
        mesh: struct of this one.
        origin: relative to the mesh's centre.
        direction: unit.
        leaving_face: the triangle that the ray has just left, −1 for none.
        t_high: what is farther does not matter.
    """
    zero = type(t_high)(0.0)
    t_low = zero
    way = int(0)  # 1: only outward through the surface, −1: only inward
    ahead = type(direction)()  # the side of the face just left that the ray is on
    if leaving_face >= 0 and mesh.closed == 1:
        way = -1
        ahead = facet_normal(meshes, leaving_face)
        if wp.dot(direction, ahead) < zero:
            way = 1
            ahead = -ahead
        # By rounding, a start on an edge can lie a hair beyond the next triangle: it is there.
        t_low = -mesh.slack
    inverses = type(origin)(
        inverse(direction[0]), inverse(direction[1]), inverse(direction[2])
    )
    across, up = shear_rows(direction)
    nearest = t_high
    face = int(-1)
    stack = wp.zeros(shape=(32,), dtype=int)
    depth = int(0)
    node = int(0)
    if enter_box(meshes.nodes[mesh.first_node], origin, inverses, t_low, nearest) >= type(t_high)(
        wp.inf
    ):
        return type(t_high)(-1.0), -1
    while node >= 0:
        if node < mesh.inner_nodes:
            left = node + node + 1
            t_left = enter_box(
                meshes.nodes[mesh.first_node + left], origin, inverses, t_low, nearest
            )
            t_right = enter_box(
                meshes.nodes[mesh.first_node + left + 1], origin, inverses, t_low, nearest
            )
            near = left
            far = left + 1
            if t_right < t_left:
                near = left + 1
                far = left
            if wp.max(t_left, t_right) < type(t_high)(wp.inf):
                stack[depth] = far
                depth += 1
            if wp.min(t_left, t_right) < type(t_high)(wp.inf):
                node = near
                continue
        else:
            row = int(mesh.first_triangle + (node - mesh.inner_nodes) * mesh.leaf_size)
            stop = row + mesh.leaf_size
            while row < stop:
                triangle = meshes.triangles[row]
                if triangle.face != leaving_face and meets_triangle(
                    triangle, origin, across, up, mesh.rounding
                ):
                    normal = area_vector(triangle)
                    approach = wp.dot(direction, normal)
                    if approach != zero and (way == 0 or (approach > zero) == (way == 1)):
                        t = wp.dot(triangle.a - origin, normal) / approach
                        if t >= t_low and t < nearest:
                            near_by = way != 0 and t <= mesh.slack
                            if not near_by or reaches_ahead(triangle, origin, ahead, mesh.slack):
                                nearest = t
                                face = triangle.face
                row += 1
        node = -1
        if depth > 0:
            depth -= 1
            node = stack[depth]
    if face < 0:
        return type(t_high)(-1.0), -1
    return wp.max(nearest, zero), face


@wp.func
def mesh_normal(meshes: Any, mesh: Any, face: int, point: Any, direction: Any):
    """Outward unit normal at a point of a triangle, smooth if the mesh is.

    Where a smooth normal would show the ray the surface's other side, it is the facet's.

    Args:
        meshes: struct with the arrays of all meshes.
        mesh: struct of this one.
        face: the triangle.
        point: relative to the mesh's centre.
        direction: of the ray that meets it.
    """
    zero = type(point[0])(0.0)
    triangle = meshes.triangles[face]
    flat = wp.normalize(area_vector(triangle))
    if mesh.first_normal < 0:
        return flat
    a = triangle.a - point
    b = triangle.b - point
    c = triangle.c - point
    row = mesh.first_normal + 3 * (face - mesh.first_triangle)
    smooth = meshes.corner_normals[row] * wp.max(wp.dot(wp.cross(b, c), flat), zero)
    smooth += meshes.corner_normals[row + 1] * wp.max(wp.dot(wp.cross(c, a), flat), zero)
    smooth += meshes.corner_normals[row + 2] * wp.max(wp.dot(wp.cross(a, b), flat), zero)
    if wp.dot(direction, smooth) * wp.dot(direction, flat) > zero:
        return wp.normalize(smooth)
    return flat
