"""Irradiance in bins on a receiver by the gather that pictures use, to price its kernel.

Each bin asks the photon map at points spread over it, and takes their mean.
"""

import functools
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.features import Features
from sim.image.gather import make_gather
from sim.image.sight import ALL_BANDS, make_lights_struct, make_sight_struct
from sim.launch import cut_ranges, launch_ranges
from sim.sampling.counter import fold_key, hash64
from sim.sampling.kronecker import r2_point
from sim.scene_data import CompiledScene
from sim.scene_structs import make_scene_structs
from sim.study.glass_chain import GlassChain

__all__ = ["gather_bins", "make_gather_bins"]

POINTS = wp.constant(4)
"""Places in a bin where the map is asked."""

_KEY = 0x6A7E5B
_RANGE_SIZE = 256


@functools.cache
def make_patch_struct(precision: str) -> Any:
    """Struct Patch: the bins' rectangle in the local frame."""
    vec3 = make_scene_structs(precision).vec3

    @wp.struct
    class Patch:
        corner: vec3
        step_u: vec3
        step_v: vec3
        normal: vec3
        prim: int
        side: int
        columns: int

    return Patch


@functools.cache
def make_gather_bins(precision: str, features: Features) -> Any:
    """Kernel: the reflected radiance of each bin, times the bands' width, into a row a bin."""
    structs = make_scene_structs(precision)
    scene_type, interaction_type, real = structs.Scene, structs.Interaction, structs.real
    lights_type, sight_type = make_lights_struct(precision), make_sight_struct(precision)
    patch_type, gather = make_patch_struct(precision), make_gather(precision, features)

    @wp.kernel(module="unique", enable_backward=False)
    def gather_bins_kernel(
        start: int,
        scene: scene_type,
        lights: lights_type,
        patch: patch_type,
        key: wp.uint64,
        out_sums: wp.array2d(dtype=wp.float64),
    ):
        i = start + wp.tid()
        met = interaction_type()
        met.prim = patch.prim
        met.side = patch.side
        met.normal = patch.normal
        sight = sight_type()
        sight.row = i
        sight.band = ALL_BANDS
        sight.radius_scale = real(1.0)
        sight.weight = real(1.0)
        for k in range(POINTS):
            x, y = r2_point(hash64(key, wp.uint64(i)), wp.uint32(k), sight.weight)
            met.point = (
                patch.corner
                + patch.step_u * (real(i % patch.columns) + x)
                + patch.step_v * (real(i // patch.columns) + y)
            )
            gather(scene, lights, met, sight, real(1.0) / real(POINTS), out_sums)

    return gather_bins_kernel


def gather_bins(
    compiled: CompiledScene, lights: Any, chain: GlassChain, *, seed: int, threads: int
) -> npt.NDArray[np.float64]:
    """(rows, columns, bands) spectral irradiance [W m⁻² nm⁻¹] from a map of the chain's photons.

    Args:
        compiled: the scene.
        lights: the device-side Lights struct over that map, its receivers in the chain's bands.
        chain: whose bins are filled.
        seed: of the places within the bins.
        threads: CPU threads.
    """
    bins, bands = chain.bins, len(chain.edges_nm) - 1
    count = bins.rows * bins.columns
    sums = wp.zeros((count, bands + int(lights.receivers.lamps) + 1), dtype=wp.float64,
                    device=compiled.device)
    inputs = [compiled.data, lights, _patch(compiled, chain), fold_key(seed, _KEY), sums]
    launch_ranges(
        make_gather_bins(compiled.precision, compiled.features),
        cut_ranges(count, _RANGE_SIZE),
        lambda _: inputs,
        device=compiled.device,
        threads=threads,
    )
    material = compiled.scene.objects[bins.prim].material
    assert isinstance(material, scenes.Lambertian)
    centres = 0.5 * (chain.edges_nm[:-1] + chain.edges_nm[1:])
    reflected = sums.numpy()[:, :bands].reshape(bins.rows, bins.columns, bands)
    irradiance = reflected * np.pi / material.reflectance_at(centres) / np.diff(chain.edges_nm)
    result: npt.NDArray[np.float64] = irradiance
    return result


def _patch(compiled: CompiledScene, chain: GlassChain) -> Any:
    """The Patch struct of a chain's bins."""
    bins = chain.bins
    patch = make_patch_struct(compiled.precision)()
    u, v, normal = bins.frame
    patch.corner = compiled.to_local(bins.centre) + bins.low[0] * u + bins.low[1] * v
    patch.step_u, patch.step_v = u * bins.bin_size[0], v * bins.bin_size[1]
    patch.normal = normal if chain.side == 0 else -normal
    patch.prim, patch.side, patch.columns = bins.prim, chain.side, bins.columns
    return patch
