"""Ctrl-C that works while native code runs."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

__all__ = ["run_interruptibly"]

_Result = TypeVar("_Result")


def run_interruptibly(work: Callable[[], _Result]) -> _Result:
    """Run `work` in a thread of its own, so that Ctrl-C need not wait for it.

    Python delivers KeyboardInterrupt to the main thread between two of its own instructions; a
    compiler or a kernel that runs for seconds in that thread would hold it up as long. Here the
    main thread only waits. After Ctrl-C the thread is left behind, so `work` must not write
    files, and the process should then leave by `os._exit`.

    Args:
        work: What to do.

    Returns:
        What it returned.

    Raises:
        KeyboardInterrupt: On Ctrl-C, at once.
        BaseException: Whatever `work` raised.
    """
    worker = _Worker(work)
    thread = threading.Thread(target=worker.run, name="interruptible", daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(0.1)  # With a timeout, since on Windows a wait without one ignores Ctrl-C.
    if worker.error is not None:
        raise worker.error
    return worker.results[0]


class _Worker(Generic[_Result]):
    """Runs work and keeps what came of it."""

    def __init__(self, work: Callable[[], _Result]) -> None:
        self._work = work
        self.results: list[_Result] = []
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            self.results.append(self._work())
        except BaseException as error:
            self.error = error
