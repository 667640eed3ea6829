"""List the gallery: scenes that `render` and `trace` know by name."""

from __future__ import annotations

import argparse

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "list the gallery"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments: none."""


def run(arguments: argparse.Namespace) -> None:
    """Print each gallery scene's name and title."""
    from scenes import gallery, load

    names = gallery()
    width = max(map(len, names))
    for name in names:
        print(f"{name:<{width}}  {load(name).title}")
