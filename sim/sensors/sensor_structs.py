"""The device-side layout of sensors, and of what their crossings leave behind."""

import functools
from types import SimpleNamespace

import warp as wp

from sim.precision import precision_types

__all__ = ["SENSOR_BINS", "SENSOR_RAYS", "make_sensor_structs"]

SENSOR_BINS = wp.constant(0)
"""It adds flux up in bins."""
SENSOR_RAYS = wp.constant(1)
"""It keeps the rays themselves."""


@functools.cache
def make_sensor_structs(precision: str) -> SimpleNamespace:
    """Structs Sensor, Sensors (all of a scene) and Crossings (one element a crossing).

    Sensors: `count` is 0 where nothing is measured. Crossings: of sensors with bins, `bin` among
    those of all sensors and `bin_flux` [W]; of sensors that keep rays, `sensor`, `position` in the
    local frame [m], `direction`, `wavelength_nm`, `flux` [W], `history` as in
    `sim.photons.photon_structs`, `emitter`, and `lot` in [0, 1), which decides who stays where
    not all can.
    """
    types = precision_types(precision)
    real, vec3, mat33 = types.real, types.vec3, types.mat33

    @wp.struct
    class Sensor:
        kind: int
        both_sides: int
        centre: vec3
        frame: mat33  # rows: u, v, normal
        half_u: real
        half_v: real
        radius2: real  # of a disk; infinite for a rectangle
        tolerance: real  # heights as small as this are on the sensor
        columns: int
        rows: int
        bands: int
        first_bin: int
        first_cell: int  # of bins for undispersed light, a cell and a lamp each; −1: none

    @wp.struct
    class Sensors:
        sensors: wp.array(dtype=Sensor)
        count: int
        lamps: int  # that shine
        first_edge_nm: real
        range_nm: real  # from the first edge to the last

    @wp.struct
    class Crossings:
        bin: wp.array(dtype=int)
        bin_flux: wp.array(dtype=wp.float64)
        sensor: wp.array(dtype=int)
        position: wp.array(dtype=vec3)
        direction: wp.array(dtype=vec3)
        wavelength_nm: wp.array(dtype=real)
        flux: wp.array(dtype=wp.float64)
        history: wp.array(dtype=int)
        emitter: wp.array(dtype=int)
        lot: wp.array(dtype=wp.float64)

    return SimpleNamespace(Sensor=Sensor, Sensors=Sensors, Crossings=Crossings)
