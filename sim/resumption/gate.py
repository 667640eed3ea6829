"""A gate between a run and the file system, which may be closed from another thread."""

from __future__ import annotations

import contextlib
import threading

__all__ = ["Gate"]


class Gate(contextlib.AbstractContextManager[None]):
    """Held while a file is created or renamed; once it is closed, nobody passes."""

    def __init__(self) -> None:
        self.is_open = False
        self._lock = threading.Lock()

    def close(self) -> None:
        """Wait for who is passing, and let nobody follow."""
        with self._lock:
            self.is_open = False

    def __enter__(self) -> None:
        self._lock.acquire()
        if not self.is_open:
            self._lock.release()
            raise KeyboardInterrupt

    def __exit__(self, *error: object) -> None:
        self._lock.release()
