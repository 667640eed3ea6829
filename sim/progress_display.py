"""Progress of a rendering for people: a bar on a terminal, plain lines in a log."""

from __future__ import annotations

import contextlib
import math
import threading
from collections.abc import Iterator
from typing import TextIO

from sim.progress import Progress, ProgressCallback

__all__ = ["ProgressLines", "progress_display", "progress_text"]

_SECONDS_BETWEEN_LINES = 2.0


@contextlib.contextmanager
def progress_display(stream: TextIO) -> Iterator[ProgressCallback]:
    """Show progress on `stream` while the block runs.

    Args:
        stream: Where to: a terminal gets a bar that stays in place, anything else plain lines.

    Yields:
        The callback to hand to the renderer; it may be called from any thread.
    """
    if not stream.isatty():
        lines = ProgressLines(stream)
        try:
            yield lines
        finally:
            lines.close()
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as RichProgress

    columns = BarColumn(), TextColumn("{task.description}", markup=False)
    with RichProgress(*columns, console=Console(file=stream), transient=True) as bar:
        task = bar.add_task("starting", total=None)
        pace = _Pace()

        def show(progress: Progress) -> None:
            bar.update(
                task,
                total=None if progress.is_open else progress.photons_total,
                completed=progress.photons_done,
                description=progress_text(progress, *pace.after(progress)),
            )

        yield show


class ProgressLines:
    """Writes a line when a stage begins in the first pass, and then one every two seconds.

    A run that was interrupted is left behind, and may report for a while: not between the halves of
    another line, and after `close` not at all. A stream that takes no more is as good as closed.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._lock = threading.Lock()
        self._closed = False
        self._pace = _Pace()
        self._stages: set[str] = set()
        self._last_seconds = -math.inf

    def __call__(self, progress: Progress) -> None:
        """Write one line, if it is time for one."""
        pace = self._pace.after(progress)
        is_due = progress.seconds - self._last_seconds >= _SECONDS_BETWEEN_LINES
        if is_due or progress.stage not in self._stages:
            self._stages.add(progress.stage)
            self._last_seconds = progress.seconds
            with self._lock:
                if self._closed:
                    return
                try:
                    print(progress_text(progress, *pace), file=self._stream, flush=True)
                except OSError:
                    self._closed = True

    def close(self) -> None:
        """Write no more; a line that is being written is finished first."""
        with self._lock:
            self._closed = True


class _Pace:
    """Photons per second, and time left, since the first report that counted any photons.

    What comes before, mostly compiling, happens once, and would spoil the estimate.
    """

    def __init__(self) -> None:
        self._first: Progress | None = None
        self._pass_began: Progress | None = None

    def after(self, progress: Progress) -> tuple[float | None, float | None]:
        """The rate [1/s] and the time left [s] as of this report; None while not known."""
        if self._first is None or self._pass_began is None:
            if progress.photons_done > 0:
                self._first = self._pass_began = progress
            return None, None
        if progress.pass_index > self._pass_began.pass_index:
            self._pass_began = progress
        seconds = progress.seconds - self._first.seconds
        photons = progress.photons_done - self._first.photons_done
        if seconds <= 0.0 or photons <= 0:
            return None, None
        return photons / seconds, self._seconds_left(progress, photons / seconds)

    def _seconds_left(self, progress: Progress, rate: float) -> float | None:
        """By the mean length of the passes so far; in the first pass by the photons to come."""
        if progress.is_open:
            return None
        assert self._first is not None and self._pass_began is not None
        finished = self._pass_began.pass_index - self._first.pass_index
        if finished > 0:
            pass_seconds = (self._pass_began.seconds - self._first.seconds) / finished
            in_this_pass = progress.seconds - self._pass_began.seconds
            to_come = progress.passes - progress.pass_index
            return max(pass_seconds * to_come - in_this_pass, 0.0)
        left = progress.photons_total - progress.photons_done
        return left / rate if left > 0 else None  # A single pass gathers for who knows how long.


def progress_text(
    progress: Progress, photons_per_second: float | None, seconds_left: float | None
) -> str:
    """One report in words: ``pass 3/8, trace: 1.5M of 4M photons, 2.1M/s, 1 s left``."""
    number, photons = f"{progress.pass_index + 1}", _rounded(progress.photons_done)
    if not progress.is_open:
        number += f"/{progress.passes}"
        photons += f" of {_rounded(progress.photons_total)}"
    text = f"pass {number}, {progress.stage}: {photons} photons"
    if photons_per_second is not None:
        text += f", {_rounded(photons_per_second)}/s"
    if seconds_left is not None:
        text += f", {_duration(seconds_left)} left"
    if progress.error is not None:
        text += f", error {progress.error:.2%}"
    return text


def _rounded(count: float) -> str:
    """A count in three digits: 950, 1.5k, 2.05M, 12G."""
    for size, suffix in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if count >= size:
            return f"{count / size:.3g}{suffix}"
    return f"{count:.3g}"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(math.ceil(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
