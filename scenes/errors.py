"""What can be wrong with a scene, and the one exception that says so.

    Exception
    └── ValueError
        └── SceneError      carries every Problem of a scene at once

No other exception leaves this package because of what a scene file, or a call, contains.
"""

import difflib
import reprlib
from collections.abc import Iterable
from dataclasses import dataclass, field

from pydantic_core import PydanticCustomError

__all__ = ["Problem", "SceneError", "nearest_names", "reason_of", "refusal", "shown"]

PROBLEM_ERROR_TYPE = "scene_problem"
"""Type of the pydantic errors that carry our own `Problem`s in their context."""

_MOST_LINES = 100
_LONGEST_NAME = 100
_LONGEST_REASON = 300

_short_repr = reprlib.Repr()
_short_repr.maxstring = _short_repr.maxother = _short_repr.maxlong = 80


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a scene.

    Attributes:
        path: The field, as written in the file ("objects[1].material.medium"); "" is the whole.
        message: A full sentence part: what is wrong, with the value and what is allowed.
        value: The value as given, in the file's own unit; None where a key is missing.
        allowed: What would have been accepted, in words; "" where nothing can be listed.
    """

    path: str
    message: str
    value: object = field(default=None, compare=False)
    allowed: str = ""

    def __str__(self) -> str:
        """The line that the error prints."""
        return f"{self.path}: {self.message}" if self.path else self.message

    def below(self, parent: str) -> "Problem":
        """The same problem, seen from the table that holds `parent`."""
        joint = "" if not parent or not self.path or self.path.startswith("[") else "."
        return Problem(f"{parent}{joint}{self.path}", self.message, self.value, self.allowed)


class SceneError(ValueError):
    """A scene that cannot be used; `str()` has one line for each of the first 100 problems.

    Attributes:
        source: What was being read: a file's path, a gallery name, or a model's name.
        problems: Every problem found, in the order of the file format.
    """

    def __init__(self, source: str, problems: Iterable[Problem]) -> None:
        self.source = source
        self.problems = tuple(problems)
        super().__init__(source, self.problems)

    def __str__(self) -> str:
        """A header that names the source, and the problems, each on a line of its own."""
        count = len(self.problems)
        source = self.source if self.source.isprintable() else shown(self.source)
        header = f"{source}: {count} problem{'' if count == 1 else 's'}"
        lines = [f"  {problem}" for problem in self.problems[:_MOST_LINES]]
        rest = [f"  … and {count - _MOST_LINES} more"] if count > _MOST_LINES else []
        return "\n".join([header, *lines, *rest])


def refusal(*problems: Problem) -> PydanticCustomError:
    """The error a pydantic validator raises to report our own problems.

    Args:
        problems: What is wrong; their paths are relative to what the validator was given.
    """
    text = "; ".join(str(problem) for problem in problems)
    return PydanticCustomError(PROBLEM_ERROR_TYPE, "{text}", {"text": text, "problems": problems})


def nearest_names(name: str, allowed: Iterable[str], *, count: int = 3) -> list[str]:
    """The allowed names most like `name`, letter case aside, best first (may be empty)."""
    if len(name) > _LONGEST_NAME:
        return []
    by_folded: dict[str, str] = {candidate.casefold(): candidate for candidate in allowed}
    matches = difflib.get_close_matches(name.casefold(), by_folded, n=count, cutoff=0.5)
    return [by_folded[match] for match in matches]


def shown(value: object) -> str:
    """A value for a message: its repr, shortened, on one line, whatever the value is."""
    try:
        return _short_repr.repr(value)
    except ValueError:  # an integer of more digits than Python agrees to print
        return "a huge number"


def reason_of(error: Exception) -> str:
    """Why a file cannot be used, for a message: on one line, and not the file's whole content."""
    told = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    text = " ".join(told.split()) or type(error).__name__
    printable = "".join(one if one.isprintable() else "\N{REPLACEMENT CHARACTER}" for one in text)
    return printable if len(printable) <= _LONGEST_REASON else f"{printable[:_LONGEST_REASON]}…"
