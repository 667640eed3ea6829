"""What a rendering tells about itself while it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

__all__ = ["Progress", "ProgressCallback"]


@dataclass(frozen=True, kw_only=True)
class Progress:
    """One report from a running rendering.

    Attributes:
        stage: What is being done: "compile", "trace", "gather", …
        pass_index: The pass that is running, from 0.
        passes: Passes in all.
        photons_done: Photons finished, over all passes.
        photons_total: Photons to trace, over all passes.
        seconds: Time since the rendering began [s].
        error: Relative error of the luminance so far, `Accuracy.relative_error`; None until two
            replicates are there.
        is_open: Whether the run may end before all passes: its error or its time decides.
    """

    stage: str
    pass_index: int
    passes: int
    photons_done: int
    photons_total: int
    seconds: float
    error: float | None = None
    is_open: bool = False


ProgressCallback: TypeAlias = Callable[[Progress], None]
