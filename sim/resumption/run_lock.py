"""One run at a time: a lock file that tells who holds it.

The lock is the operating system's (flock), which lets go of it when its process ends, however it
ends: the file that a killed run leaves behind locks nothing. Where there are no such locks, on
some network drives and on Windows, runs are not kept apart.
"""

from __future__ import annotations

import contextlib
import errno
import os
import socket
from pathlib import Path

from sim.errors import OutputError

__all__ = ["RunLock"]

_NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP)
_IS_HELD = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)
_LONGEST_NOTE = 300


class RunLock:
    """The right to be the only run that writes certain files.

    Args:
        path: The lock file.
        target: What it is about, for the message.
    """

    def __init__(self, path: Path, target: str | os.PathLike[str]) -> None:
        self.path = path
        self._target = target
        self._descriptor: int | None = None

    def acquire(self) -> None:
        """Take the lock.

        Raises:
            OutputError: another process has it, or there cannot be a file.
        """
        while self._descriptor is None:
            try:
                descriptor = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o666)
            except OSError as error:
                raise self._failure(error) from error
            try:
                self._descriptor = self._locked(descriptor)
            finally:
                if self._descriptor is None:
                    os.close(descriptor)
        with contextlib.suppress(OSError):  # A full disk: the lock holds without a note.
            os.ftruncate(self._descriptor, 0)
            os.pwrite(self._descriptor, f"{os.getpid()} {socket.gethostname()}\n".encode(), 0)

    def _locked(self, descriptor: int) -> int | None:
        """The descriptor once it is locked; None if the file has gone meanwhile."""
        try:
            import fcntl
        except ImportError:
            return descriptor
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in _NO_LOCKS:
                return descriptor
            if error.errno not in _IS_HELD:
                raise self._failure(error) from error
            raise OutputError(self._target, self._holder(descriptor)) from error
        # Whoever had it may have removed the file between opening and locking it here.
        try:
            is_there = os.path.samestat(os.stat(self.path), os.fstat(descriptor))
        except FileNotFoundError:
            is_there = False
        return descriptor if is_there else None

    def _failure(self, error: OSError) -> OutputError:
        """What to tell of a lock file that fails."""
        return OutputError(self._target, f"{error.strerror} ({str(self.path)!r})")

    def _holder(self, descriptor: int) -> str:
        """Who holds the lock, in words."""
        note = os.pread(descriptor, _LONGEST_NOTE, 0).decode("utf-8", "replace").split()
        if len(note) == 2 and note[0].isdecimal():
            return f"another run is at it, process {note[0]} on {note[1]}"
        return "another run is at it"

    def release(self) -> None:
        """Let go of it, and remove the file."""
        if self._descriptor is None:
            return
        with contextlib.suppress(OSError):  # The folder may have gone, or be closed to us.
            self.path.unlink(missing_ok=True)
        os.close(self._descriptor)
        self._descriptor = None
