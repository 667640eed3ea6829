"""One run at a time, and locks that die with their process."""

import os
import subprocess
import sys

import pytest

from sim.errors import OutputError
from sim.resumption.run_lock import RunLock

pytest.importorskip("fcntl")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "out.lock"


def test_the_second_is_refused_and_told_who_has_it(path):
    first, second = RunLock(path, "out.exr"), RunLock(path, "out.exr")
    first.acquire()
    with pytest.raises(OutputError, match=rf"'out.exr': another run .* process {os.getpid()} on "):
        second.acquire()
    first.release()
    assert not path.exists()
    second.acquire()
    second.release()
    assert not path.exists()


def test_a_refused_one_does_not_take_it_away(path):
    first, second = RunLock(path, "out.exr"), RunLock(path, "out.exr")
    first.acquire()
    for _ in range(2):
        with pytest.raises(OutputError):
            second.acquire()
        second.release()
        assert path.exists()
    first.release()


def test_what_a_killed_process_leaves_locks_nothing(path):
    program = (
        "import os, signal, sys\nfrom sim.resumption.run_lock import RunLock\n"
        f"RunLock(__import__('pathlib').Path({str(path)!r}), 'out.exr').acquire()\n"
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run([sys.executable, "-c", program], env=environment, check=False)
    assert done.returncode == -9
    assert path.read_text().split()[0] != str(os.getpid())
    lock = RunLock(path, "out.exr")
    lock.acquire()
    assert path.read_text().split()[0] == str(os.getpid())
    lock.release()


@pytest.mark.parametrize("note", [b"", b"junk", b"\xff\xff \xff", b"1 2 3", b"x" * 5000])
def test_a_note_that_says_nothing_is_not_repeated(path, note):
    first, second = RunLock(path, "out.exr"), RunLock(path, "out.exr")
    first.acquire()
    path.write_bytes(note)
    with pytest.raises(OutputError) as caught:
        second.acquire()
    assert caught.value.reason == "another run is at it"
    first.release()


def test_a_lock_file_removed_while_it_was_opened_is_made_anew(path, monkeypatch):
    # The holder removes its file between our open and our flock: what we then hold is a file
    # that nobody else will find.
    import fcntl

    real, calls = fcntl.flock, []

    def flock(descriptor, how):
        if not calls:
            path.unlink()
        calls.append(how)
        real(descriptor, how)

    monkeypatch.setattr(fcntl, "flock", flock)
    lock = RunLock(path, "out.exr")
    lock.acquire()
    assert len(calls) == 2
    assert path.exists()
    lock.release()


def test_where_there_can_be_no_file_it_says_so(tmp_path):
    with pytest.raises(OutputError, match="No such file or directory"):
        RunLock(tmp_path / "gone" / "out.lock", "out.exr").acquire()


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("EWOULDBLOCK", "another run is at it"), ("EACCES", "another run is at it"),
        ("EIO", r"Input/output error \('.*out.lock'\)"), ("EINTR", "Interrupted system call"),
    ],
)  # fmt: skip
def test_only_a_lock_that_is_held_is_told_as_another_run(path, monkeypatch, code, words):
    import errno
    import fcntl

    def flock(descriptor, how):
        raise OSError(getattr(errno, code), os.strerror(getattr(errno, code)))

    monkeypatch.setattr(fcntl, "flock", flock)
    with pytest.raises(OutputError, match=words):
        RunLock(path, "out.exr").acquire()
