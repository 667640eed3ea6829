"""Progress for people: words, rates, and how often."""

import io

import pytest

from sim.progress import Progress
from sim.progress_display import ProgressLines, progress_display, progress_text


def report(**changes):
    values = {
        "stage": "trace",
        "pass_index": 2,
        "passes": 8,
        "photons_done": 1_500_000,
        "photons_total": 4_000_000,
        "seconds": 3.0,
    }
    return Progress(**{**values, **changes})


def test_words():
    # 2.5 million photons are left; at 2.05 million a second they take 1.2 s, rounded up.
    assert (
        progress_text(report(), 2.05e6)
        == "pass 3/8, trace: 1.5M of 4M photons, 2.05M/s, 2 s left"
    )
    assert progress_text(report(), None) == "pass 3/8, trace: 1.5M of 4M photons"


@pytest.mark.parametrize(
    ("left", "text"), [(0, "0 s left"), (59, "59 s left"), (61, "1 min 01 s left")]
)
def test_time_left(left, text):
    shown = progress_text(report(photons_done=100 - left, photons_total=100), 1.0)
    assert shown.endswith(text)


def test_lines_come_with_each_new_stage_and_every_two_seconds():
    stream = io.StringIO()
    lines = ProgressLines(stream)
    for tenths in range(60):
        stage = "trace" if tenths % 10 < 5 else "gather"
        lines(report(stage=stage, seconds=tenths / 10))
    # Due at 0 s (trace), 0.5 s (gather), and then 2.5 s and 4.5 s.
    assert [line.split(":")[0].split()[-1] for line in stream.getvalue().splitlines()] == [
        "trace",
        "gather",
        "gather",
        "gather",
    ]


def test_the_rate_leaves_out_what_came_before_the_first_photons():
    stream = io.StringIO()
    lines = ProgressLines(stream)
    lines(report(stage="compile", photons_done=0, seconds=10.0))
    lines(report(photons_done=100_000, seconds=20.0))
    lines(report(photons_done=300_000, seconds=22.0))
    *_, last = stream.getvalue().splitlines()
    # (300 000 - 100 000) photons in 2 s; 3.7 million are left: 37 s.
    assert last == "pass 3/8, trace: 300k of 4M photons, 100k/s, 37 s left"


def test_anything_but_a_terminal_gets_plain_lines():
    stream = io.StringIO()
    with progress_display(stream) as show:
        show(report())
    assert stream.getvalue() == "pass 3/8, trace: 1.5M of 4M photons\n"


def test_a_terminal_gets_a_bar_that_is_cleared_and_a_cursor_that_is_back():
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    stream = Terminal()
    with pytest.raises(KeyboardInterrupt), progress_display(stream) as show:
        show(report(photons_done=1_000_000, seconds=1.0))
        show(report())
        raise KeyboardInterrupt
    written = stream.getvalue()
    assert "pass 3/8, trace" in written
    assert written.rfind("\x1b[?25h") > written.rfind("\x1b[?25l")
