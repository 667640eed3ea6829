"""What all the parts of one scene file together may take: of memory, and of time to load.

Each part has bounds of its own; ten thousand parts at their bounds would still not fit. So they
draw on one budget while the file is read, before they do the work.
"""

from collections import Counter
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from pydantic import ValidationInfo

from scenes.errors import Problem, refusal

__all__ = ["LIMITS", "Budget", "charge"]

BUDGET_KEY: Final = "budget"

LIMITS: Final[Mapping[str, int]] = MappingProxyType(
    {
        "triangles": 1 << 21,
        "pairs of a polyhedron's corners": 1 << 24,
        "mask cells": 1 << 23,
        "samples of waves": 1 << 25,
        "bytes of other files": 1 << 27,
    }
)
"""What a scene file may use in all: up to some seconds, and some hundred megabytes, of each."""


class Budget:
    """What one file has used so far."""

    def __init__(self) -> None:
        self.used: Counter[str] = Counter()


def charge(info: ValidationInfo, what: str, amount: int, field: str) -> None:
    """Draw on the budget of the file that is being read; models built in Python have none.

    Args:
        info: of the validation, which knows the budget.
        what: a key of `LIMITS`.
        amount: of it.
        field: path of the field that asks for it.

    Raises:
        PydanticCustomError: there is not so much left.
    """
    budget = info.context.get(BUDGET_KEY) if isinstance(info.context, Mapping) else None
    if budget is None:
        return
    used, limit = budget.used[what], LIMITS[what]
    if used + amount > limit:
        allowed = f"at most {limit} {what} in all of the scene"
        before = f", beside {used} of what comes before" if used else ""
        raise refusal(Problem(field, f"takes {amount} {what}{before}; {allowed}", amount, allowed))
    budget.used[what] += amount
