"""Trace photons from the lamps to the diffuse surfaces, and store what arrives.

At a boundary the stronger of the two branches is followed with its weight and the other is put
on a stack while its flux matters; below a threshold either plays Russian roulette for the
threshold's flux. Nothing is averaged away, and the books keep what roulette adds or takes.

References:
    Jensen (1996), "Global illumination using photon maps", §2.1: photon tracing.
"""

import functools
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.features import Features
from sim.launch import cut_ranges, launch_ranges
from sim.photons.emission import make_emission, make_wavelength_function
from sim.photons.energy import BOOK_COLUMNS, EnergyBooks
from sim.photons.lamp_structs import make_lamp_structs
from sim.photons.lamps import Lamps
from sim.photons.photon_batch import PhotonBatch, allocate_photons
from sim.photons.photon_structs import (
    add_event,
    make_photon_structs,
    mark_dispersed,
    surface_key,
)
from sim.sampling.counter import fold_key
from sim.sampling.roulette import play_roulette
from sim.sampling.sobol import DIMENSIONS
from sim.scene_data import CompiledScene
from sim.transport import EVENT_ABSORB, EVENT_BOUNDARY, EVENT_DEPOSIT, make_transport

__all__ = ["make_trace_photons", "trace_photons"]

RANGE_SIZE = 8192
"""Photons a launch: some milliseconds of work, so that cores share evenly and Ctrl-C is heard."""

BRANCH_THRESHOLD = 0.01
"""A branch below this fraction of its photon's flux plays roulette for it."""

STACK_SIZE = wp.constant(8)

COLOURS = wp.constant(4)
"""Wavelengths, evenly spread over the lamp's distribution, of a photon that meets a dispersive
surface first: light that leaves the glass nearly where it would without dispersion stays white
from few photons."""

_SLOTS_PER_PHOTON = 6 * int(COLOURS)
"""Room for deposits: on the CPU it takes address space, not memory, until it is written to. A
pass that needs more is traced again with room for exactly what its kernels counted."""


