"""Silence for native libraries that print instead of reporting."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from collections.abc import Iterator

__all__ = ["silenced_native_output"]


@contextlib.contextmanager
def silenced_native_output() -> Iterator[None]:
    """Discard what native code prints while the block runs.

    Some of it goes to the process's file descriptors 1 and 2 directly, some through `sys.stdout`
    and `sys.stderr`. Both are redirected for the whole process, so keep the block short: other
    threads are silenced with it.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    saved: list[tuple[int, int]] = []
    discard = os.open(os.devnull, os.O_WRONLY)
    try:
        for descriptor in (1, 2):
            with contextlib.suppress(OSError):  # A closed one prints nothing anyway.
                saved.append((descriptor, os.dup(descriptor)))
                os.dup2(discard, descriptor)
        nowhere = io.StringIO()
        with contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
            yield
    finally:
        for descriptor, original in saved:
            os.dup2(original, descriptor)
            os.close(original)
        os.close(discard)
