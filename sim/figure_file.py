"""Matplotlib figures as files that appear whole or not at all."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

from sim.atomic_file import write_whole
from sim.version import VERSION

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["save_figure"]


def save_figure(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure in the format that the file's ending names.

    Args:
        figure: What to write.
        path: The file, ending in ``.png`` or ``.svg``; an existing one is replaced.

    Raises:
        OutputError: The file cannot be written.
    """
    from matplotlib import rc_context

    kind = Path(path).suffix.lower().removeprefix(".")
    # Equal figures give equal files: no date, and names in the SVG that do not change.
    metadata = {"Date": None, "Creator": f"Nephroid {VERSION}"} if kind == "svg" else {}
    buffer = io.BytesIO()
    with rc_context({"svg.hashsalt": "nephroid"}):
        figure.savefig(buffer, format=kind, metadata=metadata, facecolor=figure.get_facecolor())
    write_whole(path, buffer.getbuffer())
