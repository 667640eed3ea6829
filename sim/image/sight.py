"""What a camera path brings to a receiver, and what light it finds there."""

import functools
from typing import Any

import warp as wp

from sim.photons.lamp_structs import make_lamp_structs
from sim.photons.lamps import Lamps
from sim.photons.photon_map import make_map_structs
from sim.photons.photon_maps import PhotonMaps
from sim.photons.receivers import make_receiver_structs
from sim.precision import precision_types

__all__ = ["ALL_BANDS", "compose_lights", "make_lights_struct", "make_sight_struct"]

ALL_BANDS = wp.constant(-1)
"""In place of a band: the path gathers them all, and ends where they would part."""


@functools.cache
def make_sight_struct(precision: str) -> Any:
    """Struct Sight: a path's share in its pixel's sample."""
    real = precision_types(precision).real

    @wp.struct
    class Sight:
        row: int  # of the film
        band: int  # or ALL_BANDS
        deal: int  # which of the undispersed photons it gathers
        radius_scale: real  # of its gather, in the photon map's radius
        weight: real
        wavelength_nm: real
        key: wp.uint64  # of its roulette
        lamp_key: wp.uint64  # of its shadow rays
        sample: int  # how many of them the pixel has had
        shadow_rays: int

    return Sight


@functools.cache
def make_lights_struct(precision: str) -> Any:
    """Struct Lights: the photon maps, how receivers reflect, and the lamps.

    `photons` are those that lamps, glass and mirrors have sent, `bounced` those that a diffuse
    surface has; `interreflection` is 1 where there may be any. `direct` is 1 where the maps leave
    out what comes straight from the lamps.
    """
    map_type = make_map_structs(precision).Map
    receivers_type = make_receiver_structs(precision).Receivers
    lamps_type = make_lamp_structs(precision).Lamps

    @wp.struct
    class Lights:
        photons: map_type
        bounced: map_type
        receivers: receivers_type
        lamps: lamps_type
        direct: int
        interreflection: int

    return Lights


def compose_lights(
    precision: str,
    maps: PhotonMaps,
    receivers: Any,
    lamps: Lamps,
    *,
    direct: bool,
) -> Any:
    """The device-side Lights struct of one pass.

    Args:
        precision: "float32" or "float64".
        maps: the pass's photons.
        receivers: the device-side Receivers struct.
        lamps: the scene's lamps.
        direct: whether to add what comes straight from the lamps: the map must not hold it.
    """
    lights = make_lights_struct(precision)()
    lights.photons = maps.straight.data
    lights.bounced = (maps.bounced or maps.straight).data
    lights.interreflection = int(maps.bounced is not None)
    lights.receivers = receivers
    lights.lamps = lamps.data
    lights.direct = int(direct)
    return lights