@functools.cache
def make_trace_photons(precision: str, features: Features) -> Any:
    """Kernel `trace_photons(start, scene, lamps, job, photons, counts, books)`."""
    transport = make_transport(precision, features)
    real, vec3, interact = transport.real, transport.vec3, transport.interact
    media_indices, split = transport.media_indices, transport.split
    scene_type, ray_type = transport.Scene, transport.Ray
    lamps_type = make_lamp_structs(precision).Lamps
    photon_structs = make_photon_structs(precision)
    photons_type, job_type = photon_structs.Photons, photon_structs.Job
    emit = make_emission(precision)
    sample_wavelength = make_wavelength_function(precision)
    intersect = transport.intersect

    @wp.func
    def store(
        photons: photons_type, slot: int, point: vec3, direction: vec3, wavelength_nm: real,
        flux: real, surface: int, history: int, emitter: int,
    ):
        photons.position[slot] = point
        photons.direction[slot] = wp.vec3(
            wp.float32(direction[0]), wp.float32(direction[1]), wp.float32(direction[2])
        )
        photons.wavelength_nm[slot] = wp.float32(wavelength_nm)
        photons.flux[slot] = wp.float64(flux)
        photons.surface[slot] = surface
        photons.history[slot] = history
        photons.emitter[slot] = emitter

    @wp.func
    def follow(
        scene: scene_type, job: job_type, start_ray: ray_type, wavelength_nm: real,
        start_flux: real, draws: wp.uint64, out_photons: photons_type,
        out_counts: wp.array(dtype=int),
    ):
        """Follow a photon of one wavelength and all its branches; see where its flux goes.

        Returns flux deposited, absorbed, escaped and culled.
        """
        indices = media_indices(scene, wavelength_nm)
        deposited = real(0.0)
        absorbed = real(0.0)
        escaped = real(0.0)
        culled = real(0.0)
        ray = start_ray
        flux = start_flux
        threshold = flux * job.branch_threshold
        history = int(0)

        stack_ray = wp.zeros(shape=(8,), dtype=ray_type)
        stack_flux = wp.zeros(shape=(8,), dtype=real)
        stack_history = wp.zeros(shape=(8,), dtype=int)
        depth = int(0)
        alive = flux > real(0.0)
        for step in range(job.max_interactions):
            if not alive:
                if depth == 0:
                    break
                depth -= 1
                # Field by field: see `interact`.
                pending = stack_ray[depth]
                ray.origin = pending.origin
                ray.direction = pending.direction
                ray.prim = pending.prim
                ray.face = pending.face
                flux = stack_flux[depth]
                history = stack_history[depth]
                alive = True
            met = interact(scene, ray, indices)
            if met.event == EVENT_BOUNDARY:
                history = mark_dispersed(history, met.dispersive)
                stronger, weaker, refracts = split(met)
                side_flux = flux * met.reflectance
                if refracts == 0:
                    side_flux = flux - side_flux
                flux -= side_flux
                side_history = add_event(history, 1 - refracts)
                history = add_event(history, refracts)
                ray.origin = met.point
                ray.direction = stronger
                ray.prim = met.prim
                ray.face = met.face
                draw = draws + wp.uint64(step)
                if depth == STACK_SIZE:
                    # No room for a side branch: chance chooses one of both for the light of both.
                    both = flux + side_flux
                    if play_roulette(side_flux, both, job.key + wp.uint64(1), draw) > real(0.0):
                        ray.direction = weaker
                        history = side_history
                    flux = both
                else:
                    kept = play_roulette(side_flux, threshold, job.key + wp.uint64(1), draw)
                    culled += side_flux - kept
                    if kept > real(0.0):
                        side_ray = ray_type()
                        side_ray.origin = met.point
                        side_ray.direction = weaker
                        side_ray.prim = met.prim
                        side_ray.face = met.face
                        stack_ray[depth] = side_ray
                        stack_flux[depth] = kept
                        stack_history[depth] = side_history
                        depth += 1
                # The stronger branch plays as well: a path reflected again and again, and ever
                # fainter, would use up the interactions that the branches behind it need.
                kept = play_roulette(flux, threshold, job.key + wp.uint64(2), draw)
                culled += flux - kept
                flux = kept
                alive = flux > real(0.0)
            else:
                alive = False
                if met.event == EVENT_DEPOSIT:
                    deposited += flux
                    slot = wp.atomic_add(out_counts, job.range_row, 1)
                    if slot < job.slot_count:
                        store(
                            out_photons, job.first_slot + slot, met.point, ray.direction,
                            wavelength_nm, flux, surface_key(met.prim, met.face, met.side),
                            history, job.emitter,
                        )
                elif met.event == EVENT_ABSORB:
                    absorbed += flux
                else:
                    escaped += flux

        if alive:
            culled += flux
        for k in range(depth):
            culled += stack_flux[k]
        return deposited, absorbed, escaped, culled

    @wp.kernel(module="unique", enable_backward=False)
    def trace_photons(
        start: int,
        scene: scene_type,
        lamps: lamps_type,
        job: job_type,
        out_photons: photons_type,
        out_counts: wp.array(dtype=int),
        out_books: wp.array2d(dtype=wp.float64),
    ):
        index = wp.uint32(start + wp.tid())
        ray, u_wavelength, flux = emit(
            lamps, job.emitter, job.target, job.seed_row, index, job.key
        )
        wp.atomic_add(out_books, job.range_row, 0, wp.float64(flux))
        # What meets a dispersive surface first is followed in several colours at once.
        colours = int(1)
        first = intersect(scene, ray)
        if first.prim >= 0:
            if scene.bodies[first.prim].dispersive == 1:
                colours = int(COLOURS)
        flux /= real(colours)
        for colour in range(colours):
            u = u_wavelength + real(colour) / real(colours)
            wavelength_nm = sample_wavelength(lamps, lamps.emitters[job.emitter], u - wp.floor(u))
            draws = (wp.uint64(index) << wp.uint64(24)) + (wp.uint64(colour) << wp.uint64(17))
            deposited, absorbed, escaped, culled = follow(
                scene, job, ray, wavelength_nm, flux, draws, out_photons, out_counts
            )
            wp.atomic_add(out_books, job.range_row, 1, wp.float64(deposited))
            wp.atomic_add(out_books, job.range_row, 2, wp.float64(absorbed))
            wp.atomic_add(out_books, job.range_row, 3, wp.float64(escaped))
            wp.atomic_add(out_books, job.range_row, 4, wp.float64(culled))

    return trace_photons


