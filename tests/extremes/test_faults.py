"""Faults while `nephroid render` is at work: nothing is lost, and what happened is said."""

import itertools
import os
import random
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest

from sim.cli import main
from sim.resumption.checkpoint import Checkpoint
from sim.resumption.state_file import read_state

if os.name != "posix":
    pytest.skip("signals and limits of POSIX", allow_module_level=True)

PASSES = 60
LONG = ["render", "bench.toml", "--photons", "10000", "--passes", str(PASSES), "--seed", "5"]
"""A pass takes some 0.05 s of a core."""

SHORT = ["render", "bench.toml", "--photons", "500", "--passes", "6", "--seed", "5"]


def scene_text(small_scene):
    """With a sensor of each kind, whose tallies are kept too."""
    place = (
        'shape = {type = "disk", position = [0.0, 0.2, 0.0], normal = [0.0, 1.0, 0.0],'
        " radius = 0.5}\n"
    )
    return (
        f'{small_scene.source_text}\n[[sensors]]\ntype = "irradiance"\nname = "table"\n'
        f'pixels = [4, 3]\n{place}\n[[sensors]]\ntype = "rays"\nname = "rays"\n'
        f"max_rays = 500\n{place}"
    )


@pytest.fixture
def bench(small_scene, tmp_path, monkeypatch):
    """The current folder, with a scene in it."""
    (tmp_path / "bench.toml").write_text(scene_text(small_scene), "utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def outputs(folder):
    """What a run has written, by name."""
    names = ("bench.exr", "bench.png", "bench.table.exr", "bench.table.npz", "bench.rays.npz")
    return {name: (folder / name).read_bytes() for name in names}


@pytest.fixture(scope="module")
def undisturbed(small_scene, tmp_path_factory):
    """What undisturbed runs write."""

    def render(words, folder):
        before = os.getcwd()
        os.chdir(folder)
        try:
            (folder / "bench.toml").write_text(scene_text(small_scene), "utf-8")
            assert main(words) == 0
            assert len(os.listdir(folder)) == 6
            return outputs(folder)
        finally:
            os.chdir(before)

    return {
        "long": render(LONG, tmp_path_factory.mktemp("long")),
        "short": render(SHORT, tmp_path_factory.mktemp("short")),
    }


@contextmanager
def started(words):
    """A run in a process of its own, in the current folder; killed if it is still there."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    with subprocess.Popen(
        [sys.executable, "-m", "sim.cli", *words],
        env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        try:
            yield process
        finally:
            process.kill()


def wait_for_passes(process, path, more_than):
    """Wait for a checkpoint of more passes than that, or for the run's end."""
    while process.poll() is None:
        time.sleep(0.01)
        try:
            if read_state(path).numbers["passes"] > more_than:
                return
        except ValueError:  # there is none yet
            continue


def test_killed_at_any_moment_it_goes_on_to_the_same_files(bench, undisturbed):
    # Seeded moments, from the first pass on: while photons are traced, gathered, written.
    rng, path, kept, kills = random.Random(2024), bench / "bench.exr.checkpoint", 0, 0
    while kills < 3:
        with started([*LONG, "--resume"]) as process:
            wait_for_passes(process, path, kept)
            time.sleep(rng.uniform(0.0, 0.4))
            process.send_signal(signal.SIGKILL)
            process.communicate()
        assert process.returncode == -signal.SIGKILL, "it was to be killed at work"
        assert not (bench / "bench.exr").exists()
        # Whole, whatever it was doing; and what was there once is there still.
        passes = read_state(path).numbers["passes"]
        assert passes > kept
        kept, kills = passes, kills + 1
    assert kept < PASSES
    assert main([*LONG, "--resume"]) == 0
    assert outputs(bench) == undisturbed["long"]
    assert len(os.listdir(bench)) == 6  # no checkpoint, lock, or half-written file is left


@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM])
def test_told_to_stop_it_says_how_to_go_on(bench, undisturbed, stop, capfd):
    path = bench / "bench.exr.checkpoint"
    with started(LONG) as process:
        wait_for_passes(process, path, 0)
        if stop == signal.SIGINT:  # Meanwhile, another run on the same file.
            assert main(SHORT) == 2
            told = capfd.readouterr().err
            assert re.search(
                rf"^nephroid: error: cannot write 'bench.exr': another run is at it, process"
                rf" {process.pid} on \S+$", told, re.MULTILINE,
            )  # fmt: skip
            assert process.poll() is None
        process.send_signal(stop)
        out, err = process.communicate()
    assert process.returncode == 130
    assert out == ""
    assert "Traceback" not in err
    *_, said, command = err.splitlines()
    passes = read_state(path).numbers["passes"]
    assert said == f"nephroid: stopped after {passes} pass{'es' * (passes > 1)}; to go on:"
    assert sorted(os.listdir(bench)) == ["bench.exr.checkpoint", "bench.toml"]
    program, *words = shlex.split(command)
    assert (program, words) == ("nephroid", [*LONG, "--resume"])
    assert main(words) == 0
    assert f"going on after {passes} pass" in capfd.readouterr().err
    assert outputs(bench) == undisturbed["long"]


