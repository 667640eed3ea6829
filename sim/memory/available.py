"""The memory that this process has, and may still get: of the machine, and of its control groups.

References:
    proc(5), /proc/meminfo: MemAvailable. Linux kernel, Documentation/admin-guide/cgroup-v2.rst,
    memory.max and memory.current; cgroup-v1/memory.rst, memory.limit_in_bytes. File pages that a
    group has cached count as used, though they are given back on demand (inactive_file).
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path

__all__ = ["available_memory", "resident_memory"]

_ROOT = Path("/")

_VERSIONS = (("memory.max", "memory.current"),
             ("memory.limit_in_bytes", "memory.usage_in_bytes"))  # fmt: skip


def resident_memory() -> int:
    """What this process takes now [bytes]; 0 where that cannot be found out."""
    with contextlib.suppress(OSError, ValueError, IndexError):
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")
    return 0


def available_memory(root: Path = _ROOT) -> int | None:
    """What this process may still take [bytes]; None where that cannot be found out.

    Args:
        root: Of the file system that tells, for tests.
    """
    found = [*_of_machine(root), *_of_groups(root)]
    return max(0, min(found)) if found else None


def _of_machine(root: Path) -> Iterator[int]:
    with contextlib.suppress(OSError, ValueError, IndexError):
        for line in (root / "proc/meminfo").read_text("ascii").splitlines():
            if line.startswith("MemAvailable:"):
                yield int(line.split()[1]) * 1024


def _of_groups(root: Path) -> Iterator[int]:
    """What every group that this process is in has left; one without a limit has no end."""
    for group in _groups(root):
        for limit_name, usage_name in _VERSIONS:
            with contextlib.suppress(OSError, ValueError):
                limit = int((group / limit_name).read_text("ascii"))  # "max" is no number
                used = int((group / usage_name).read_text("ascii"))
                yield limit - used + _reclaimable(group)


def _groups(root: Path) -> Iterator[Path]:
    """Folders of the groups that may limit this process, and of those that hold them."""
    with contextlib.suppress(OSError):
        for line in (root / "proc/self/cgroup").read_text("utf-8").splitlines():
            _, controllers, path = line.split(":", 2)
            if controllers not in ("", "memory"):
                continue
            top = root / "sys/fs/cgroup" / controllers
            inner = Path(path.lstrip("/"))
            # In a container the path may be that of the host, and only the top is to be seen.
            for one in (inner, *inner.parents):
                yield top / one


def _reclaimable(group: Path) -> int:
    with contextlib.suppress(OSError, ValueError):
        for line in (group / "memory.stat").read_text("ascii").splitlines():
            name, _, value = line.partition(" ")
            if name in ("inactive_file", "total_inactive_file"):
                return int(value)
    return 0
