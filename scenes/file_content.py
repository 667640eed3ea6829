"""Files, read whole: only what is really a file, and no more of it than can be right."""

import errno
import os
import stat
from pathlib import Path

__all__ = ["file_content", "require_file"]


def file_content(path: Path, most_bytes: int) -> bytes:
    """All bytes of a file.

    Args:
        path: of the file.
        most_bytes: how long it may be.

    Raises:
        OSError: there is none, it is no file, it cannot be read, or it is longer; `strerror` says
            what.
        ValueError: no path can look like this.
    """
    require_file(path)
    with path.open("rb") as file:
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:
        reason = f"it is too large; allowed: at most {most_bytes // 1024**2} MB"
        raise OSError(errno.EFBIG, reason, os.fspath(path))
    return content


def require_file(path: Path) -> None:
    """Refuse what only looks like a file: reading a pipe waits, a device may never end.

    Raises:
        OSError: there is nothing, or something else; `strerror` says what.
        ValueError: no path can look like this.
    """
    mode = path.stat().st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if not stat.S_ISREG(mode):
        reason = "it is a pipe, a device or a socket; allowed: a file"
        raise OSError(errno.EINVAL, reason, os.fspath(path))
