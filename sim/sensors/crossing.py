"""A photon's way from one surface to the next, and the sensors that it crosses, device side.

A crossing is told by heights above the sensor: a way that starts more than a tolerance above and
ends within the tolerance or below has arrived. Heights are compared as they are, with no distance
divided out, and a photon's next way starts at the very point where this one ended: whatever
rounding does, a photon that goes through counts once, and so does one that ends on a surface that
the sensor is flush with. What leaves such a surface has not arrived.
"""

import functools

import warp as wp

from sim.geometry.flat import plane_coordinates
from sim.optics.absorption import absorbed_fraction
from sim.photons.photon_structs import is_dispersed, make_photon_structs
from sim.sampling.counter import hash64, to_unit
from sim.sampling.draws import LOT
from sim.scene_structs import make_scene_structs
from sim.sensors.sensor_structs import SENSOR_RAYS, make_sensor_structs

__all__ = ["COUNT_BINS", "COUNT_RAYS", "make_record_crossings"]

COUNT_BINS = wp.constant(1)
COUNT_RAYS = wp.constant(2)
"""Columns of a range's counters; the first one counts its deposits."""


@functools.cache
def make_record_crossings(precision: str) -> object:
    """Device function `record_crossings(job, ray, t, wavelength_nm, flux, …)`."""
    structs = make_scene_structs(precision)
    real, vec3, ray_type = structs.real, structs.vec3, structs.Ray
    sensor_structs = make_sensor_structs(precision)
    sensor_type, crossings_type = sensor_structs.Sensor, sensor_structs.Crossings
    photon_structs = make_photon_structs(precision)
    photons_type, job_type = photon_structs.Photons, photon_structs.Job

    @wp.func
    def find_crossing(sensor: sensor_type, ray: ray_type, t: real):
        """Whether a ray of length t arrives at the sensor, after what length, and where on it."""
        local = ray.origin - sensor.centre
        normal = sensor.frame[2]
        height = wp.dot(local, normal)
        approach = wp.dot(ray.direction, normal)
        if approach > real(0.0) and sensor.both_sides == 1:
            height = -height
            approach = -approach
        # Where the ray ends: minus infinity for one that meets nothing.
        arrives = approach < real(0.0) and height > sensor.tolerance
        length = real(0.0)
        u = real(0.0)
        v = real(0.0)
        if arrives:
            arrives = height + approach * t <= sensor.tolerance
        if arrives:
            length = height / -approach
            u, v = plane_coordinates(local + ray.direction * length, sensor.frame)
            arrives = wp.abs(u) <= sensor.half_u and wp.abs(v) <= sensor.half_v
            arrives = arrives and u * u + v * v <= sensor.radius2
        return arrives, wp.min(length, t), u, v

    @wp.func
    def cell_of(x: real, half: real, cells: int):
        return wp.clamp(int((x + half) / (half + half) * real(cells)), 0, cells - 1)

    @wp.func
    def bin_of(
        job: job_type, sensor: sensor_type, u: real, v: real, wavelength_nm: real, dispersed: int
    ):
        """Bin of a crossing: rows from the top, as in a picture, then columns, then bands.

        Light that has met nothing dispersive has a bin for its lamp in place of one for its band.
        """
        column = cell_of(u, sensor.half_u, sensor.columns)
        row = sensor.rows - 1 - cell_of(v, sensor.half_v, sensor.rows)
        cell = row * sensor.columns + column
        if dispersed == 0 and sensor.first_cell >= 0:
            return sensor.first_cell + cell * job.sensors.lamps + job.emitter
        x = (wavelength_nm - job.sensors.first_edge_nm) / job.sensors.range_nm
        band = wp.clamp(int(x * real(sensor.bands)), 0, sensor.bands - 1)
        return sensor.first_bin + cell * sensor.bands + band

    @wp.func
    def keep_ray(
        crossings: crossings_type, slot: int, sensor: int, point: vec3, direction: vec3,
        wavelength_nm: real, flux: real, history: int, emitter: int, lot: wp.float64,
    ):
        crossings.sensor[slot] = sensor
        crossings.position[slot] = point
        crossings.direction[slot] = direction
        crossings.wavelength_nm[slot] = wavelength_nm
        crossings.flux[slot] = wp.float64(flux)
        crossings.history[slot] = history
        crossings.emitter[slot] = emitter
        crossings.lot[slot] = lot

    @wp.func
    def record_crossings(
        job: job_type, ray: ray_type, t: real, alpha: real, wavelength_nm: real, flux: real,
        history: int, tints: int, draw: wp.uint64, out_photons: photons_type,
        out_counts: wp.array2d(dtype=int),
    ):
        """Record every sensor that the photon arrives at within the length t of its way.

        It starts with `flux`, and on its way loses what a medium of the coefficient alpha takes,
        which depends on the wavelength if the medium `tints`.
        """
        crossings = out_photons.crossings
        i = int(0)
        while i < job.sensors.count:
            sensor = job.sensors.sensors[i]
            arrives, length, u, v = find_crossing(sensor, ray, t)
            if arrives:
                column = int(COUNT_BINS)
                if sensor.kind == SENSOR_RAYS:
                    column = int(COUNT_RAYS)
                slot = wp.atomic_add(out_counts, job.range_row, column, 1)
                if slot < job.slot_count:
                    slot += job.first_slot
                    left = flux - flux * absorbed_fraction(alpha, length)
                    if sensor.kind == SENSOR_RAYS:
                        lot = to_unit(hash64(job.key + LOT, draw), wp.float64(0.0))
                        keep_ray(
                            crossings, slot, i, ray.origin + ray.direction * length, ray.direction,
                            wavelength_nm, left, history, job.emitter, lot,
                        )
                    else:
                        crossings.bin[slot] = bin_of(
                            job, sensor, u, v, wavelength_nm, is_dispersed(history) | tints
                        )
                        crossings.bin_flux[slot] = wp.float64(left)
            i += 1

    return record_crossings
