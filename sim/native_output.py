"""Silence for native libraries that print instead of reporting."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from collections.abc import Iterator

__all__ = ["end_silence", "silenced_native_output"]

# What is silenced now: descriptors, each with a copy of what it was.
_silenced: list[tuple[int, int]] = []


@contextlib.contextmanager
def silenced_native_output() -> Iterator[None]:
    """Discard what native code prints while the block runs.

    Some of it goes to the process's file descriptors 1 and 2 directly, some through `sys.stdout`
    and `sys.stderr`. Both are redirected for the whole process, so keep the block short: other
    threads are silenced with it.
    """
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError):  # What leads to a full disk is told of elsewhere.
            stream.flush()
    before = len(_silenced)
    discard = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in (1, 2):
            with contextlib.suppress(OSError):  # A closed one prints nothing anyway.
                _silenced.append((descriptor, os.dup(descriptor)))
                os.dup2(discard, descriptor)
        nowhere = io.StringIO()
        with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
            yield
    finally:
        while len(_silenced) > before:
            descriptor, original = _silenced.pop()
            os.dup2(original, descriptor)
            os.close(original)
        os.close(discard)


def end_silence() -> None:
    """Let this process speak again, although another thread is in a silenced block.

    For last words after Ctrl-C: that thread may never come to the end of its block.
    """
    if _silenced:
        for descriptor, original in reversed(_silenced):
            os.dup2(original, descriptor)
        sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__
