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
    assert (
        progress_text(report(), 2.05e6, 1.2)
        == "pass 3/8, trace: 1.5M of 4M photons, 2.05M/s, 2 s left"
    )
    assert progress_text(report(), None, None) == "pass 3/8, trace: 1.5M of 4M photons"


@pytest.mark.parametrize(
    ("left", "text"), [(0, "0 s left"), (58.2, "59 s left"), (61, "1 min 01 s left")]
)
def test_time_left(left, text):
    assert progress_text(report(), 1.0, left).endswith(f", {text}")


def test_a_run_that_was_left_behind_writes_no_more():
    stream = io.StringIO()
    with progress_display(stream) as show:
        show(report(stage="trace"))
    show(report(stage="gather"))
    assert stream.getvalue().count("\n") == 1


class Full(io.StringIO):
    """A disk that takes one line."""

    tries = 0

    def write(self, text):
        self.tries += 1
        if self.getvalue().count("\n"):
            raise OSError(28, "No space left on device")
        return super().write(text)


def test_a_stream_that_takes_no_more_ends_no_run():
    stream = Full()
    with progress_display(stream) as show:
        show(report(stage="trace"))
        show(report(stage="gather"))
        before = stream.tries
        show(report(stage="develop"))
    assert stream.tries == before
    assert stream.getvalue() == "pass 3/8, trace: 1.5M of 4M photons\n"


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


def test_the_time_left_goes_by_the_passes_that_are_done():
    stream = io.StringIO()
    lines = ProgressLines(stream)
    for pass_index, done, seconds in [(0, 1, 10.0), (0, 100, 12.0), (1, 100, 20.0), (1, 200, 24.0)]:
        lines(report(pass_index=pass_index, photons_done=done, photons_total=800, seconds=seconds))
    *_, last = stream.getvalue().splitlines()
    # The first pass took 10 s, so the other seven take 70 s, of which 4 s have gone by. Meanwhile
    # 199 photons in 14 s are 14.2 a second.
    assert last.endswith("200 of 800 photons, 14.2/s, 1 min 06 s left")


def test_a_single_pass_that_gathers_makes_no_promise():
    stream = io.StringIO()
    lines = ProgressLines(stream)
    for stage, done, seconds in [("trace", 10, 1.0), ("gather", 100, 9.0)]:
        lines(report(stage=stage, pass_index=0, passes=1, photons_done=done, photons_total=100,
                     seconds=seconds))  # fmt: skip
    *_, last = stream.getvalue().splitlines()
    assert last == "pass 1/1, gather: 100 of 100 photons, 11.2/s"


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