@pytest.fixture
def after_two_passes(monkeypatch):
    """Do something to the world between the second pass, kept, and the third."""

    def arrange(fault):
        real = Checkpoint.offer

        def offer(self, state):
            self._saved_at = float("-inf")  # due
            real(self, state)
            if state.passes == 2:
                fault()

        monkeypatch.setattr(Checkpoint, "offer", offer)

    return arrange


def check_failure(text, reason):
    """The messages of a run that could not write after its second pass."""
    *_, warned, error, command = text.splitlines()
    assert re.fullmatch(
        rf"nephroid: warning: no checkpoint: cannot write '.*bench\.exr\.checkpoint': {reason}.*;"
        r" that of 2 passes is kept; going on", warned,
    )  # fmt: skip
    assert re.fullmatch(
        rf"nephroid: error: cannot write '.*bench\.exr': {reason}.*; kept 2 passes; to go on:",
        error,
    )
    assert command.endswith(" --resume")
    assert "Traceback" not in text


def go_on(bench, undisturbed, monkeypatch, capfd):
    """The fault mended: go on from the second pass."""
    monkeypatch.undo()
    monkeypatch.chdir(bench)
    assert main([*SHORT, "--resume"]) == 0
    assert "going on after 2 passes" in capfd.readouterr().err
    assert outputs(bench) == undisturbed["short"]


def test_a_file_size_limit_midway(bench, undisturbed, after_two_passes, monkeypatch, capfd):
    # The system's own refusal, EFBIG: files may have 500 bytes from now on.
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    after_two_passes(lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500, before[1])))
    try:
        status = main(SHORT)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert status == 1
    check_failure(capfd.readouterr().err, "File too large")
    assert sorted(os.listdir(bench)) == ["bench.exr.checkpoint", "bench.toml"]
    go_on(bench, undisturbed, monkeypatch, capfd)


@pytest.fixture
def disk(bench, monkeypatch):
    """A disk of its own for the bench's folder, of half a megabyte."""
    folder = bench / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=512k", "tmpfs", str(folder)]
    can = shutil.which("mount") is not None
    if not can or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("no right to mount a disk")
    shutil.copy(bench / "bench.toml", folder)
    monkeypatch.chdir(folder)
    yield folder
    os.chdir(bench)
    subprocess.run(["umount", str(folder)], check=True)


def fill(folder):
    """Write until there is no room left."""
    with open(folder / "ballast", "wb", buffering=0) as ballast, pytest.raises(OSError):
        for _ in itertools.count():
            ballast.write(bytes(1024))


def test_a_disk_that_is_full_midway(disk, undisturbed, after_two_passes, monkeypatch, capfd):
    after_two_passes(lambda: fill(disk))
    assert main(SHORT) == 1
    check_failure(capfd.readouterr().err, "No space left on device")
    assert sorted(os.listdir(disk)) == ["ballast", "bench.exr.checkpoint", "bench.toml"]
    (disk / "ballast").unlink()
    go_on(disk, undisturbed, monkeypatch, capfd)


def test_a_disk_without_room_to_begin_with(disk, after_two_passes, capfd):
    # Names there may still be, contents not: there is a lock, but no checkpoint ever.
    fill(disk)
    after_two_passes(lambda: None)
    assert main(SHORT) == 1
    *_, warned, error = capfd.readouterr().err.splitlines()
    assert "No space left on device; there is none yet; going on" in warned
    assert error == "nephroid: error: cannot write 'bench.exr': No space left on device"
    assert sorted(os.listdir(disk)) == ["ballast", "bench.toml"]


def test_a_folder_that_is_closed_to_us(bench, undisturbed, after_two_passes, monkeypatch, capfd):
    user = os.geteuid()

    def lose():
        bench.chmod(0o555)
        if user == 0:  # Permissions do not bind root: be nobody.
            os.seteuid(65534)

    after_two_passes(lose)
    try:
        status = main(SHORT)
    finally:
        os.seteuid(user)
        bench.chmod(0o755)
    assert status == 1
    check_failure(capfd.readouterr().err, "Permission denied")
    go_on(bench, undisturbed, monkeypatch, capfd)


def test_a_target_that_is_taken_midway(bench, undisturbed, after_two_passes, monkeypatch, capfd):
    after_two_passes((bench / "bench.exr").mkdir)
    assert main(SHORT) == 1
    *_, error, command = capfd.readouterr().err.splitlines()
    assert error == (
        "nephroid: error: cannot write 'bench.exr': it is a folder; name a file in it; kept 6"
        " passes; to go on:"
    )
    (bench / "bench.exr").rmdir()
    assert main(shlex.split(command)[1:]) == 0
    assert outputs(bench) == undisturbed["short"]


