"""The checkpoint of a run: a file from which a run that was cut short goes on.

It is written between passes, whole or not at all, and only by the one run that has its lock. When
it is written follows from what it costs: at least every 30 s of work, or after every pass that
takes longer; more often as far as writing takes no more than 2 % of the time.
"""

from __future__ import annotations

import contextlib
import logging
import os
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from sim.atomic_file import check_writable, replacing
from sim.errors import CheckpointError, FileFormatError, OutputError
from sim.resumption.fingerprint import Difference, list_differences
from sim.resumption.gate import Gate
from sim.resumption.run_lock import RunLock
from sim.resumption.run_state import RunState
from sim.resumption.state_file import StoredState, encode_state, read_state
from sim.resumption.work_text import passes_text, work_text

__all__ = ["Checkpoint"]

LONGEST_GAP_S = 30.0
"""Work that may be lost, unless a single pass takes longer."""

COST_SHARE = 0.02
"""Of the time, for writing, where that leaves checkpoints less than `LONGEST_GAP_S` apart."""

WORTH_KEEPING_S = 60.0
"""A checkpoint of as much work is not thrown away unless one asks for that."""

MUCH_BYTES = 1 << 25
"""So much is not waited for: a disk may take seconds, in which the next pass can be made."""

LAST_WAIT_S = 0.5
"""When a run is cut short, for what is on its way to the disk."""

_WRITING_RATE = 8e8
"""Bytes a second that are handed over, before it is known."""

_log = logging.getLogger("nephroid")


