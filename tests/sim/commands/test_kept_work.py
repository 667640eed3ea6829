"""What is said, and with which status, of a run that is cut short."""

import pytest

from sim.cli import main
from sim.commands import render
from sim.resumption.checkpoint import Checkpoint

LACKING = RuntimeError("Failed to allocate 8 bytes on device 'cpu'")


@pytest.fixture
def bench(small_scene, tmp_path, monkeypatch):
    (tmp_path / "bench.toml").write_text(small_scene.source_text, "utf-8")
    monkeypatch.chdir(tmp_path)
    return ["render", "bench.toml", "--photons", "100", "--passes", "4"]


@pytest.mark.parametrize("made", [0, 1])
@pytest.mark.parametrize("error", [LACKING, MemoryError("no room")])
def test_memory_that_lacks_before_any_work_is_no_unfinished_run(
    bench, monkeypatch, capsys, made, error
):
    def work(scene, settings, arguments, output, checkpoint):
        checkpoint.made = made
        raise error

    monkeypatch.setattr(render, "_render_to_files", work)
    assert main(bench) == (1 if made else 2)
    assert capsys.readouterr().err == f"nephroid: error: not enough memory: {error}\n"


def test_passes_are_counted_whether_they_are_kept_or_not(bench, monkeypatch, capsys):
    # Few passes are made before a checkpoint is due.
    real, seen = Checkpoint.offer, []

    def offer(self, state):
        real(self, state)
        seen.append((self.passes, self.made))
        if state.passes == 2:
            raise LACKING

    monkeypatch.setattr(Checkpoint, "offer", offer)
    monkeypatch.setattr(Checkpoint, "_write", lambda self, state: None)
    assert main(bench) == 1
    assert seen == [(0, 1), (0, 2)]


