"""Run a kernel over ranges of indices, on every core of the CPU or on the GPU.

A Warp launch on the CPU is one serial loop, but it releases Python's lock, so a thread pool of
launches over disjoint ranges runs on all cores. Ranges are cut by size alone, never by the number
of threads, and each range owns its outputs: results are bitwise equal for any thread count.

CPU atomics are plain additions: no two ranges may add to the same element.
"""

import queue
import threading
from collections.abc import Callable, Sequence
from typing import Any

import warp as wp

__all__ = ["Range", "cut_ranges", "launch_ranges", "load_kernels"]

Range = tuple[int, int]
"""(start, count) of the indices that one launch covers."""

_PACKING = threading.Lock()
"""Held while Warp's Python side prepares launches: two passes may be under way at once."""

_POLL_S = 0.1
"""How often the waiting thread looks up, so that Ctrl-C is heard."""


def cut_ranges(total: int, size: int) -> list[Range]:
    """Cut `total` indices into ranges of `size` (the last one shorter)."""
    return [(start, min(size, total - start)) for start in range(0, total, size)]


def load_kernels(kernels: Sequence[Any], *, device: str, threads: int) -> None:
    """Compile or load the modules of `kernels`, on as many cores as there are.

    A launch would do so too, one after the other: most of a first run's time.
    """
    modules = [kernel.module for kernel in kernels]
    wp.force_load(device, modules, max_workers=threads)


def launch_ranges(
    kernel: Any,
    ranges: Sequence[Range],
    inputs_of: Callable[[int], list[Any]],
    *,
    device: str,
    threads: int,
    run: int = 1,
    stop: threading.Event | None = None,
    on_done: Callable[[int], None] | None = None,
) -> None:
    """Launch `kernel` once a range, and wait for all.

    Args:
        kernel: its first parameter is the range's start (int); the rest come from `inputs_of`.
        ranges: disjoint index ranges.
        inputs_of: maps a range's number to the kernel's remaining arguments.
        device: "cpu" or a CUDA device.
        threads: CPU threads; a GPU is fed from one thread.
        run: indices that one thread of the kernel covers in turn, from start + tid · run on.
        stop: once set, from another thread, no further range is started and the call returns.
        on_done: told the number of finished indices after each range, from the calling thread.

    Raises:
        KeyboardInterrupt: within one range's time of Ctrl-C, all workers having stopped.
    """
    # Recording loads the kernel's module and packs the arguments, which is safe in one thread at
    # a time; only the native call is in several.
    with _PACKING:
        commands = _record(kernel, ranges, inputs_of, device, run)
    pending: queue.SimpleQueue[int] = queue.SimpleQueue()
    for number in range(len(ranges)):
        pending.put(number)
    finished: queue.SimpleQueue[int | BaseException] = queue.SimpleQueue()
    halt = threading.Event() if stop is None else stop

    def work() -> None:
        while not halt.is_set():
            try:
                number = pending.get_nowait()
            except queue.Empty:
                return
            try:
                commands[number].launch()
            except BaseException as error:
                finished.put(error)
                return
            finished.put(number)

    workers = 1 if device != "cpu" else min(threads, max(1, len(ranges)))
    crew = [threading.Thread(target=work, daemon=True) for _ in range(workers)]
    for thread in crew:
        thread.start()
    try:
        _collect(ranges, finished, halt, on_done)
        if device != "cpu":
            wp.synchronize_device(device)
    except BaseException:
        halt.set()
        raise
    finally:
        for thread in crew:
            thread.join()


def _record(
    kernel: Any,
    ranges: Sequence[Range],
    inputs_of: Callable[[int], list[Any]],
    device: str,
    run: int,
) -> list[Any]:
    """A recorded launch for every range."""
    return [
        wp.launch(
            kernel,
            dim=-(-count // run),
            inputs=[start, *inputs_of(number)],
            device=device,
            record_cmd=True,
        )
        for number, (start, count) in enumerate(ranges)
    ]


def _collect(
    ranges: Sequence[Range],
    finished: "queue.SimpleQueue[int | BaseException]",
    halt: threading.Event,
    on_done: Callable[[int], None] | None,
) -> None:
    """Wait for every range; hand on the first error; tell `on_done` of progress."""
    for _ in ranges:
        while True:
            try:
                item = finished.get(timeout=_POLL_S)
            except queue.Empty:
                if halt.is_set():
                    return
                continue
            break
        if isinstance(item, BaseException):
            raise item
        if on_done is not None:
            on_done(ranges[item][1])
