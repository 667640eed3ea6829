"""The photon map: one pass's photons in a hash grid, in the order of its cells.

Locality decides the speed of a gather: with photons and queries both in cell order a query costs
a twelfth of what it does in random order. So the grid is built twice, once to learn the order and
once over the photons in that order. A photon's group is the grid's group, so that a query for
one band meets that band's photons alone.

References:
    Jensen (1996), "Global illumination using photon maps", §3; the balanced tree there is
    replaced by a uniform grid, since the radius of the search is the same everywhere.
"""

import functools
import threading
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import warp as wp

from sim.launch import cut_ranges, launch_ranges
from sim.photons.photon_batch import PhotonBatch
from sim.photons.photon_structs import is_dispersed, make_photon_structs
from sim.photons.receivers import DEALS, make_receiver_structs
from sim.precision import precision_types
from sim.scene_data import CompiledScene

__all__ = [
    "PhotonMap",
    "build_photon_map",
    "make_collect",
    "make_map_structs",
    "make_reorder",
]

_RANGE_SIZE = 65536

CELLS_A_RADIUS = 2.0
"""Width of a cell in gather radii. A query for one band finds few photons and costs the cells it
looks into; one for all bands costs the photons it passes over: this is between the two."""

DEAL_BITS = wp.constant(5)
"""Undispersed photons are dealt in packs of 2⁵. Every eighth point of a Sobol sequence lies in one
eighth of the square; a pack lies all over it, and so do the packs of a deal."""

_MAX_CELLS_A_SIDE = 1024
_MAX_CELLS = 1 << 23


@functools.cache
def make_map_structs(precision: str) -> SimpleNamespace:
    """Struct Map: photons in cell order.

    `weight` is what a photon adds, once multiplied by the kernel, to the sum of its `group`:
    the groups are those of `sim.photons.receivers`. `undispersed` is 0 if those of undispersed
    photons are all empty.
    """
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3

    @wp.struct
    class Map:
        grid: wp.uint64
        radius: real
        undispersed: int
        position: wp.array(dtype=vec3)
        weight: wp.array(dtype=real)
        surface: wp.array(dtype=int)
        group: wp.array(dtype=int)
        lamp: wp.array(dtype=int)

    return SimpleNamespace(Map=Map)


@functools.cache
def make_collect(precision: str) -> Any:
    """Kernel: photons from their slots to a row each, with group and weight."""
    real = precision_types(precision).real
    photons_type = make_photon_structs(precision).Photons
    map_type = make_map_structs(precision).Map
    receivers_type = make_receiver_structs(precision).Receivers

    @wp.kernel(module="unique", enable_backward=False)
    def collect(
        start: int,
        photons: photons_type,
        slots: wp.array(dtype=int),
        receivers: receivers_type,
        stands_for: real,
        out: map_type,
    ):
        i = start + wp.tid()
        slot = slots[i]
        surface = photons.surface[slot]
        out.position[i] = photons.position[slot]
        out.surface[i] = surface
        flux = real(photons.flux[slot]) * stands_for
        if is_dispersed(photons.history[slot]) == 1:
            wavelength_nm = real(photons.wavelength_nm[slot])
            band = int(
                wp.floor((wavelength_nm - receivers.first_edge_nm) / receivers.band_width_nm)
            )
            out.group[i] = wp.clamp(band, 0, receivers.bands - 1)
            x = wp.max(wavelength_nm - receivers.first_nm, real(0.0))
            k = wp.min(int(x), receivers.reflectance.shape[1] - 2)
            low = receivers.reflectance[surface >> 14, k]
            high = receivers.reflectance[surface >> 14, k + 1]
            out.weight[i] = flux * (low + (x - real(k)) * (high - low))
        else:
            out.group[i] = receivers.bands + (i >> DEAL_BITS) % DEALS
            out.weight[i] = flux
        out.lamp[i] = photons.emitter[slot]

    return collect


