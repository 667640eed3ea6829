"""What a command keeps of a long run that is cut short, and what it says about that."""

from __future__ import annotations

import contextlib
import shlex
import signal
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sim.standard_streams import tell

if TYPE_CHECKING:
    from sim.resumption.checkpoint import Checkpoint

__all__ = ["checkpoint_path", "kept_work"]


def checkpoint_path(output: Path) -> Path:
    """Where the checkpoint of a run lies: beside what it is going to write."""
    return output.with_name(f"{output.name}.checkpoint")


@contextlib.contextmanager
def kept_work(
    output: Path, words: Sequence[str], *, resume: bool | None
) -> Iterator[Checkpoint]:
    """Hold the lock and the checkpoint of a run; tell how to go on when it is cut short.

    Args:
        output: the run's main file.
        words: the command line, without the program's name.
        resume: as `Checkpoint` has it.

    Yields:
        The checkpoint. It is removed if the block ends well.

    Raises:
        OutputError: there cannot be a checkpoint, or another run writes the same file.
        KeyboardInterrupt: on Ctrl-C and on SIGTERM, with what to tell.
        UnfinishedError: files could not be written after all the work, or memory ran out.
        CapacityError: memory ran out before the first pass was made.
    """
    from sim.errors import CapacityError, OutputError, UnfinishedError
    from sim.resumption.checkpoint import LAST_WAIT_S, Checkpoint

    path = checkpoint_path(output)
    checkpoint = Checkpoint(path, resume=resume, target=output, tell=tell)
    with _termination_as_ctrl_c(), checkpoint:
        try:
            yield checkpoint
        except KeyboardInterrupt:
            checkpoint.settle(LAST_WAIT_S)
            if not checkpoint.passes:
                raise
            raise KeyboardInterrupt(_how_to_go_on(checkpoint, words)) from None
        except OutputError as error:
            checkpoint.settle()
            raise UnfinishedError(f"{error}{_kept(checkpoint, words)}") from error
        except (MemoryError, RuntimeError) as error:
            if not _is_lack_of_memory(error):
                raise
            lacking = f"not enough memory: {error}{_kept(checkpoint, words)}"
            raise (UnfinishedError if checkpoint.made else CapacityError)(lacking) from error


def _is_lack_of_memory(error: Exception) -> bool:
    """Warp's failed allocations are plain RuntimeErrors."""
    return isinstance(error, MemoryError) or str(error).startswith("Failed to allocate")


def _kept(checkpoint: Checkpoint, words: Sequence[str]) -> str:
    return f"; kept {_how_to_go_on(checkpoint, words)}" if checkpoint.passes else ""


def _how_to_go_on(checkpoint: Checkpoint, words: Sequence[str]) -> str:
    """What is kept, and the command that goes on from it."""
    from sim.resumption.work_text import passes_text

    again = [word for word in words if word not in ("--resume", "--no-resume")]
    command = shlex.join(["nephroid", *again, "--resume"])
    return f"{passes_text(checkpoint.passes)}; to go on:\n  {command}"


@contextlib.contextmanager
def _termination_as_ctrl_c() -> Iterator[None]:
    """While the block runs, SIGTERM does what Ctrl-C does."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
