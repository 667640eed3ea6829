"""The paths to draw: each ray as it is refracted, and what is reflected on its way."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from sim.diagram.ray_lines import DrawnPath, Kind
from sim.ray_path import RayPath
from sim.scene_data import CompiledScene
from sim.single_ray import trace_compiled_rays

__all__ = ["trace_branches"]

_BOUNDARIES: Final = ("refract", "reflect", "total internal reflection", "mirror")
_AFTER: Final[dict[str, Kind]] = {
    "reflect": "reflected", "mirror": "reflected", "total internal reflection": "totally reflected",
}  # fmt: skip

_FAINTEST: Final = 1e-4
"""What carries less than this part of the ray's flux is not drawn."""

_CONTRAST: Final = 0.3
"""Strength goes with this power of the flux: 4 % are drawn at 0.38 of the full colour."""


def trace_branches(
    compiled: CompiledScene,
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
    wavelengths_nm: NDArray[np.float64],
    *,
    reflections: int = 0,
    normals: bool = False,
) -> list[DrawnPath]:
    """Trace rays, and the paths that leave theirs by reflection.

    Args:
        compiled: the scene.
        origins: (n, 3) world positions [m].
        directions: (n, 3).
        wavelengths_nm: (n,).
        reflections: how often a path may be reflected where it could be refracted.
        normals: whether to note the surfaces' normals.

    Returns:
        The rays' own paths first, in their order. A path that leaves another one begins where it
        does.
    """
    drawn = []
    wanted: dict[tuple[str, ...], list[int]] = {(): list(range(len(origins)))}
    for generation in range(reflections + 1):
        following: dict[tuple[str, ...], list[int]] = {}
        for branches, rays in wanted.items():
            paths = trace_compiled_rays(
                compiled, origins[rays], directions[rays], wavelengths_nm[rays], branches=branches
            )
            for ray, path in zip(rays, paths, strict=True):
                drawn.append(_drawn(path, len(branches), normals=normals))
                if generation < reflections:
                    for leaving in _leaving(path, branches):
                        following.setdefault(leaving, []).append(ray)
        wanted = following
    return drawn


def _leaving(path: RayPath, branches: tuple[str, ...]) -> list[tuple[str, ...]]:
    """The branches of every path that is reflected where this one is refracted, later on."""
    found = []
    flux, boundary = 1.0, 0
    for event, reflectance, lost in zip(
        path.events, path.reflectances, path.absorptances, strict=True
    ):
        flux *= 1.0 - lost
        if event not in _BOUNDARIES:
            continue
        if boundary >= len(branches) and event == "refract" and flux * reflectance > _FAINTEST:
            found.append((*branches, *["refract"] * (boundary - len(branches)), "reflect"))
        flux *= {"refract": 1.0 - reflectance, "reflect": reflectance}.get(event, 1.0)
        boundary += 1
    return found


def _drawn(path: RayPath, branches: int, *, normals: bool) -> DrawnPath:
    """A path from the boundary at which its last branch was chosen, the first if there is none."""
    at = [k for k, event in enumerate(path.events) if event in _BOUNDARIES]
    first = at[branches - 1] + 1 if branches else 0
    kinds = ["refracted", *(_AFTER.get(event, "refracted") for event in path.events[:-1])]
    shown = None
    if normals:
        met = np.flatnonzero(np.any(path.normals != 0.0, axis=1))
        shown = path.points[1:][met], path.normals[met]
    return DrawnPath(
        points=path.points[first:],
        wavelength_nm=path.wavelength_nm,
        escapes=path.events[-1] == "escape",
        kinds=tuple(kinds[first:]),
        normals=shown,
        strength=float(path.stokes[first, 0]) ** _CONTRAST if first else 1.0,
    )
