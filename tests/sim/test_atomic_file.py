"""Files appear whole or not at all, whatever fails."""

import errno
import os
import stat
import subprocess
import sys
import threading

import pytest

from sim.atomic_file import check_writable, write_whole
from sim.errors import OutputError

AS_ROOT = hasattr(os, "geteuid") and os.geteuid() == 0
on_posix = pytest.mark.skipif(os.name != "posix", reason="needs POSIX")


def test_writes_a_new_file_and_replaces_an_old_one(tmp_path):
    path = tmp_path / "out.bin"
    for data in (b"first", memoryview(b"second, longer"), b""):
        write_whole(path, data)
        assert path.read_bytes() == data
    write_whole(str(path), b"by name")
    assert os.listdir(tmp_path) == ["out.bin"]


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("missing/out.exr", "there is no folder"),
        ("a_file/out.exr", "is not a folder"),
        ("a_folder", "it is a folder"),
        ("x" * 300 + ".exr", "too long"),
        ("null\0.exr", "null"),
    ],
)
@pytest.mark.parametrize("function", [check_writable, lambda path: write_whole(path, b"data")])
def test_unusable_paths_are_told(tmp_path, name, reason, function):
    (tmp_path / "a_file").write_bytes(b"")
    (tmp_path / "a_folder").mkdir()
    with pytest.raises(OutputError) as caught:
        function(tmp_path / name)
    assert reason in str(caught.value)
    assert caught.value.path == os.fspath(tmp_path / name)
    assert sorted(os.listdir(tmp_path)) == ["a_file", "a_folder"]
    assert os.listdir(tmp_path / "a_folder") == []


@pytest.mark.skipif(AS_ROOT or os.name != "posix", reason="permissions do not bind this user")
def test_a_folder_that_may_not_be_written_to_is_told(tmp_path):
    tmp_path.chmod(0o555)
    with pytest.raises(OutputError, match="Permission denied"):
        check_writable(tmp_path / "out.exr")
    tmp_path.chmod(0o755)


@pytest.mark.skipif(AS_ROOT or os.name != "posix", reason="permissions do not bind this user")
def test_a_write_protected_file_stays(tmp_path):
    path = tmp_path / "precious.exr"
    path.write_bytes(b"precious")
    path.chmod(0o444)
    with pytest.raises(OutputError, match="write-protected"):
        write_whole(path, b"new")
    assert path.read_bytes() == b"precious"


def test_the_check_leaves_nothing_behind_and_touches_nothing(tmp_path):
    path = tmp_path / "out.exr"
    check_writable(path)
    assert os.listdir(tmp_path) == []
    path.write_bytes(b"old")
    check_writable(path)
    assert path.read_bytes() == b"old"


@pytest.mark.parametrize("old", [None, b"old"])
@pytest.mark.parametrize("step", ["fsync", "replace"])
@pytest.mark.parametrize(
    ("failure", "raised"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), OutputError),
        (KeyboardInterrupt(), KeyboardInterrupt),
    ],
)
def test_a_failure_at_any_step_changes_nothing(tmp_path, monkeypatch, old, step, failure, raised):
    path = tmp_path / "out.exr"
    if old is not None:
        path.write_bytes(old)

    def fail(*arguments):
        raise failure

    monkeypatch.setattr(os, step, fail)
    with pytest.raises(raised) as caught:
        write_whole(path, b"new")
    assert raised is KeyboardInterrupt or "No space left on device" in str(caught.value)
    assert (path.read_bytes() if path.exists() else None) == old
    assert os.listdir(tmp_path) == ([] if old is None else ["out.exr"])


@on_posix
def test_a_write_that_really_fails_half_way_changes_nothing(tmp_path):
    # A limit on the size of files makes the system refuse the write in the middle, as a full
    # disk does, and needs no privilege.
    program = (
        "import resource, sim.atomic_file as a\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))\n"
        "try: a.write_whole('out.exr', bytes(300_000))\n"
        "except a.OutputError as error: print(error)\n"
    )
    (tmp_path / "out.exr").write_bytes(b"old")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout == "cannot write 'out.exr': File too large\n"
    assert os.listdir(tmp_path) == ["out.exr"]
    assert (tmp_path / "out.exr").read_bytes() == b"old"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_device_is_told():
    with pytest.raises(OutputError, match="No space left on device"):
        write_whole("/dev/full", b"data")


@on_posix
def test_pipes_are_written_to_and_not_replaced(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    received = []
    reader = threading.Thread(target=lambda: received.append(path.read_bytes()))
    reader.start()
    check_writable(path)
    write_whole(path, b"data")
    reader.join()
    assert received == [b"data"]
    assert stat.S_ISFIFO(path.stat().st_mode)


@on_posix
def test_a_link_stays_a_link(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    target = tmp_path / "elsewhere" / "real.exr"
    link = tmp_path / "link.exr"
    link.symlink_to(target)
    write_whole(link, b"data")
    assert link.is_symlink()
    assert target.read_bytes() == b"data"


@on_posix
def test_a_file_has_the_permissions_of_any_new_file(tmp_path):
    old_mask = os.umask(0o027)
    try:
        write_whole(tmp_path / "out.exr", b"data")
    finally:
        os.umask(old_mask)
    assert stat.S_IMODE((tmp_path / "out.exr").stat().st_mode) == 0o640
