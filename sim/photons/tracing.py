"""One pass of photons: traced over ranges on every core, and stored where they arrive."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.launch import cut_ranges, launch_ranges
from sim.photons.energy import BOOK_COLUMNS, EnergyBooks
from sim.photons.lamps import Lamps
from sim.photons.photon_batch import PhotonBatch, allocate_photons
from sim.photons.photon_path import COLOURS, make_trace_photons
from sim.photons.photon_structs import make_photon_structs
from sim.sampling.counter import fold_key
from sim.sampling.sobol import DIMENSIONS
from sim.scene_data import CompiledScene
from sim.sensors.crossing import COUNT_BINS, COUNT_RAYS
from sim.sensors.pass_crossings import allocate_crossings, collect_crossings
from sim.sensors.sensor_bank import SensorBank

__all__ = ["make_job", "trace_photons"]

RANGE_SIZE = 16384
"""Photons a launch: some milliseconds of work, so that cores share evenly and Ctrl-C is heard."""

RUN_LENGTH = 256
"""Photons that a thread of the CPU traces in turn, so that what it costs to start one is spread
over them. On a GPU each photon has a thread."""

BRANCH_THRESHOLD = 0.01
"""What `branch_threshold` is in a rendering."""

_ROW = 32
"""Numbers in a range's row of counters, of which few are used: no two cores write to one cache
line."""

_COUNTERS = 3
"""Numbers that a range counts: its deposits, crossings of bins, and rays that are kept."""

_SLOTS_PER_PHOTON = 6 * int(COLOURS)
"""Room for deposits: on the CPU it takes address space, not memory, until it is written to. A
pass that needs more is traced again with room for exactly what its kernels counted."""


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
    store_direct: bool = True,
    sensors: SensorBank | None = None,
    bounces: int = 0,
    stop: threading.Event | None = None,
    on_done: Callable[[int], None] | None = None,
    range_size: int = RANGE_SIZE,
    branch_threshold: float = BRANCH_THRESHOLD,
    by_band: bool = True,
) -> PhotonBatch:
    """Emit and trace one pass of photons.

    Args:
        compiled: the scene.
        lamps: its emitters, with the streams of this pass.
        seed: the run's seed.
        pass_index: which pass: it alone decides the scramble.
        max_interactions: surfaces that one photon and all its branches may meet.
        threads: CPU threads.
        store_direct: also store what comes straight from a lamp; else it is only in the books.
        sensors: what else the photons leave traces on; None: nothing.
        bounces: off diffuse surfaces, at most, if the kernels know of them.
        stop: once set, from another thread, tracing ends; the batch is then incomplete.
        on_done: told of finished photons.
        range_size: photons a launch.
        branch_threshold: a branch below this fraction of its photon's flux plays roulette for it.
        by_band: keep energy books of each band of the film, too.
    """
    lamps.seed(compiled.device, seed, pass_index)
    shares: list[_Share] = []
    slot = 0
    for row, stream in enumerate(lamps.streams):
        for start, count in cut_ranges(stream.photons, range_size):
            room = count * _SLOTS_PER_PHOTON
            shares.append(_Share(row, start, count, slot, room))
            slot += room
    run = _Run(
        compiled, lamps, seed, pass_index, max_interactions, threads, store_direct, sensors,
        bounces, stop, branch_threshold, compiled.scene.film.bands if by_band else 0,
    )
    photons, counts, books = run.trace(shares, slot, on_done)
    if any(counts[i].max() > share.slot_count for i, share in enumerate(shares)):
        # Their kernels counted what did not fit: now the need of every range is known exactly.
        slot = 0
        for share, count in zip(shares, counts, strict=True):
            share.first_slot, share.slot_count = slot, int(count.max())
            slot += share.slot_count
        photons, counts, books = run.trace(shares, slot, None)
    crossings = None
    if sensors is not None:
        crossings = collect_crossings(
            photons.crossings, sensors, _slots(shares, counts[:, int(COUNT_BINS)]),
            _slots(shares, counts[:, int(COUNT_RAYS)]), compiled.origin,
        )
    stored = counts[:, 0]
    band_books = photons.band_books.numpy() if by_band else None
    return PhotonBatch(
        photons, _slots(shares, stored), EnergyBooks.from_rows(books, band_books), compiled.origin,
        stored, crossings,
    )


def _slots(shares: list[_Share], counts: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """The slots that are filled, if each range has filled as many as `counts` says."""
    return np.concatenate(
        [
            np.arange(share.first_slot, share.first_slot + count, dtype=np.int32)
            for share, count in zip(shares, counts, strict=True)
        ]
    )


@dataclass(frozen=True)
class _Run:
    """One pass's kernel and what its launches share."""

    compiled: CompiledScene
    lamps: Lamps
    seed: int
    pass_index: int
    max_interactions: int
    threads: int
    store_direct: bool
    sensors: SensorBank | None
    bounces: int
    stop: threading.Event | None
    branch_threshold: float
    bands: int

    def trace(
        self, shares: list[_Share], slots: int, on_done: Callable[[int], None] | None
    ) -> tuple[Any, npt.NDArray[np.int32], npt.NDArray[np.float64]]:
        """Launch every share; return the Photons struct, what each share counted, and its books."""
        compiled, device = self.compiled, self.compiled.device
        kernel = make_trace_photons(compiled.precision, compiled.features)
        photons = allocate_photons(compiled.precision, device, slots)
        if self.sensors is not None:
            allocate_crossings(photons.crossings, self.sensors, compiled.precision, max(1, slots))
        if self.bands > 0:
            width = self.bands * len(BOOK_COLUMNS)
            photons.band_books = wp.zeros((len(shares), width), dtype=wp.float64, device=device)
        counts = wp.zeros((len(shares), _ROW), dtype=int, device=device)
        books = wp.zeros((len(shares), _ROW), dtype=wp.float64, device=device)

        def inputs_of(number: int) -> list[Any]:
            job = self._job(number, shares[number])
            return [compiled.data, self.lamps.data, job, photons, counts, books]

        launch_ranges(
            kernel,
            [(share.start, share.count) for share in shares],
            inputs_of,
            device=device,
            threads=self.threads,
            run=self._run_length,
            stop=self.stop,
            on_done=on_done,
        )
        return photons, counts.numpy()[:, :_COUNTERS], books.numpy()[:, : len(BOOK_COLUMNS)]

    @property
    def _run_length(self) -> int:
        """Photons that one thread traces in turn."""
        return RUN_LENGTH if self.compiled.device == "cpu" else 1

    def _job(self, number: int, share: _Share) -> Any:
        """The Job struct of one range."""
        job = make_job(
            self.compiled, self.lamps, share.stream_row, seed=self.seed, pass_index=self.pass_index
        )
        job.range_row = number
        job.first_slot = share.first_slot
        job.slot_count = share.slot_count
        job.run = self._run_length
        job.stop = share.start + share.count
        job.max_interactions = self.max_interactions
        job.store_direct = int(self.store_direct)
        job.branch_threshold = self.branch_threshold
        if self.sensors is not None:
            job.sensors = self.sensors.data
        job.bounces = self.bounces
        film = self.compiled.scene.film
        job.bands = self.bands
        job.first_edge_nm = float(film.edges_nm[0])
        job.band_width_nm = film.spacing_nm
        return job


def make_job(
    compiled: CompiledScene, lamps: Lamps, stream_row: int, *, seed: int, pass_index: int
) -> Any:
    """A Job struct with what a stream has in a pass; its ranges fill in the rest."""
    stream = lamps.streams[stream_row]
    job = make_photon_structs(compiled.precision).Job()
    job.emitter = stream.emitter
    job.target = stream.target
    job.seed_row = stream_row * DIMENSIONS
    job.key = fold_key(seed, pass_index, stream_row)
    job.branch_threshold = BRANCH_THRESHOLD
    return job
