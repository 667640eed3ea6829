"""The device-side layout of stored photons, and the packing of their small fields."""

import functools
from types import SimpleNamespace

import warp as wp

from sim.precision import precision_types
from sim.sensors.sensor_structs import make_sensor_structs

__all__ = [
    "HISTORY_LIMIT",
    "MAX_OBJECTS",
    "MAX_PARTS",
    "add_bounce",
    "add_event",
    "bounces_of",
    "has_events",
    "is_dispersed",
    "make_photon_structs",
    "mark_dispersed",
    "surface_key",
]

MAX_OBJECTS = 1 << 17
MAX_PARTS = 1 << 13
"""Objects, and parts of their surfaces, that a surface key of 31 bits can tell apart."""

HISTORY_LIMIT = 1023
"""Each count of a photon's history stops here: 10 bits apiece."""


@wp.func
def surface_key(prim: int, part: int, side: int):
    """One integer for object, part and side: equal keys mean the same side of the same part."""
    return (prim << 14) | (part << 1) | side


@wp.func
def add_event(history: int, refracts: int):
    """History with one more refraction (bits 0 to 9) or specular reflection (bits 10 to 19).

    Bits 20 to 29 count bounces off diffuse surfaces. A full count stays full.
    """
    shift = 10 * (1 - refracts)
    if ((history >> shift) & 1023) == 1023:
        return history
    return history + (1 << shift)


@wp.func
def add_bounce(history: int):
    """History with one more bounce off a diffuse surface."""
    if ((history >> 20) & 1023) == 1023:
        return history
    return history + (1 << 20)


@wp.func
def bounces_of(history: int):
    """How many bounces off diffuse surfaces there were."""
    return (history >> 20) & 1023


@wp.func
def has_events(history: int):
    """True unless the photon came straight from its lamp."""
    return (history & 1073741823) != 0


@wp.func
def mark_dispersed(history: int, dispersive: int):
    """History that remembers (bit 30) whether any boundary so far was `dispersive` (0 or 1)."""
    return history | (dispersive << 30)


@wp.func
def is_dispersed(history: int):
    """1 if the photon met a dispersive boundary: its wavelength decided its path or weight."""
    return (history >> 30) & 1


@functools.cache
def make_photon_structs(precision: str) -> SimpleNamespace:
    """Structs Photons (arrays, one element a stored photon) and Job (one launch's share).

    Photons: `position` in the local frame [m]; `direction` where the photon was going, unit;
    `wavelength_nm`; `flux` [W]; `surface`, see `surface_key`; `history`, packed counts;
    `emitter`, the row of its lamp among those that shine; `crossings`, what sensors have recorded.
    `band_books[range, 5 band + column]`: the energy books of each band [W], if the job has `bands`.
    """
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3
    sensor_structs = make_sensor_structs(precision)
    sensors_type, crossings_type = sensor_structs.Sensors, sensor_structs.Crossings

    @wp.struct
    class Photons:
        position: wp.array(dtype=vec3)
        direction: wp.array(dtype=wp.vec3)
        wavelength_nm: wp.array(dtype=wp.float32)
        flux: wp.array(dtype=wp.float64)
        surface: wp.array(dtype=int)
        history: wp.array(dtype=int)
        emitter: wp.array(dtype=int)
        crossings: crossings_type
        band_books: wp.array2d(dtype=wp.float64)

    @wp.struct
    class Job:
        """Photons of one emitter and target, and the slots of what they leave behind.

        Deposits, crossings that are binned and rays that are kept have their slots each.
        """

        emitter: int
        target: int
        seed_row: int
        key: wp.uint64
        range_row: int
        first_slot: int
        slot_count: int
        slots_a_thread: int  # 0: the threads of a range share its slots and its row of counters
        run: int  # photons a thread traces
        stop: int  # the range's end
        max_interactions: int
        store_direct: int  # 0: what comes straight from the lamp is booked, but not stored
        branch_threshold: real
        sensors: sensors_type
        bounces: int  # off diffuse surfaces, at most
        bands: int  # of which books are kept; 0: none
        first_edge_nm: real
        band_width_nm: real

    return SimpleNamespace(Photons=Photons, Job=Job)
