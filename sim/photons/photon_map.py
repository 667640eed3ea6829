"""The photon map: one pass's photons in a hash grid, in the order of its cells.

Locality decides the speed of a gather: with photons and queries both in cell order a query costs
a twelfth of what it does in random order. So the grid is built twice, once to learn the order and
once over the photons in that order. The photon's band is the grid's group, so that a query for
one band meets that band's photons alone.

References:
    Jensen (1996), "Global illumination using photon maps", §3; the balanced tree there is
    replaced by a uniform grid, since the radius of the search is the same everywhere.
"""

import functools
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.launch import cut_ranges, launch_ranges
from sim.photons.photon_structs import make_photon_structs
from sim.photons.tracing import PhotonBatch
from sim.precision import precision_types
from sim.scene_data import CompiledScene

__all__ = ["PhotonMap", "build_photon_map", "make_map_structs"]

FloatArray = npt.NDArray[np.float64]

_RANGE_SIZE = 65536

_MAX_CELLS_A_SIDE = 1024
_MAX_CELLS = 1 << 23


@functools.cache
def make_map_structs(precision: str) -> SimpleNamespace:
    """Structs Map (photons in cell order) and Reflectances (of each object, over wavelength)."""
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3

    @wp.struct
    class Reflectances:
        """`table[object, i]` at `first_nm + i` nm, linear between."""

        first_nm: real
        last: int
        table: wp.array2d(dtype=real)

    @wp.struct
    class Map:
        """`weight` is a photon's flux times reflectance over π: what the kernel multiplies."""

        grid: wp.uint64
        radius: real
        position: wp.array(dtype=vec3)
        weight: wp.array(dtype=real)
        surface: wp.array(dtype=int)
        band: wp.array(dtype=int)

    @wp.struct
    class Bands:
        """Wavelength bands of equal width."""

        count: int
        first_edge_nm: real
        width_nm: real

    return SimpleNamespace(Reflectances=Reflectances, Map=Map, Bands=Bands)


@functools.cache
def make_collect(precision: str) -> Any:
    """Kernel: photons from their slots to a row each, with band and reflected weight."""
    types, structs = precision_types(precision), make_map_structs(precision)
    real = types.real
    photons_type = make_photon_structs(precision).Photons
    map_type, bands_type = structs.Map, structs.Bands
    reflectances_type = structs.Reflectances

    @wp.kernel(module="unique", enable_backward=False)
    def collect(
        start: int,
        photons: photons_type,
        slots: wp.array(dtype=int),
        reflectances: reflectances_type,
        bands: bands_type,
        out: map_type,
    ):
        i = start + wp.tid()
        slot = slots[i]
        wavelength_nm = real(photons.wavelength_nm[slot])
        band = int(wp.floor((wavelength_nm - bands.first_edge_nm) / bands.width_nm))
        out.band[i] = wp.clamp(band, 0, bands.count - 1)
        out.position[i] = photons.position[slot]
        surface = photons.surface[slot]
        out.surface[i] = surface
        x = wp.max(wavelength_nm - reflectances.first_nm, real(0.0))
        k = wp.min(int(x), reflectances.last - 1)
        prim = surface >> 14
        low = reflectances.table[prim, k]
        rho = low + (x - real(k)) * (reflectances.table[prim, k + 1] - low)
        out.weight[i] = real(photons.flux[slot]) * rho * real(0.3183098861837907)

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
        out.band[i] = source.band[j]

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
    edges_nm: FloatArray,
    radius: float,
    *,
    threads: int,
) -> PhotonMap:
    """Sort one pass's photons into a grid of cells as wide as the gather radius.

    Args:
        compiled: the scene.
        batch: its stored photons.
        edges_nm: (bands + 1,) edges of bands of equal width [nm].
        radius: of the gather [m].
        threads: CPU threads.
    """
    precision, device, count = compiled.precision, compiled.device, len(batch)
    loose = _allocate_map(precision, device, count, radius)
    if count == 0:
        grid = wp.HashGrid(1, 1, 1, device=device, dtype=precision_types(precision).real)
        grid.build(loose.position, radius, groups=loose.band)
        loose.grid = grid.id
        return PhotonMap(loose, grid, 0)
    ranges = cut_ranges(count, _RANGE_SIZE)
    slots = wp.array(batch.slots, dtype=int, device=device)
    reflectances = _reflectances(compiled, edges_nm)
    bands = bands_struct(precision, edges_nm)
    inputs = [batch.data, slots, reflectances, bands, loose]
    launch_ranges(
        make_collect(precision), ranges, lambda _: inputs, device=device, threads=threads
    )
    grid = wp.HashGrid(*_grid_shape(loose.position, radius), device=device,
                       dtype=precision_types(precision).real)
    grid.build(loose.position, radius, groups=loose.band)
    loose.grid = grid.id
    sorted_map = _allocate_map(precision, device, count, radius)
    launch_ranges(
        make_reorder(precision), ranges, lambda _: [loose, sorted_map], device=device,
        threads=threads,
    )
    grid.build(sorted_map.position, radius, groups=sorted_map.band)
    sorted_map.grid = grid.id
    return PhotonMap(sorted_map, grid, count)


def bands_struct(precision: str, edges_nm: FloatArray) -> Any:
    """The device-side Bands struct of equal bands with these edges."""
    bands = make_map_structs(precision).Bands()
    bands.count = len(edges_nm) - 1
    bands.first_edge_nm = float(edges_nm[0])
    bands.width_nm = float(edges_nm[-1] - edges_nm[0]) / bands.count
    return bands


def _allocate_map(precision: str, device: str, count: int, radius: float) -> Any:
    """A Map struct with room for `count` photons (at least one, far from everything)."""
    types, room = precision_types(precision), max(1, count)
    data = make_map_structs(precision).Map()
    data.radius = radius
    data.position = wp.empty(room, dtype=types.vec3, device=device)
    data.weight = wp.empty(room, dtype=types.real, device=device)
    data.surface = wp.empty(room, dtype=int, device=device)
    data.band = wp.empty(room, dtype=int, device=device)
    if count == 0:
        data.position.zero_()
        data.weight.zero_()
        data.surface.fill_(-1)
        data.band.zero_()
    return data


def _grid_shape(positions: Any, radius: float) -> tuple[int, int, int]:
    """Cells a side: as the photons extend. A flat receiver then has one layer, not three."""
    host = positions.numpy()
    extent = host.max(axis=0) - host.min(axis=0)
    cells = np.clip(np.nan_to_num(extent / radius, posinf=1e9), 1, _MAX_CELLS_A_SIDE).astype(int)
    while int(np.prod(cells)) > _MAX_CELLS:
        cells[np.argmax(cells)] //= 2
    return int(cells[0]), int(cells[1]), int(cells[2])


def _reflectances(compiled: CompiledScene, edges_nm: FloatArray) -> Any:
    """The device-side Reflectances struct: every Lambertian object's, by 1 nm."""
    types = precision_types(compiled.precision)
    first, last = np.floor(edges_nm[0]), np.ceil(edges_nm[-1])
    wavelength_nm = np.arange(first, last + 2.0)
    objects = compiled.scene.objects
    table = np.zeros((max(1, len(objects)), len(wavelength_nm)))
    for row, item in enumerate(objects):
        if isinstance(item.material, scenes.Lambertian):
            table[row] = item.material.reflectance_at(wavelength_nm)
    struct = make_map_structs(compiled.precision).Reflectances()
    struct.first_nm = float(first)
    struct.last = len(wavelength_nm) - 1
    struct.table = wp.array(table.astype(types.dtype), dtype=types.real, device=compiled.device)
    return struct
