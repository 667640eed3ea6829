"""Print the JSON Schema of scene files, with which editors complete and check them."""

from __future__ import annotations

import argparse
import json

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "print the JSON Schema of scene files"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments: none."""


def run(arguments: argparse.Namespace) -> None:
    """Print the schema."""
    from scenes import schema

    print(json.dumps(schema(), indent=2, ensure_ascii=False))
