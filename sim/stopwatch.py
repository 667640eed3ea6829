"""What a rendering is doing, how long each stage takes, and who is told."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from sim.progress import Progress, ProgressCallback
from sim.settings import ResolvedSettings

__all__ = ["Stopwatch"]


class Stopwatch:
    """Adds up the seconds of each stage, which may overlap, and passes progress on."""

    def __init__(self, settings: ResolvedSettings, tell: ProgressCallback | None) -> None:
        self.start = time.perf_counter()
        self.timings: dict[str, float] = {}
        self.settings = settings
        self.tell = tell
        self.photons_done = 0
        self.pass_index = 0
        self.stage = ""
        self.error: float | None = None
        self.lock = threading.Lock()

    @property
    def seconds(self) -> float:
        """Time since the rendering began [s]."""
        return time.perf_counter() - self.start

    def go_on(self, passes: int, seconds: float) -> None:
        """Count on from an earlier run, which has made so many passes in so many seconds."""
        self.start -= seconds
        self.pass_index = passes
        self.photons_done = passes * self.settings.photons

    @contextmanager
    def timing(self, stage: str) -> Iterator[None]:
        """Time a stage, under its name."""
        with self.lock:
            self.stage = stage
        self.report()
        start = time.perf_counter()
        try:
            yield
        finally:
            spent = time.perf_counter() - start
            with self.lock:
                self.timings[stage] = self.timings.get(stage, 0.0) + spent

    def count_photons(self, photons: int) -> None:
        """More photons are done."""
        self.photons_done += photons
        self.report()

    def report(self, _done: int = 0) -> None:
        """Tell the callback how far the run is, one thread at a time."""
        if self.tell is None:
            return
        with self.lock:
            self.tell(
                Progress(
                    stage=self.stage,
                    pass_index=self.pass_index,
                    passes=self.settings.passes,
                    photons_done=self.photons_done,
                    photons_total=self.settings.photons * self.settings.passes,
                    seconds=self.seconds,
                    error=self.error,
                    is_open=self.settings.is_open,
                )
            )