@functools.cache
def make_reorder(precision: str) -> Any:
    """Kernel: photons into the order in which a hash grid keeps them."""
    map_type = make_map_structs(precision).Map

    @wp.kernel(module="unique", enable_backward=False)
    def reorder(start: int, source: map_type, out: map_type):
        i = start + wp.tid()
        j = wp.hash_grid_point_id(source.grid, i)
        out.position[i] = source.position[j]
        out.weight[i] = source.weight[j]
        out.surface[i] = source.surface[j]
        out.group[i] = source.group[j]
        out.lamp[i] = source.lamp[j]

    return reorder


@dataclass(frozen=True)
class PhotonMap:
    """A built map.

    Attributes:
        data: the device-side Map struct.
        grid: the hash grid, kept alive here.
        photons: how many photons it holds.
    """

    data: Any
    grid: wp.HashGrid
    photons: int


def build_photon_map(
    compiled: CompiledScene,
    batch: PhotonBatch,
    receivers: Any,
    radius: float,
    *,
    threads: int,
    stop: threading.Event | None = None,
) -> PhotonMap:
    """Sort one pass's photons into a grid of cells as wide as the gather radius.

    Args:
        compiled: the scene.
        batch: its stored photons.
        receivers: the device-side Receivers struct.
        radius: of the gather [m].
        threads: CPU threads.
        stop: once set, from another thread, building ends; the map is then unusable.
    """
    precision, device, count = compiled.precision, compiled.device, len(batch)
    loose = _allocate_map(precision, device, count, radius)
    cell = CELLS_A_RADIUS * radius
    if count == 0:
        grid = wp.HashGrid(1, 1, 1, device=device, dtype=precision_types(precision).real)
        grid.build(loose.position, cell, groups=loose.group)
        loose.grid = grid.id
        return PhotonMap(loose, grid, 0)
    ranges = cut_ranges(count, _RANGE_SIZE)
    slots: Any = wp.array(batch.slots, dtype=int, device=device)
    inputs = [batch.data, slots, receivers, float(batch.stands_for), loose]
    launch_ranges(
        make_collect(precision), ranges, lambda _: inputs, device=device, threads=threads, stop=stop
    )
    grid = wp.HashGrid(*_grid_shape(loose.position, cell), device=device,
                       dtype=precision_types(precision).real)
    grid.build(loose.position, cell, groups=loose.group)
    loose.grid = grid.id
    sorted_map = _allocate_map(precision, device, count, radius)
    launch_ranges(
        make_reorder(precision), ranges, lambda _: [loose, sorted_map], device=device,
        threads=threads, stop=stop,
    )
    grid.build(sorted_map.position, cell, groups=sorted_map.group)
    sorted_map.undispersed = int(np.any(loose.group.numpy() >= receivers.bands))
    sorted_map.grid = grid.id
    return PhotonMap(sorted_map, grid, count)


def _allocate_map(precision: str, device: str, count: int, radius: float) -> Any:
    """A Map struct with room for `count` photons (at least one, far from everything)."""
    types, room = precision_types(precision), max(1, count)
    data = make_map_structs(precision).Map()
    data.radius = radius
    data.position = wp.empty(room, dtype=types.vec3, device=device)
    data.weight = wp.empty(room, dtype=types.real, device=device)
    data.surface = wp.empty(room, dtype=int, device=device)
    data.group = wp.empty(room, dtype=int, device=device)
    data.lamp = wp.empty(room, dtype=int, device=device)
    if count == 0:
        data.position.zero_()
        data.weight.zero_()
        data.surface.fill_(-1)
        data.group.zero_()
        data.lamp.zero_()
    return data


def _grid_shape(positions: Any, cell: float) -> tuple[int, int, int]:
    """Cells a side: as the photons extend. A flat receiver then has one layer, not three."""
    host = positions.numpy()
    extent = host.max(axis=0) - host.min(axis=0)
    cells = np.clip(np.nan_to_num(extent / cell, posinf=1e9), 1, _MAX_CELLS_A_SIDE).astype(int)
    while int(np.prod(cells)) > _MAX_CELLS:
        cells[np.argmax(cells)] //= 2
    return int(cells[0]), int(cells[1]), int(cells[2])
