"""A pilot: a few photons that tell which ones are worth their while, and are then forgotten.

They are traced by the kernel that traces the picture's, but each into slots of its own, so that
what is stored can be told by who stored it. A second kernel emits the same photons again and says
with what density each of the lamp's targets would have drawn them, and where in its square.
"""

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.features import Features
from sim.launch import cut_ranges, launch_ranges
from sim.photons.cells import make_cell_functions
from sim.photons.densities import make_density_functions
from sim.photons.emission import make_emission
from sim.photons.energy import BOOK_COLUMNS
from sim.photons.lamp_structs import AIM_CONE, BEAM, make_lamp_structs
from sim.photons.lamps import Lamps
from sim.photons.photon_batch import PhotonBatch, allocate_photons
from sim.photons.photon_path import make_trace_photons
from sim.photons.tracing import make_job
from sim.sampling.directions import disk_square
from sim.scene_data import CompiledScene

__all__ = ["PILOT_PASS", "Pilot", "Shots", "make_retrace_emission", "trace_pilot"]

FloatArray = npt.NDArray[np.float64]

PILOT_PASS = -1
"""The pilot's pass index: its numbers are those of no pass of the picture."""

_RANGE_SIZE = 4096
_SLOTS = 16
"""Room for the deposits of one photon; what does not fit is the faintest, and is forgotten."""


@functools.cache
def make_retrace_emission(precision: str, features: Features) -> Any:
    """Kernel: of each photon of a stream, every target's density and place in its square."""
    structs = make_lamp_structs(precision)
    real, vec3, lamps_type = structs.real, structs.vec3, structs.Lamps
    emitter_type = structs.Emitter
    emit = make_emission(precision, features)
    before_mask = make_cell_functions(precision).before_mask
    densities = make_density_functions(precision, distant=features.distant_lamps)
    target_density, square_of_target = densities.target_density, densities.square_of_target

    @wp.func
    def square_of_profile(lamps: lamps_type, emitter: emitter_type, origin: vec3):
        offset = origin - emitter.centre
        x = wp.dot(offset, emitter.frame[0]) / emitter.half_u
        y = wp.dot(offset, emitter.frame[1]) / emitter.half_v
        if emitter.round == 1:
            return disk_square(x, y)
        s = real(0.5) + real(0.5) * x
        t = real(0.5) + real(0.5) * y
        if wp.static(features.masks):
            if emitter.first_mask >= 0:
                return before_mask(lamps.cdf, emitter, s, t)
        return s, t

    @wp.kernel(module="unique", enable_backward=False)
    def retrace_emission(
        start: int,
        lamps: lamps_type,
        emitter_row: int,
        target_row: int,
        seed_row: int,
        key: wp.uint64,
        first_row: int,
        out_density: wp.array2d(dtype=real),
        out_square: wp.array3d(dtype=wp.float32),
    ):
        index = start + wp.tid()
        row = first_row + index
        emitter = lamps.emitters[emitter_row]
        ray, _u, flux = emit(
            lamps, emitter_row, target_row, seed_row, wp.uint32(index), key
        )
        for k in range(emitter.target_count):
            target = lamps.targets[emitter.first_target + k]
            s = real(0.5)
            t = real(0.5)
            density = target.photons
            if emitter.kind == BEAM:
                s, t = square_of_profile(lamps, emitter, ray.origin)
            elif flux > real(0.0):
                density *= target_density(
                    lamps, emitter, target, ray.origin, ray.direction,
                    emitter.first_target + k == target_row,
                )
                if target.kind == AIM_CONE:
                    s, t = square_of_target(emitter, target, ray.origin, ray.direction)
            out_density[row, k] = density
            out_square[row, k, 0] = wp.float32(s)
            out_square[row, k, 1] = wp.float32(t)

    return retrace_emission


@dataclass(frozen=True)
class Shots:
    """How one lamp's photons of the pilot were emitted.

    Attributes:
        rows: the pilot's photons that are this lamp's.
        density: (photons, targets) number of photons per solid angle, and so on, of each target.
        square: (photons, targets, 2) the two numbers that each target draws them with.
    """

    rows: slice
    density: FloatArray
    square: npt.NDArray[np.float32]


@dataclass(frozen=True)
class Pilot:
    """What a pilot brings back.

    Attributes:
        shots: of each lamp.
        deposits: what was stored, as `PhotonBatch.to_numpy` gives it, but in the local frame.
        photon: (deposits,) whose each deposit is.
        photons: how many there were.
    """

    shots: tuple[Shots, ...]
    deposits: dict[str, npt.NDArray[Any]]
    photon: npt.NDArray[np.int64]
    photons: int


