"""Draw the ray diagram of a scene: single rays from its lamps, coloured by wavelength.

Rays follow refraction; where refraction cannot be, they follow total internal reflection. What is
reflected on the way is drawn if asked for.
"""

from __future__ import annotations

import argparse
import functools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.arguments import add_scene_arguments, count, figure_file, load_scene

if TYPE_CHECKING:
    from scenes import Scene
    from sim.diagram.ray_lines import DrawnPath

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "draw the ray diagram of a scene"

_DEFAULT_WAVELENGTHS = 5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    add_scene_arguments(parser)
    parser.add_argument("-o", "--output", type=figure_file, metavar="OUT.png|.svg",
                        help="the diagram (default: SCENE-rays.png, in this folder)")
    parser.add_argument("--rays", type=count, default=24, metavar="N",
                        help="rays of each wavelength (default: 24)")
    parser.add_argument("--wavelengths", type=_wavelengths, metavar="NM,NM,…",
                        help="wavelengths [nm] (default: five over the film's range)")
    parser.add_argument("--reflections", type=int, choices=range(4), default=0,
                        help="also draw, dashed and the fainter the less they carry, paths that "
                             "are reflected where they could be refracted, at up to so many "
                             "surfaces (default: 0; total reflection is always drawn)")
    parser.add_argument("--normals", action="store_true",
                        help="draw the surfaces' normals where rays meet them")
    parser.add_argument("--view", choices=("xy", "xz", "yz"),
                        help="the plane seen (default: the one the rays spread in most)")
    parser.add_argument("--seed", type=count, default=0, metavar="N",
                        help="chooses the rays (default: 0)")


def _wavelengths(text: str) -> list[float]:
    wavelengths_nm = [float(part) for part in text.split(",")]
    if not all(0.0 < wavelength_nm < math.inf for wavelength_nm in wavelengths_nm):
        raise ValueError
    return wavelengths_nm


_wavelengths.__name__ = "list of wavelengths"


def run(arguments: argparse.Namespace) -> None:
    """Trace the rays and draw them."""
    from sim.atomic_file import check_writable
    from sim.diagram.draw import draw_rays
    from sim.errors import SettingsError
    from sim.figure_file import save_figure
    from sim.interruption import run_interruptibly

    if arguments.rays < 1:
        raise SettingsError("rays", arguments.rays, "a whole number from 1")
    scene = load_scene(arguments)
    output = arguments.output or Path(f"{scene.source_name}-rays.png")
    check_writable(output)
    wavelengths_nm = arguments.wavelengths or _default_wavelengths_nm(scene)
    work = functools.partial(
        _traced, scene, arguments.rays, wavelengths_nm, arguments.seed,
        reflections=arguments.reflections, normals=arguments.normals,
    )
    paths = run_interruptibly(work)
    save_figure(draw_rays(scene, paths, view=arguments.view), output)
    print(f"{output}: {len(paths)} rays")


def _default_wavelengths_nm(scene: Scene) -> list[float]:
    """Evenly spaced over the film's range, as far as the lamps emit in it."""
    lowest_nm, highest_nm = map(float, scene.film.edges_nm[[0, -1]])
    supports = [emitter.emission().support_nm for emitter in scene.emitters]
    if supports:
        lowest_nm = max(lowest_nm, min(low for low, _ in supports))
        highest_nm = min(highest_nm, max(high for _, high in supports))
    if lowest_nm >= highest_nm:
        return [lowest_nm]
    step_nm = (highest_nm - lowest_nm) / _DEFAULT_WAVELENGTHS
    return [lowest_nm + (i + 0.5) * step_nm for i in range(_DEFAULT_WAVELENGTHS)]


def _traced(
    scene: Scene,
    rays: int,
    wavelengths_nm: Sequence[float],
    seed: int,
    *,
    reflections: int,
    normals: bool,
) -> list[DrawnPath]:
    import numpy as np

    from sim.device import start_device
    from sim.diagram.branches import trace_branches
    from sim.photons.representative import representative_rays
    from sim.scene_data import compile_scene

    origins, directions = representative_rays(scene, rays, seed)
    every_nm = np.repeat(np.asarray(wavelengths_nm, dtype=np.float64), rays)
    bundles = len(wavelengths_nm)
    return trace_branches(
        compile_scene(scene, device=start_device("cpu")),
        np.tile(origins, (bundles, 1)),
        np.tile(directions, (bundles, 1)),
        every_nm,
        reflections=reflections,
        normals=normals,
    )
