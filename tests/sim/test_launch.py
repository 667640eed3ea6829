"""Ranges of indices on many cores: complete, deterministic, interruptible."""

import signal
import threading
import time

import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.launch import cut_ranges, launch_ranges
from sim.sampling.counter import hash64

TOTAL = 10_007  # a prime: no range size divides it


@wp.kernel(enable_backward=False, module="tests_launch")
def chaotic_orbit(start: int, steps: int, out: wp.array(dtype=wp.float64)):
    """A number that any difference in rounding or in seeding would change."""
    i = start + wp.tid()
    bits = hash64(wp.uint64(7), wp.uint64(i)) >> wp.uint64(11)
    x = wp.float64(bits) * wp.float64(1.1102230246251565e-16)  # 53 bits, times 2⁻⁵³
    for _ in range(steps):
        x = wp.float64(3.99) * x * (wp.float64(1.0) - x)
    out[i] += x + wp.float64(1.0)


@pytest.fixture(scope="module", autouse=True)
def _device() -> None:
    start_device("cpu")


def run(ranges, *, threads, steps=100, on_done=None):
    out = wp.zeros(TOTAL, dtype=wp.float64, device="cpu")
    launch_ranges(
        chaotic_orbit, ranges, lambda _: [steps, out], device="cpu", threads=threads,
        on_done=on_done,
    )  # fmt: skip
    return out.numpy()


def test_a_kernel_is_compiled_once():
    # Warp compiles a variant for every block size that is asked for; a launch on the CPU uses 1.
    run(cut_ranges(TOTAL, 1000), threads=2)
    assert len(chaotic_orbit.module.execs) == 1


@pytest.mark.parametrize("size", [1, 1000, TOTAL - 1, TOTAL, TOTAL + 1])
def test_ranges_cover_every_index_once(size):
    ranges = cut_ranges(TOTAL, size)
    indices = np.concatenate([np.arange(start, start + count) for start, count in ranges])
    np.testing.assert_array_equal(indices, np.arange(TOTAL))
    assert all(count == size for _, count in ranges[:-1])
    assert 0 < ranges[-1][1] <= size


def test_nothing_is_cut_into_no_ranges():
    assert cut_ranges(0, 5) == []


def test_no_ranges_are_no_work():
    assert not run([], threads=3).any()


def test_every_index_is_launched_once():
    # One addition an index, of a number from 1 to 2: twice would be 2 and more, never would be 0.
    out = run(cut_ranges(TOTAL, 300), threads=3)
    assert out.min() >= 1.0
    assert out.max() < 2.0


def test_the_number_of_threads_does_not_change_a_bit():
    ranges = cut_ranges(TOTAL, 97)
    once = run(ranges, threads=1)
    assert len(np.unique(once)) > 0.99 * TOTAL
    for threads in (2, 4):
        np.testing.assert_array_equal(run(ranges, threads=threads), once)


def test_ranges_may_be_of_any_size():
    whole = run([(0, TOTAL)], threads=2)
    np.testing.assert_array_equal(run(cut_ranges(TOTAL, 999), threads=2), whole)


def test_each_range_gets_its_own_arguments():
    outs = [wp.zeros(TOTAL, dtype=wp.float64, device="cpu") for _ in range(2)]
    ranges = [(0, 10), (10, 20)]
    launch_ranges(chaotic_orbit, ranges, lambda n: [1, outs[n]], device="cpu", threads=2)
    assert [np.flatnonzero(out.numpy()).tolist() for out in outs] == [
        list(range(10)),
        list(range(10, 30)),
    ]


def test_progress_adds_up_and_is_told_by_the_calling_thread():
    told, tellers = [], set()

    def on_done(count):
        told.append(count)
        tellers.add(threading.current_thread())

    run(cut_ranges(TOTAL, 1000), threads=2, on_done=on_done)
    assert sum(told) == TOTAL
    assert tellers == {threading.current_thread()}


def test_an_error_of_the_caller_reaches_it_and_stops_the_workers():
    def on_done(count):
        raise RuntimeError(f"no room for {count}")

    before = threading.active_count()
    with pytest.raises(RuntimeError, match="no room for 10"):
        run(cut_ranges(TOTAL, 10), threads=2, on_done=on_done)
    assert threading.active_count() == before


class FailingCommand:
    """A recorded launch that fails, as one does on a lost device."""

    def launch(self):
        raise RuntimeError("the device is gone")


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_in_a_worker_reaches_the_caller(monkeypatch, threads):
    record = wp.launch
    recorded = []

    def launch(*arguments, **options):
        recorded.append(record(*arguments, **options))
        return FailingCommand() if len(recorded) == 3 else recorded[-1]

    monkeypatch.setattr(wp, "launch", launch)
    before = threading.active_count()
    with pytest.raises(RuntimeError, match="the device is gone"):
        run(cut_ranges(TOTAL, 1000), threads=threads)
    assert threading.active_count() == before


def test_wrong_arguments_are_refused_before_anything_runs():
    with pytest.raises(RuntimeError):
        launch_ranges(
            chaotic_orbit, [(0, 1)], lambda _: ["many", None], device="cpu", threads=1
        )  # fmt: skip


def test_ctrl_c_stops_the_workers_within_a_range():
    # Ranges of some milliseconds each, far more of them than will be run.
    ranges = [(0, 2000)] * 2000
    finished = []
    before = threading.active_count()
    timer = threading.Timer(0.05, signal.raise_signal, [signal.SIGINT])

    def on_done(count):
        if not finished:
            timer.start()
        finished.append(count)

    out = wp.zeros(TOTAL, dtype=wp.float64, device="cpu")
    with pytest.raises(KeyboardInterrupt):
        launch_ranges(
            chaotic_orbit, ranges, lambda _: [1000, out], device="cpu", threads=2, on_done=on_done
        )
    timer.join()
    assert 0 < len(finished) < len(ranges)
    assert threading.active_count() == before
    stopped = out.numpy().copy()
    time.sleep(0.05)
    np.testing.assert_array_equal(out.numpy(), stopped)
