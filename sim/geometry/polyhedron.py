"""Ray and convex polyhedron, given as planes `normal · x = offset` about its own centre.

Reference:
    Haines (1991), "Fast ray–convex polyhedron intersection", *Graphics Gems II*, §V.1.
"""

from typing import Any

import warp as wp

__all__ = ["intersect_polyhedron"]


@wp.func
def intersect_polyhedron(
    origin: Any, direction: Any, planes: Any, first: int, count: int, leaving_face: int
):
    """Distance and face (index into `planes`) of the first hit, or (−1, −1).

    Args:
        origin: relative to the polyhedron's centre.
        direction: unit.
        planes: array of structs with `normal` and `offset`, one a face.
        first: the polyhedron's first row.
        count: how many faces it has.
        leaving_face: the row of the face the ray has just left, −1 for none. Inward such a ray
            can only go out through another face; outward it never meets a convex body again.
    """
    zero = type(origin[0])(0.0)
    t_enter = -type(origin[0])(wp.inf)
    t_exit = type(origin[0])(wp.inf)
    face_enter = int(-1)
    face_exit = int(-1)
    leaves = leaving_face >= first and leaving_face < first + count
    # `while`, not `for`: Warp compiles a range of run-time bounds to an iterator whose sign and
    # stride are tested anew at every turn.
    face = int(first)
    while face < first + count:
        plane = planes[face]
        approach = wp.dot(plane.normal, direction)
        distance = plane.offset - wp.dot(plane.normal, origin)
        if face == leaving_face:
            if approach >= zero:
                t_exit = -type(origin[0])(wp.inf)
        elif approach < zero:
            t = distance / approach
            if t > t_enter:
                t_enter = t
                face_enter = face
        elif approach > zero:
            t = distance / approach
            if t < t_exit:
                t_exit = t
                face_exit = face
        elif distance < zero and not leaves:
            # Parallel to a face and beyond it: a miss. (A start on an edge can lie beyond one of
            # its faces by rounding, and is inside all the same.)
            t_exit = -type(origin[0])(wp.inf)
        face += 1

    if leaves:
        if face_exit < 0 or t_exit == -type(origin[0])(wp.inf):
            return type(origin[0])(-1.0), -1
        # On an edge rounding can put the exit a hair behind the start: it is here.
        return wp.max(t_exit, zero), face_exit
    if t_enter > t_exit or t_exit < zero:
        return type(origin[0])(-1.0), -1
    if t_enter >= zero:
        return t_enter, face_enter
    return t_exit, face_exit
