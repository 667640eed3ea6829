"""A launch's photons: emitted from a lamp, in the colours they need, and followed.

References:
    Jensen (1996), "Global illumination using photon maps", §2.1: photon tracing.
"""

import functools
from typing import Any

import warp as wp

from sim.features import Features
from sim.photons.emission import make_emission, make_wavelength_function
from sim.photons.emitted_light import make_emitted_light
from sim.photons.energy import BOOK_COLUMNS
from sim.photons.lamp_structs import DISTANT, make_lamp_structs
from sim.photons.photon_branches import FLOWS, make_follow
from sim.photons.photon_structs import (
    make_photon_structs,
)
from sim.sampling.draws import first_draw
from sim.transport import (
    make_transport,
)

__all__ = ["COLOURS", "make_trace_photons"]

COLOURS = wp.constant(4)
"""Wavelengths, evenly spread over the lamp's distribution, of a photon that meets a dispersive
surface first: light that leaves the glass nearly where it would without dispersion stays white
from few photons."""

COLUMNS = wp.constant(len(BOOK_COLUMNS))


@functools.cache
def make_trace_photons(precision: str, features: Features) -> Any:
    """Kernel `trace_photons(start, scene, lamps, job, photons, counts, books)`."""
    transport = make_transport(precision, features)
    real, scene_type, intersect = transport.real, transport.Scene, transport.intersect
    lamp_structs, ray_type = make_lamp_structs(precision), transport.Ray
    free_ray = transport.free_ray
    lamps_type, emitter_type = lamp_structs.Lamps, lamp_structs.Emitter
    photon_structs = make_photon_structs(precision)
    photons_type, job_type = photon_structs.Photons, photon_structs.Job
    emit = make_emission(precision, features)
    sample_wavelength = make_wavelength_function(precision)
    follow = make_follow(precision, features)
    emitted_light = make_emitted_light(precision, features)

    @wp.func
    def is_shaded(scene: scene_type, emitter: emitter_type, ray: ray_type):
        """Whether light from afar has met something endless before it comes near the scene."""
        if emitter.kind != DISTANT:
            return False
        hit = intersect(scene, free_ray(ray.origin, -ray.direction))
        return hit.prim >= 0

    @wp.func
    def book(
        job: job_type, wavelength_nm: real, flux: real, flows: FLOWS, out_photons: photons_type
    ):
        """Enter what became of `flux` at a wavelength into the books of its band."""
        if job.bands > 0:
            band = int((wavelength_nm - job.first_edge_nm) / job.band_width_nm)
            column = wp.clamp(band, 0, job.bands - 1) * int(COLUMNS)
            wp.atomic_add(out_photons.band_books, job.range_row, column, wp.float64(flux))
            for k in range(4):
                wp.atomic_add(out_photons.band_books, job.range_row, column + 1 + k, flows[k])

    @wp.func
    def trace_photon(
        scene: scene_type, lamps: lamps_type, job: job_type, index: wp.uint32,
        out_photons: photons_type, out_counts: wp.array2d(dtype=int),
    ):
        """Emit photon `index` and follow it; returns the flux emitted, and FLOWS."""
        ray, u_wavelength, emitted = emit(
            lamps, job.emitter, job.target, job.seed_row, index, job.key
        )
        flows = FLOWS()
        if wp.static(features.distant_lamps and features.flats):
            if is_shaded(scene, lamps.emitters[job.emitter], ray):
                flows[2] = wp.float64(emitted)
                wavelength_nm = sample_wavelength(
                    lamps, lamps.emitters[job.emitter], u_wavelength
                )
                book(job, wavelength_nm, emitted, flows, out_photons)
                return emitted, flows
        if emitted > real(0.0):
            # What meets a dispersive surface first is followed in several colours at once.
            colours = int(1)
            first = intersect(scene, ray)
            if wp.static(features.dispersion):
                if first.prim >= 0:
                    if scene.bodies[first.prim].dispersive == 1:
                        colours = int(COLOURS)
            flux = emitted / real(colours)
            light, frame = emitted_light(lamps, job.emitter, ray.direction)
            colour = int(0)
            while colour < colours:
                u = u_wavelength + real(colour) / real(colours)
                wavelength_nm = sample_wavelength(
                    lamps, lamps.emitters[job.emitter], u - wp.floor(u)
                )
                draws = first_draw(index, colour)
                went = follow(
                    scene, job, ray, first, wavelength_nm, flux, light, frame, draws, out_photons,
                    out_counts,
                )
                book(job, wavelength_nm, flux, went, out_photons)
                flows += went
                colour += 1
        return emitted, flows

    @wp.kernel(module="unique", enable_backward=False)
    def trace_photons(
        start: int,
        scene: scene_type,
        lamps: lamps_type,
        job: job_type,
        out_photons: photons_type,
        out_counts: wp.array2d(dtype=int),
        out_books: wp.array2d(dtype=wp.float64),
    ):
        total = wp.float64(0.0)
        flows = FLOWS()
        if job.slots_a_thread > 0:
            job.range_row += wp.tid()
            job.first_slot += wp.tid() * job.slots_a_thread
        index = start + wp.tid() * job.run
        stop = wp.min(index + job.run, job.stop)
        while index < stop:
            emitted, went = trace_photon(
                scene, lamps, job, wp.uint32(index), out_photons, out_counts
            )
            total += wp.float64(emitted)
            flows += went
            index += 1
        wp.atomic_add(out_books, job.range_row, 0, total)
        for column in range(4):
            wp.atomic_add(out_books, job.range_row, column + 1, flows[column])

    return trace_photons