@dataclass
class _Share:
    """One range's place: its stream, its photons, its slots."""

    stream_row: int
    start: int
    count: int
    first_slot: int
    slot_count: int


def trace_photons(
    compiled: CompiledScene,
    lamps: Lamps,
    *,
    seed: int,
    pass_index: int,
    max_interactions: int,
    threads: int,
    stop: threading.Event | None = None,
    on_done: Callable[[int], None] | None = None,
) -> PhotonBatch:
    """Emit and trace one pass of photons.

    Args:
        compiled: the scene.
        lamps: its emitters, with the streams of this pass.
        seed: the run's seed.
        pass_index: which pass: it alone decides the scramble.
        max_interactions: surfaces that one photon and all its branches may meet.
        threads: CPU threads.
        stop: once set, from another thread, tracing ends; the batch is then incomplete.
        on_done: told of finished photons.
    """
    lamps.seed(compiled.device, seed, pass_index)
    shares: list[_Share] = []
    slot = 0
    for row, stream in enumerate(lamps.streams):
        for start, count in cut_ranges(stream.photons, RANGE_SIZE):
            room = count * _SLOTS_PER_PHOTON
            shares.append(_Share(row, start, count, slot, room))
            slot += room
    run = _Run(compiled, lamps, seed, pass_index, max_interactions, threads, stop)
    photons, counts, books = run.trace(shares, slot, on_done)
    short = [i for i, share in enumerate(shares) if counts[i] > share.slot_count]
    if short:
        # Their kernels counted what did not fit: now the need of every range is known exactly.
        slot = 0
        for share, count in zip(shares, counts, strict=True):
            share.first_slot, share.slot_count = slot, int(count)
            slot += int(count)
        photons, counts, books = run.trace(shares, slot, None)
    slots = np.concatenate(
        [
            np.arange(share.first_slot, share.first_slot + count, dtype=np.int32)
            for share, count in zip(shares, counts, strict=True)
        ]
    )
    return PhotonBatch(photons, slots, EnergyBooks.from_rows(books), compiled.origin)


@dataclass(frozen=True)
class _Run:
    """One pass's kernel and what its launches share."""

    compiled: CompiledScene
    lamps: Lamps
    seed: int
    pass_index: int
    max_interactions: int
    threads: int
    stop: threading.Event | None

    def trace(
        self, shares: list[_Share], slots: int, on_done: Callable[[int], None] | None
    ) -> tuple[Any, npt.NDArray[np.int32], npt.NDArray[np.float64]]:
        """Launch every share; return the Photons struct, deposits a share, and books a share."""
        compiled, device = self.compiled, self.compiled.device
        kernel = make_trace_photons(compiled.precision, compiled.features)
        photons = allocate_photons(compiled.precision, device, slots)
        counts = wp.zeros(len(shares), dtype=int, device=device)
        books = wp.zeros((len(shares), len(BOOK_COLUMNS)), dtype=wp.float64, device=device)

        def inputs_of(number: int) -> list[Any]:
            job = self._job(number, shares[number])
            return [compiled.data, self.lamps.data, job, photons, counts, books]

        launch_ranges(
            kernel,
            [(share.start, share.count) for share in shares],
            inputs_of,
            device=device,
            threads=self.threads,
            stop=self.stop,
            on_done=on_done,
        )
        return photons, counts.numpy(), books.numpy()

    def _job(self, number: int, share: _Share) -> Any:
        """The Job struct of one range."""
        stream = self.lamps.streams[share.stream_row]
        job = make_photon_structs(self.compiled.precision).Job()
        job.emitter = stream.emitter
        job.target = stream.target
        job.seed_row = share.stream_row * DIMENSIONS
        job.key = fold_key(self.seed, self.pass_index, share.stream_row)
        job.range_row = number
        job.first_slot = share.first_slot
        job.slot_count = share.slot_count
        job.max_interactions = self.max_interactions
        job.branch_threshold = BRANCH_THRESHOLD
        return job
