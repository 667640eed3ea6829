"""The process's own streams, which may lead to a full disk or to a pipe that nobody reads."""

from __future__ import annotations

import contextlib
import os
import sys
from typing import TextIO

__all__ = ["discard", "tell"]


def tell(line: str) -> None:
    """Write a line to stderr, if that takes it: no run ends because nobody can be told of it."""
    with contextlib.suppress(OSError):
        print(line, file=sys.stderr, flush=True)


def discard(stream: TextIO) -> None:
    """Lead a stream that takes no more to nowhere.

    What waits in its buffer would fail again, and change the exit status, when Python ends.
    """
    with contextlib.suppress(OSError, ValueError):  # Closed, or of no descriptor.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
