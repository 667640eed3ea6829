"""What can go wrong in a simulation, and how it is told.

::

    NephroidError(Exception)
    ├── SettingsError   (also ValueError)    a render setting outside what is allowed
    ├── OutputError     (also OSError)       a file that cannot be written
    ├── FileFormatError (also ValueError)    a file that is not what it should be
    ├── CheckpointError (also ValueError)    a checkpoint that is not this run's
    ├── UnfinishedError (also RuntimeError)  a run that failed after it had done work
    ├── CapacityError   (also RuntimeError)  more data than the run can hold
    └── DeviceError     (also RuntimeError)  a compute device that is not there or fails

Descriptions of scenes and spectra raise their own: `scenes.SceneError`, `spectra.SpectraError`.
"""

from __future__ import annotations

import os

__all__ = [
    "CapacityError",
    "CheckpointError",
    "DeviceError",
    "FileFormatError",
    "NephroidError",
    "OutputError",
    "SettingsError",
    "UnfinishedError",
]

LISTED_DIFFERENCES = 8
"""A message names so many; the error has them all."""


class NephroidError(Exception):
    """Base of every error that the simulator raises on purpose."""


class SettingsError(NephroidError, ValueError):
    """A render setting has a value that is not allowed.

    Attributes:
        field: Name of the setting.
        value: What was given.
        allowed: What is allowed, in words.
    """

    def __init__(self, field: str, value: object, allowed: str) -> None:
        super().__init__(field, value, allowed)
        self.field = field
        self.value = value
        self.allowed = allowed

    def __str__(self) -> str:
        return f"{self.field}: {self.value!r} is not allowed; allowed: {self.allowed}"


class OutputError(NephroidError, OSError):
    """A file cannot be written.

    Attributes:
        path: The file that was to be written.
        reason: Why it cannot be, in words.
    """

    def __init__(self, path: str | os.PathLike[str], reason: str) -> None:
        # One argument: OSError would read two as (errno, strerror).
        super().__init__(f"cannot write {os.fspath(path)!r}: {reason}")
        self.path = os.fspath(path)
        self.reason = reason

    def __reduce__(self) -> tuple[type[OutputError], tuple[str, str]]:
        return type(self), (self.path, self.reason)


class FileFormatError(NephroidError, ValueError):
    """A file is not in the format that it should be in.

    Attributes:
        path: The file that was read.
        reason: What is wrong with it, in words.
    """

    def __init__(self, path: str | os.PathLike[str], reason: str) -> None:
        super().__init__(os.fspath(path), reason)
        self.path = os.fspath(path)
        self.reason = reason

    def __str__(self) -> str:
        return f"cannot read {self.path!r}: {self.reason}"


class CheckpointError(NephroidError, ValueError):
    """A checkpoint cannot be gone on with, or must not be thrown away.

    Attributes:
        path: The checkpoint.
        reason: Why, in words.
        differences: Of each field that differs: its path, what the checkpoint has, what is asked.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        reason: str,
        differences: tuple[tuple[str, str, str], ...] = (),
    ) -> None:
        super().__init__(os.fspath(path), reason, differences)
        self.path = os.fspath(path)
        self.reason = reason
        self.differences = differences

    def __str__(self) -> str:
        lines = [
            f"\n  {field}: {stored} in the checkpoint, {asked} asked"
            for field, stored, asked in self.differences[:LISTED_DIFFERENCES]
        ]
        if len(self.differences) > LISTED_DIFFERENCES:
            lines.append(f"\n  and {len(self.differences) - LISTED_DIFFERENCES} more")
        return f"checkpoint {self.path!r}: {self.reason}{''.join(lines)}"


class UnfinishedError(NephroidError, RuntimeError):
    """A run failed after it had done work; the message says what is kept, and how to go on."""


class CapacityError(NephroidError, RuntimeError):
    """A run needs more room than it has; the message says what to raise or to lower."""


class DeviceError(NephroidError, RuntimeError):
    """A compute device is not there, or it failed; the message names it."""
