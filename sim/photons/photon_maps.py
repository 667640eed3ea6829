"""The photon maps of a pass: one of light from lamps, glass and mirrors, one of what has bounced.

Caustics are sharp and need a narrow disc; light that a diffuse surface has reflected changes
slowly, lies everywhere, and is gathered from fewer photons over a wider one.

Reference:
    Jensen (1996), "Global illumination using photon maps", §2: a caustics map and a global map.
"""

import threading
from dataclasses import dataclass
from typing import Any

from sim.photons.photon_batch import PhotonBatch
from sim.photons.photon_map import PhotonMap, build_photon_map
from sim.sampling.counter import fold_key
from sim.scene_data import CompiledScene

__all__ = ["INDIRECT_WIDTH", "PhotonMaps", "build_photon_maps"]

INDIRECT_WIDTH = 4.0
"""Gather radius of light that a diffuse surface has reflected, in gather radii of other light."""

INDIRECT_KEPT = 4
"""One photon of how many is kept of those that diffuse surfaces have reflected: their number is
what a gather over so wide a disc costs, and a quarter of them leaves half the noise of all over a
narrow one."""

_THINNING_KEY = 0x7411
"""Apart from every stream's number."""


@dataclass(frozen=True)
class PhotonMaps:
    """One pass's photons.

    Attributes:
        straight: those that no diffuse surface has reflected.
        bounced: of those that one has, some for all; None where there can be none.
    """

    straight: PhotonMap
    bounced: PhotonMap | None = None


def build_photon_maps(
    compiled: CompiledScene,
    batch: PhotonBatch,
    receivers: Any,
    radius: float,
    *,
    seed: int,
    pass_index: int,
    threads: int,
    stop: threading.Event | None = None,
) -> PhotonMaps:
    """Sort one pass's photons into maps.

    Args:
        compiled: the scene.
        batch: its stored photons.
        receivers: the device-side Receivers struct.
        radius: of the gather of light from lamps, glass and mirrors [m].
        seed: the run's seed.
        pass_index: with the seed, it decides which bounced photons stand for all.
        threads: CPU threads.
        stop: once set, from another thread, building ends; the maps are then unusable.
    """

    def build(part: PhotonBatch, width: float) -> PhotonMap:
        return build_photon_map(
            compiled, part, receivers, width * radius, threads=threads, stop=stop
        )

    if not compiled.features.interreflection:
        return PhotonMaps(build(batch, 1.0))
    first = fold_key(seed, pass_index, _THINNING_KEY) % INDIRECT_KEPT
    straight, bounced = batch.parted(every=INDIRECT_KEPT, first=first)
    if len(bounced) == 0:
        return PhotonMaps(build(straight, 1.0))
    return PhotonMaps(build(straight, 1.0), build(bounced, INDIRECT_WIDTH))
