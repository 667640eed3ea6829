"""What can go wrong in a simulation, and how it is told.

::

    NephroidError(Exception)
    ├── SettingsError   (also ValueError)    a render setting outside what is allowed
    ├── OutputError     (also OSError)       a file that cannot be written
    ├── FileFormatError (also ValueError)    a file that is not what it should be
    ├── CapacityError   (also RuntimeError)  more data than the run can hold
    └── DeviceError     (also RuntimeError)  a compute device that is not there or fails

Descriptions of scenes and spectra raise their own: `scenes.SceneError`, `spectra.SpectraError`.
"""

from __future__ import annotations

import os

__all__ = [
    "CapacityError",
    "DeviceError",
    "FileFormatError",
    "NephroidError",
    "OutputError",
    "SettingsError",
]


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


class CapacityError(NephroidError, RuntimeError):
    """A run needs more room than it has; the message says what to raise or to lower."""


class DeviceError(NephroidError, RuntimeError):
    """A compute device is not there, or it failed; the message names it."""
