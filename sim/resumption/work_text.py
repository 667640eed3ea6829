"""How much work a checkpoint holds, in words."""

from __future__ import annotations

from sim.errors import FileFormatError
from sim.resumption.state_file import StoredState

__all__ = ["passes_text", "work_text"]


def work_text(stored: StoredState) -> str:
    """How much work a file holds, in words.

    Raises:
        FileFormatError: it does not say.
    """
    passes, seconds = stored.numbers.get("passes"), stored.numbers.get("seconds")
    if type(passes) is not int or passes < 0 or not isinstance(seconds, int | float):
        raise FileFormatError("", "its header makes no sense")
    return f"{passes_text(passes)}, {_duration(float(seconds))} of work"


def passes_text(count: int) -> str:
    """``1 pass``, ``2 passes``."""
    return f"{count} pass{'' if count == 1 else 'es'}"


def _duration(seconds: float) -> str:
    """Rounded: 12 s, 3 min, 2.5 h."""
    if not seconds >= 0.0:
        raise FileFormatError("", "its header makes no sense")
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