def trace_pilot(
    compiled: CompiledScene,
    lamps: Lamps,
    *,
    seed: int,
    max_interactions: int,
    bounces: int,
    threads: int,
) -> Pilot:
    """Trace the photons of `lamps` as a pilot.

    Args:
        compiled: the scene.
        lamps: its emitters, with as many photons as the pilot shall have.
        seed: the run's seed.
        max_interactions: surfaces that one photon and all its branches may meet.
        bounces: off diffuse surfaces, at most.
        threads: CPU threads; they do not change what is found.
    """
    lamps.seed(compiled.device, seed, PILOT_PASS)
    counts = [stream.photons for stream in lamps.streams]
    firsts = np.concatenate([[0], np.cumsum(counts)])
    run = _PilotRun(compiled, lamps, seed, max_interactions, bounces, threads, firsts)
    photons, stored = run.trace()
    density, square = run.retrace()
    shots = []
    for emitter, aims in enumerate(lamps.aims):
        mine = [k for k, stream in enumerate(lamps.streams) if stream.emitter == emitter]
        rows = slice(int(firsts[mine[0]]), int(firsts[mine[-1] + 1]))
        shots.append(Shots(rows, density[rows, : len(aims)], square[rows, : len(aims)]))
    owner = np.repeat(np.arange(firsts[-1]), stored)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(stored) - stored, stored)
    slots = (owner * _SLOTS + place).astype(np.int32)
    books: Any = None
    deposits = PhotonBatch(photons, slots, books, np.zeros(3)).to_numpy()
    return Pilot(tuple(shots), deposits, owner, int(firsts[-1]))


@dataclass(frozen=True)
class _PilotRun:
    """What the launches of one pilot share; stream number k starts at row `firsts[k]`."""

    compiled: CompiledScene
    lamps: Lamps
    seed: int
    max_interactions: int
    bounces: int
    threads: int
    firsts: npt.NDArray[np.int64]

    def _shares(self) -> list[tuple[int, int, int]]:
        """(stream, start, count) of every launch."""
        return [
            (row, start, count)
            for row, stream in enumerate(self.lamps.streams)
            for start, count in cut_ranges(stream.photons, _RANGE_SIZE)
        ]

    def _launch(self, kernel: Any, inputs_of: Any) -> None:
        """Launch a kernel over every share; `inputs_of` takes a share and its Job."""
        shares = self._shares()

        def inputs(number: int) -> list[Any]:
            row, start, count = shares[number]
            job = make_job(
                self.compiled, self.lamps, row, seed=self.seed, pass_index=PILOT_PASS
            )
            job.range_row = int(self.firsts[row]) + start
            job.first_slot = job.range_row * _SLOTS
            job.slot_count = _SLOTS
            job.slots_a_thread = _SLOTS
            job.run = 1
            job.stop = start + count
            job.max_interactions = self.max_interactions
            job.store_direct = 1
            job.bounces = self.bounces
            return list(inputs_of(row, job))

        launch_ranges(
            kernel, [share[1:] for share in shares], inputs, device=self.compiled.device,
            threads=self.threads,
        )

    def trace(self) -> tuple[Any, npt.NDArray[np.int32]]:
        """The Photons struct, and how many slots of its own each photon has filled."""
        compiled, device, total = self.compiled, self.compiled.device, int(self.firsts[-1])
        photons = allocate_photons(compiled.precision, device, total * _SLOTS)
        counts = wp.zeros((total, 1), dtype=int, device=device)
        books = wp.zeros((total, len(BOOK_COLUMNS)), dtype=wp.float64, device=device)
        self._launch(
            make_trace_photons(compiled.precision, compiled.features),
            lambda _, job: [compiled.data, self.lamps.data, job, photons, counts, books],
        )
        return photons, np.minimum(counts.numpy()[:, 0], _SLOTS)

    def retrace(self) -> tuple[FloatArray, npt.NDArray[np.float32]]:
        """Density and place in the square, of every photon and target of its lamp."""
        compiled, total = self.compiled, int(self.firsts[-1])
        targets = max(len(aims) for aims in self.lamps.aims)
        density = wp.zeros((total, targets), dtype=compiled.structs.real, device=compiled.device)
        square = wp.zeros((total, targets, 2), dtype=wp.float32, device=compiled.device)
        self._launch(
            make_retrace_emission(compiled.precision, compiled.features),
            lambda row, job: [
                self.lamps.data, job.emitter, job.target, job.seed_row, job.key,
                int(self.firsts[row]), density, square,
            ],
        )
        return density.numpy().astype(np.float64), square.numpy()
