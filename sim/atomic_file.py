"""Files that appear whole or not at all.

The bytes go to a temporary file in the same folder, reach the disk (fsync, which is where a full
disk that took everything so far says so), and only then take the file's name in one step.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import BinaryIO

from sim.errors import OutputError

__all__ = ["check_writable", "replacing", "write_whole"]


def check_writable(path: str | os.PathLike[str]) -> None:
    """Find out before long work whether `write_whole` can write there.

    Args:
        path: The file that is to be written.

    Raises:
        OutputError: The folder is missing, is no folder or cannot be written to, or the path is
            a folder or a write-protected file.
    """
    with _told_as_output_error(path):
        if _is_stream(path):
            return
        _refuse_unusable_target(path)
        temporary = _temporary_name(path)
        os.close(_create(temporary))
        temporary.unlink()


def write_whole(path: str | os.PathLike[str], data: bytes | memoryview) -> None:
    """Write a file in one step: afterwards it holds all of `data`, or what it held before.

    A path that names a device or a pipe is written to directly.

    Args:
        path: The file; an existing one is replaced.
        data: Its new content.

    Raises:
        OutputError: It cannot be written; nothing has changed.
    """
    with _told_as_output_error(path):
        if _is_stream(path):
            Path(path).write_bytes(data)
            return
    with replacing(path) as file:
        file.write(data)


@contextlib.contextmanager
def replacing(
    path: str | os.PathLike[str],
    *,
    temporary: Path | None = None,
    gate: AbstractContextManager[object] | None = None,
) -> Iterator[BinaryIO]:
    """Write a file piece by piece that takes its name in one step, when all is on the disk.

    Args:
        path: The file; an existing one is replaced, if the block ends well.
        temporary: What it is called meanwhile, in the same folder; None: a new hidden name.
        gate: Entered while the temporary file is created, and while it takes its name; it may
            raise what ends both. It is entered more than once.

    Yields:
        The temporary file, to write to.

    Raises:
        OutputError: It cannot be written; nothing has changed.
    """
    gate = contextlib.nullcontext() if gate is None else gate
    with _told_as_output_error(path):
        _refuse_unusable_target(path)
        temporary = _temporary_name(path) if temporary is None else temporary
        try:
            with gate:
                descriptor = _create(temporary)
            with open(descriptor, "wb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            with gate:
                os.replace(temporary, os.path.realpath(path))
        except BaseException:  # Ctrl-C too leaves nothing behind.
            with contextlib.suppress(OSError):  # The folder may have gone.
                temporary.unlink(missing_ok=True)
            raise


@contextlib.contextmanager
def _told_as_output_error(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn the system's errors into one that names the file that was asked for."""
    try:
        yield
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(path, error.strerror or str(error)) from error
    except ValueError as error:  # A null character in the path.
        raise OutputError(path, str(error)) from error


def _is_stream(path: str | os.PathLike[str]) -> bool:
    """Whether `path` exists and is neither a file nor a folder: replacing it would destroy it."""
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _refuse_unusable_target(path: str | os.PathLike[str]) -> None:
    """Raise OutputError for what renaming onto `path` would only notice at the end, or never."""
    folder = Path(os.path.realpath(path)).parent
    if os.path.isdir(path) or not os.path.basename(path):
        raise OutputError(path, "it is a folder; name a file in it")
    if not folder.exists():
        raise OutputError(path, f"there is no folder {str(folder)!r}; create it first")
    if not folder.is_dir():
        raise OutputError(path, f"{str(folder)!r} is not a folder")
    if os.path.exists(path) and not os.access(path, os.W_OK):
        raise OutputError(path, "the file is write-protected")


def _temporary_name(path: str | os.PathLike[str]) -> Path:
    """A new hidden name beside the file that `path` leads to: only there is renaming one step."""
    return Path(os.path.realpath(path)).parent / f".nephroid-{secrets.token_hex(8)}.tmp"


def _create(path: Path) -> int:
    """Create a file that must not exist yet, with the permissions of any new file."""
    return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
