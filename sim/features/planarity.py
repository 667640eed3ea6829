"""When all planes of incidence along a path are one, so that s and p never mix.

That is so, whatever the path, at spheres about one centre (which with the ray makes the plane) and
at parallel flats (their normal does). For what lamps send it is so, besides, on two benches: where
parallel beams run in a plane that holds the normals of all faces, or is perpendicular to those it
does not hold and never meets; and where everything is round about one axis, and light starts on
it or runs along it.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

import scenes
from scenes.emitters import AnyEmitter
from scenes.shapes import Shape

__all__ = ["planarity"]

FloatArray = npt.NDArray[np.float64]
Lines = list[tuple[FloatArray, FloatArray]]

_ALIGNED = 1e-9
"""Directions this near are one, and offsets this small, relative, are none: what a frame turns by
on such a path is as little, and its effect is the square."""


def planarity(scene: scenes.Scene, *, from_anywhere: bool) -> str | None:
    """Why every path has one plane of incidence; None if that is not known.

    Args:
        scene: the scene.
        from_anywhere: whether any ray may come, from the eye or from a diffuse surface, and not
            the lamps' only.
    """
    shapes = [item.shape for item in scene.objects if scenes.is_specular(item.material)]
    if _about_one_centre(shapes):
        return "all that refracts or reflects are spheres about one centre"
    if _parallel_flats(shapes):
        return "all that reflects is flat and parallel"
    if from_anywhere:
        return None
    if _in_one_plane(shapes, scene.emitters):
        return "parallel beams run in the plane of all normals"
    if _about_one_axis(shapes, scene.emitters):
        return "everything is round about one axis, and light starts on it or runs along it"
    return None


def _about_one_centre(shapes: Sequence[Shape]) -> bool:
    spheres = [one for one in shapes if isinstance(one, scenes.Sphere)]
    if len(spheres) != len(shapes) or not spheres:
        return False
    offsets = np.array([one.position for one in spheres]) - spheres[0].position
    least = min(one.radius for one in spheres)
    return bool(np.max(np.abs(offsets)) <= _ALIGNED * least)


def _parallel_flats(shapes: Sequence[Shape]) -> bool:
    kinds = scenes.Rectangle | scenes.Disk | scenes.Plane
    flats = [one for one in shapes if isinstance(one, kinds)]
    if len(flats) != len(shapes) or not flats:
        return False
    return all(_parallel(np.array(one.normal), np.array(flats[0].normal)) for one in flats)


def _in_one_plane(shapes: Sequence[Shape], emitters: Sequence[AnyEmitter]) -> bool:
    """Whether one plane holds all beams and is parallel or perpendicular to every face."""
    normals: list[FloatArray] = []
    for one in shapes:
        if isinstance(one, scenes.Rectangle | scenes.Disk | scenes.Plane):
            normals.append(np.array(one.normal))
        elif isinstance(one, scenes.Box | scenes.Prism | scenes.Polyhedron):
            normals.extend(one.faces()[0])
        else:
            return False
    beams = [
        np.array(one.direction)
        for one in emitters
        if isinstance(one, scenes.Beam) and one.divergence_deg == 0.0
    ]
    if len(beams) != len(emitters) or not beams:
        return False
    lines = np.array([*beams, *normals])
    across = np.cross(beams[0], lines)
    candidates = across[np.linalg.norm(across, axis=1) > _ALIGNED]
    return len(candidates) == 0 or any(
        np.all(np.abs(np.array(beams) @ one) <= _ALIGNED)
        and all(abs(float(n @ one)) <= _ALIGNED or _parallel(n, one) for n in normals)
        for one in candidates / np.linalg.norm(candidates, axis=1, keepdims=True)
    )


def _about_one_axis(shapes: Sequence[Shape], emitters: Sequence[AnyEmitter]) -> bool:
    """Whether shapes and light are symmetric about the axis of some lens or beam."""
    about, lines = _axes_of(shapes)
    if about is None:
        return False
    starts: list[FloatArray] = []
    for lamp in emitters:
        if isinstance(lamp, scenes.Beam) and lamp.divergence_deg == 0.0:
            lines.append((np.full(3, np.nan), np.array(lamp.direction)))
        elif isinstance(lamp, scenes.Point | scenes.Spot):
            starts.append(np.array(lamp.position))
        else:
            return False
    axes = [(place, way) for place, way in lines if not np.isnan(place[0])] or [
        (about[0], way) for _, way in lines
    ]
    if not axes:
        return False
    place, way = axes[0]
    size = max(float(np.linalg.norm(one - place)) for one in [*about, *starts])
    return all(_parallel(one, way) for _, one in lines) and all(
        float(np.linalg.norm(np.cross(one - place, way))) <= _ALIGNED * size
        for one in [*about, *starts]
    )


def _axes_of(shapes: Sequence[Shape]) -> tuple[list[FloatArray] | None, Lines]:
    """Points that the axis must pass through, and (a point or NaN, direction) it must have."""
    about: list[FloatArray] = []
    lines: Lines = []
    for one in shapes:
        if isinstance(one, scenes.Sphere):
            about.append(np.array(one.position))
        elif isinstance(one, scenes.Lens):
            about.append(np.array(one.position))
            lines.append((np.array(one.position), np.array(one.axis)))
        elif isinstance(one, scenes.Rectangle | scenes.Disk | scenes.Plane):
            lines.append((np.full(3, np.nan), np.array(one.normal)))
        else:
            return None, []
    return about or None, lines


def _parallel(one: FloatArray, other: FloatArray) -> bool:
    return float(np.linalg.norm(np.cross(one, other))) <= _ALIGNED