def test_a_folder_that_is_gone(bench, after_two_passes, capfd):
    (bench / "out").mkdir()
    after_two_passes(lambda: shutil.rmtree(bench / "out"))
    assert main([*SHORT, "-o", "out/bench.exr"]) == 1
    check_failure(capfd.readouterr().err, "there is no folder")
    assert os.listdir(bench) == ["bench.toml"]


def test_a_folder_that_is_gone_and_comes_back(bench, undisturbed, after_two_passes, capfd):
    (bench / "out").mkdir()

    def replace():
        shutil.rmtree(bench / "out")
        (bench / "out").mkdir()

    after_two_passes(replace)
    assert main([*SHORT, "-o", "out/bench.exr"]) == 0
    assert "warning" not in capfd.readouterr().err
    assert outputs(bench / "out") == undisturbed["short"]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--seed", "6"], r"settings.seed: 5 in the checkpoint, 6 asked"),
        (["--bounces", "1"], r"settings.bounces: 0 in the checkpoint, 1 asked"),
        (["--passes", "7"], r"settings.passes: even, .* in the checkpoint, odd, .* asked"),
    ],
)
def test_the_command_refuses_another_run(bench, after_two_passes, capfd, arguments, told):
    kept_after(after_two_passes, bench)
    before = (bench / "bench.exr.checkpoint").read_bytes()
    capfd.readouterr()
    assert main([*SHORT, *arguments, "--resume"]) == 2
    error = capfd.readouterr().err
    assert "nephroid: error: checkpoint 'bench.exr.checkpoint': it is of another run" in error
    assert re.search(told, error)
    assert (bench / "bench.exr.checkpoint").read_bytes() == before
    assert sorted(os.listdir(bench)) == ["bench.exr.checkpoint", "bench.toml"]


def kept_after(after_two_passes, bench):
    """Leave a checkpoint of two passes, as Ctrl-C does."""

    def interrupt():
        raise KeyboardInterrupt

    after_two_passes(interrupt)
    assert main(SHORT) == 130
    assert sorted(os.listdir(bench)) == ["bench.exr.checkpoint", "bench.toml"]


def test_a_changed_scene_and_a_damaged_checkpoint(bench, after_two_passes, capfd):
    kept_after(after_two_passes, bench)
    text, path = (bench / "bench.toml").read_text(), bench / "bench.exr.checkpoint"
    (bench / "bench.toml").write_text(text.replace("N-BK7", "SF11"))
    assert main([*SHORT, "--resume"]) == 2
    told = capfd.readouterr().err
    assert "scene.objects.0.material.medium: N-BK7 in the checkpoint, SF11 asked" in told
    (bench / "bench.toml").write_text(text)
    path.write_bytes(path.read_bytes()[:-1])
    assert main([*SHORT, "--resume"]) == 2
    *_, last = capfd.readouterr().err.splitlines()
    assert last.startswith("nephroid: error: cannot read 'bench.exr.checkpoint': it is damaged")


def test_without_a_checkpoint_or_without_resume_it_starts_anew(
    bench, undisturbed, after_two_passes, monkeypatch, capfd
):
    assert main([*SHORT, "--resume"]) == 0
    assert "there is no checkpoint 'bench.exr.checkpoint': starting anew" in capfd.readouterr().err
    assert outputs(bench) == undisturbed["short"]
    for name in outputs(bench):
        (bench / name).unlink()
    kept_after(after_two_passes, bench)
    monkeypatch.undo()
    monkeypatch.chdir(bench)
    capfd.readouterr()
    assert main(SHORT) == 0
    assert "starting anew; resume would have gone on after 2 passes" in capfd.readouterr().err
    assert outputs(bench) == undisturbed["short"]
    assert len(os.listdir(bench)) == 6


def test_memory_that_runs_out_midway_is_told(bench, undisturbed, after_two_passes, monkeypatch,
                                             capfd):  # fmt: skip
    def allocate():
        raise RuntimeError("Failed to allocate 99999999999 bytes on device 'cpu'")  # as Warp does

    after_two_passes(allocate)
    assert main(SHORT) == 1
    *_, error, _ = capfd.readouterr().err.splitlines()
    assert error.startswith("nephroid: error: not enough memory: Failed to allocate 99999999999")
    assert error.endswith("; kept 2 passes; to go on:")
    go_on(bench, undisturbed, monkeypatch, capfd)


def test_a_photon_map_has_nothing_to_go_on_with(bench, capfd):
    assert main(["render", "bench.toml", "--photon-map", "--resume"]) == 2
    assert "resume: True is not allowed; allowed: no --resume" in capfd.readouterr().err
