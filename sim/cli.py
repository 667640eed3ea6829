"""The command ``nephroid``: reads its arguments, runs one command, turns errors into one line.

Exit status: 0 when it worked, 2 for bad input or an output that cannot be written, 1 for a run
that failed after it had done work and for a check that failed, 130 after Ctrl-C or SIGTERM. Each
command is a module of `sim.commands`, and those load nothing heavy before their arguments are
known to be good: the help appears at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from sim.commands import explain, glass, info, render, scenes, schema, spectrum, study, trace
from sim.errors import UnfinishedError
from sim.native_output import end_silence
from sim.standard_streams import discard, tell
from sim.version import VERSION

__all__ = ["main", "parse_arguments", "run_from_shell"]

_COMMANDS = {
    "render": render,
    "trace": trace,
    "explain": explain,
    "scenes": scenes,
    "glass": glass,
    "spectrum": spectrum,
    "info": info,
    "schema": schema,
    "study": study,
}

_SUCCESS = 0
_FAILED = 1
_BAD_INPUT = 2
_STOPPED = 130  # 128 + SIGINT, as shells have it.


class _Parser(argparse.ArgumentParser):
    """Reports a bad argument the way all other errors are reported: in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(_BAD_INPUT, f"nephroid: error: {message}; see '{self.prog} --help'\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        arguments: What follows ``nephroid`` on the command line; None: this process's own.

    Returns:
        The exit status.
    """
    try:
        status = _run(arguments)
        sys.stdout.flush()
    except KeyboardInterrupt as stop:
        end_silence()
        kept = f" after {stop}" if str(stop) else ""
        tell(f"nephroid: stopped{kept}")
        return _STOPPED
    except BrokenPipeError:  # Whoever read the output (`head`) has seen enough.
        return _SUCCESS
    except Exception as error:
        message = _message(error)
        if message is None:
            raise
        tell(f"nephroid: error: {message}")
        return _FAILED if isinstance(error, UnfinishedError) else _BAD_INPUT
    return status


def _run(arguments: Sequence[str] | None) -> int:
    """Run one command; the exit status, unless something is raised."""
    try:
        parsed = parse_arguments(arguments)
        parsed.run(parsed)
    except SystemExit as leaving:  # From argparse: --help, --version or a bad argument.
        return leaving.code if isinstance(leaving.code, int) else _SUCCESS
    return _SUCCESS


def run_from_shell() -> NoReturn:
    """Entry point of the installed command: `main`, then out."""
    status = main()
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:  # It has been told, if it can be.
            discard(stream)
    if status == _STOPPED:
        # Worker threads are still in native code that cannot be interrupted, and a normal exit
        # would wait for them. Nothing is lost: no file is open.
        os._exit(status)
    sys.exit(status)


def parse_arguments(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Parse a command line; the result's ``run`` is the command, which takes the result.

    Args:
        arguments: What follows ``nephroid``; None: this process's own.

    Returns:
        The command's name as ``command``, its arguments, ``run``, and all as it was, ``words``.

    Raises:
        SystemExit: For a bad argument, after one line on stderr, and after ``--help``.
    """
    parser = _Parser(
        prog="nephroid",
        description="Photons through glass: spectral pictures of prisms, lenses and their light.",
    )
    parser.add_argument("--version", action="version", version=f"nephroid {VERSION}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, dest="command")
    for name, command in _COMMANDS.items():
        subparser = commands.add_parser(
            name, help=command.SUMMARY, description=command.__doc__, formatter_class=_HelpFormatter
        )
        command.add_arguments(subparser)
        subparser.set_defaults(run=command.run)
    words = tuple(sys.argv[1:] if arguments is None else arguments)
    return parser.parse_args(words, argparse.Namespace(words=words))


class _HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Keeps the line breaks of the commands' docstrings."""


def _message(error: Exception) -> str | None:
    """What to tell about bad input or a lack of room; None for a bug, which shows its trace."""
    from scenes import SceneError
    from sim.errors import NephroidError
    from spectra.errors import SpectraError

    if isinstance(error, NephroidError | SceneError | SpectraError):
        return str(error)
    if isinstance(error, MemoryError):
        return f"not enough memory: {error}" if str(error) else "not enough memory"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{os.fsdecode(error.filename)}: {error.strerror}"
    if isinstance(error, OSError):  # Of a stream; a bug's has no words of the system.
        return error.strerror
    return None


if __name__ == "__main__":
    run_from_shell()