class Checkpoint:
    """The state of one run on the disk, and the right to write it.

    ::

        with sim.Checkpoint("out.checkpoint", resume=True) as checkpoint:
            picture = sim.render(scene, settings, checkpoint=checkpoint)
            picture.save_exr("out.exr")

    If the block ends well the file is removed; if it does not, the file stays, and the same
    program, run again, goes on from there to the same picture, bit by bit.

    Args:
        path: The file. Beside it lies ``path.lock`` while the block runs.
        resume: True: go on from what the file holds, if it is there. False: start anew. None:
            start anew too, unless that threw away a minute's work or more.
        target: What two runs must not write at once, for messages; None: the checkpoint.
        tell: Told in a few lines what cannot be seen in the result.

    Attributes:
        passes: How many passes the file holds, of this run.
        made: How many this run has come to, kept or not.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        resume: bool | None = None,
        target: str | os.PathLike[str] | None = None,
        tell: Callable[[str], None] = _log.warning,
    ) -> None:
        self.path = Path(path)
        self.resume = resume
        self.passes = self.made = 0
        self._tell = tell
        self._run_lock = RunLock(self._beside(".lock"), self.path if target is None else target)
        self._gate = Gate()
        self._saved_at = time.perf_counter()
        self._cost_s = 0.0
        self._has_failed = False
        self._fingerprint: dict[str, Any] = {}
        self._goes_on_from: StoredState | None = None
        self._under_way: threading.Thread | None = None

    def __enter__(self) -> Self:
        """Take the lock.

        Raises:
            OutputError: another run has it, or the file cannot be written.
        """
        check_writable(self.path)
        self._run_lock.acquire()
        self._gate.is_open = True
        self._remove_temporaries()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Let go; without an error, remove the file, whose work is done.

        A run that was left behind in another thread writes nothing from here on.
        """
        if kind is not None:
            self.settle(LAST_WAIT_S)
        self._gate.close()
        self._remove_temporaries()
        if kind is None:
            with contextlib.suppress(OSError):
                self.path.unlink(missing_ok=True)
        self._run_lock.release()

    def expect(self, fingerprint: dict[str, Any], passes: int) -> None:
        """Say what run is about to begin; call it before any long work.

        Args:
            fingerprint: of the run.
            passes: how many it will make, at most.

        Raises:
            CheckpointError: the file is of another run, or holds work that would be lost.
            FileFormatError: the file is damaged.
        """
        if not self._gate.is_open:
            raise RuntimeError("a Checkpoint is used in a `with` block")
        self._fingerprint = fingerprint
        stored = None if self.resume is False else self._stored()
        if stored is None:
            if self.resume and not self.path.exists():
                self._tell(f"nephroid: there is no checkpoint {str(self.path)!r}: starting anew")
        elif not self.resume:
            self._refuse_to_forget(stored, passes)
        else:
            self._refuse_other_run(stored, passes)
            self._goes_on_from = stored
            self.passes = self.made = stored.numbers["passes"]

    def begin(self, state: RunState) -> int:
        """Bring a run that has yet to make its first pass to where the file's run was.

        Args:
            state: of the run that was expected.

        Returns:
            The pass to make next; if there is none to make, as many as there shall be.

        Raises:
            FileFormatError: the file is damaged.
        """
        self._saved_at = time.perf_counter()
        self._cost_s = sum(one.nbytes for one in state.arrays().values()) / _WRITING_RATE
        stored, self._goes_on_from = self._goes_on_from, None
        if stored is None:
            return 0
        try:
            state.restore(stored.numbers, stored.arrays)
        except ValueError as error:
            raise FileFormatError(self.path, str(error)) from None
        self.passes = self.made = state.passes
        self._tell(f"nephroid: going on after {work_text(stored)}, from {str(self.path)!r}")
        # The same question as after its last pass; perhaps another target, or less time.
        ended = state.passes > 0 and state.ends()
        return state.watch.settings.passes if ended else state.passes

    def offer(self, state: RunState) -> None:
        """Write the file, if it is time to; call it after each pass.

        A file that cannot be written ends no run: the last one stays, and it is tried again.

        Raises:
            KeyboardInterrupt: the block has been left meanwhile.
        """
        self.made = state.passes
        if self._under_way is not None and self._under_way.is_alive():
            return
        gap = min(LONGEST_GAP_S, self._cost_s / COST_SHARE)
        if time.perf_counter() - self._saved_at < gap:
            return
        start = time.perf_counter()
        try:
            self._write(state)
        except OutputError as error:
            self._tell_of_failure(error)
        self._saved_at = time.perf_counter()
        self._cost_s = self._saved_at - start

    def settle(self, seconds: float | None = None) -> None:
        """Wait for what is on its way to the disk, at most so long."""
        if self._under_way is not None:
            self._under_way.join(seconds)

    def _write(self, state: RunState) -> None:
        """Write the file; the disk is waited for in another thread if there is much to wait for.

        The state itself is free to change once it has been handed over.
        """
        numbers = {"fingerprint": self._fingerprint, **state.numbers()}
        temporary, passes = self._beside(f"-{os.urandom(6).hex()}.tmp"), state.passes
        size, whole = 0, replacing(self.path, temporary=temporary, gate=self._gate)
        with contextlib.ExitStack() as stack:
            file = stack.enter_context(whole)
            for piece in encode_state(numbers, state.arrays()):
                if not self._gate.is_open:
                    raise KeyboardInterrupt
                size += file.write(piece)
            if size >= MUCH_BYTES:
                to_end = stack.pop_all()
                self._under_way = threading.Thread(
                    target=self._end_elsewhere, args=(to_end, passes), daemon=True
                )
                self._under_way.start()
                return
        self._has_written(passes)

    def _end_elsewhere(self, to_end: contextlib.ExitStack, passes: int) -> None:
        """Wait for the disk, in a thread of its own."""
        try:
            to_end.close()
        except OutputError as error:
            self._tell_of_failure(error)
        except KeyboardInterrupt:  # The block has been left: no file takes its name any more.
            return
        else:
            self._has_written(passes)

    def _has_written(self, passes: int) -> None:
        self.passes, self._has_failed = passes, False

    def _tell_of_failure(self, error: OutputError) -> None:
        """Once, until it works again."""
        if not self._has_failed:
            kept = "there is none yet"
            if self.passes:
                kept = f"that of {passes_text(self.passes)} is kept"
            self._tell(f"nephroid: warning: no checkpoint: {error}; {kept}; going on")
        self._has_failed = True

    def _stored(self) -> StoredState | None:
        """What the file holds; None if there is none, or, unless it is asked for, a damaged one."""
        if not self.path.exists():
            return None
        try:
            stored = read_state(self.path)
            work_text(stored)
        except FileFormatError as error:
            if self.resume:
                raise FileFormatError(
                    self.path, f"{error.reason}; without resume, the run starts anew"
                ) from None
            self._tell(f"nephroid: warning: replacing a checkpoint: {error}")
            return None
        return stored

    def _refuse_to_forget(self, stored: StoredState, asked: int) -> None:
        """Tell of a checkpoint that is about to be replaced, or do not replace it."""
        work, mismatch = work_text(stored), self._mismatch(stored, asked)
        is_worth_it = stored.numbers["seconds"] >= WORTH_KEEPING_S
        if mismatch is not None:
            reason, differences = mismatch
            end = "no resume (--no-resume) throws it away" if is_worth_it else "it is replaced"
            error = CheckpointError(self.path, f"{reason} ({work}); {end}", differences)
            if is_worth_it:
                raise error
            self._tell(f"nephroid: starting anew; {error}")
        elif is_worth_it:
            raise CheckpointError(
                self.path,
                f"it holds {work}: resume (--resume) goes on from there, no resume (--no-resume)"
                " throws it away",
            )
        else:
            self._tell(
                f"nephroid: starting anew; resume would have gone on after {work},"
                f" from {str(self.path)!r}"
            )

    def _refuse_other_run(self, stored: StoredState, asked: int) -> None:
        mismatch = self._mismatch(stored, asked)
        if mismatch is not None:
            reason, differences = mismatch
            raise CheckpointError(
                self.path,
                f"{reason}, and cannot be gone on with; no resume (--no-resume) throws it away",
                differences,
            )

    def _mismatch(
        self, stored: StoredState, asked: int
    ) -> tuple[str, tuple[Difference, ...]] | None:
        """Why the file's run cannot be gone on with, in words and in what differs; None if it can.

        Args:
            stored: what the file holds.
            asked: passes that there shall be, at most.
        """
        differences = list_differences(stored.numbers.get("fingerprint"), self._fingerprint)
        if differences:
            return "it is of another run", tuple(differences)
        done = stored.numbers["passes"]
        if done > asked:
            passes = ("settings.passes", f"{done}", f"{asked}")
            return "it holds more passes than there shall be", (passes,)
        return None

    def _remove_temporaries(self) -> None:
        """What a run that was killed has left behind half-written, or one that was left."""
        with contextlib.suppress(OSError):
            for path in self.path.parent.iterdir():
                if path.name.startswith(f"{self.path.name}-") and path.suffix == ".tmp":
                    path.unlink(missing_ok=True)

    def _beside(self, ending: str) -> Path:
        return self.path.with_name(self.path.name + ending)
