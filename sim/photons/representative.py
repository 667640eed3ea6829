"""A handful of the rays that a scene's lamps emit, for diagrams."""

import functools
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.device import start_device
from sim.photons.emission import make_emission
from sim.photons.lamp_structs import make_lamp_structs
from sim.photons.lamps import compile_lamps
from sim.sampling.counter import fold_key
from sim.sampling.sobol import DIMENSIONS
from sim.scene_data import compile_scene

__all__ = ["representative_rays"]

FloatArray = npt.NDArray[np.float64]


@functools.cache
def make_emit_rays(precision: str) -> Any:
    """Kernel: origin and direction of the photons of one stream."""
    structs = make_lamp_structs(precision)
    vec3, lamps_type = structs.vec3, structs.Lamps
    emit = make_emission(precision)

    @wp.kernel(module="unique", enable_backward=False)
    def emit_rays(
        lamps: lamps_type,
        emitter: int,
        target: int,
        seed_row: int,
        key: wp.uint64,
        out_origins: wp.array(dtype=vec3),
        out_directions: wp.array(dtype=vec3),
    ):
        i = wp.tid()
        ray, _u, _flux = emit(lamps, emitter, target, seed_row, wp.uint32(i), key)
        out_origins[i] = ray.origin
        out_directions[i] = ray.direction

    return emit_rays


def representative_rays(
    scene: scenes.Scene, count: int, seed: int = 0
) -> tuple[FloatArray, FloatArray]:
    """Rays as the photons of a rendering start, shared among the lamps and their targets.

    Args:
        scene: with at least one emitter that shines inside the film's range.
        count: how many rays.
        seed: other seeds give other rays.

    Returns:
        Origins [m] and unit directions, each (count, 3).
    """
    device = start_device("cpu")
    compiled = compile_scene(scene, device=device)
    lamps = compile_lamps(compiled, np.asarray(scene.film.edges_nm), count)
    lamps.seed(device, seed, 0)
    origins, directions = [], []
    for row, stream in enumerate(lamps.streams):
        starts = wp.zeros(stream.photons, dtype=compiled.structs.vec3, device=device)
        ways = wp.zeros(stream.photons, dtype=compiled.structs.vec3, device=device)
        wp.launch(
            make_emit_rays(compiled.precision),
            dim=stream.photons,
            inputs=[
                lamps.data, stream.emitter, stream.target, row * DIMENSIONS,
                fold_key(seed, 0, row),
            ],
            outputs=[starts, ways],
            device=device,
        )
        origins.append(starts.numpy() + compiled.origin)
        directions.append(ways.numpy())
    return np.concatenate(origins)[:count], np.concatenate(directions)[:count]
