"""Numbers as people write them on a command line."""

import pytest

from sim.commands.arguments import count, duration, fraction


@pytest.mark.parametrize(
    ("text", "value"), [("1%", 0.01), ("0.5%", 0.005), ("0.02", 0.02), ("100%", 1.0)]
)
def test_fractions(text, value):
    assert fraction(text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "seconds"), [("90", 90.0), ("60s", 60.0), ("1.5min", 90.0), ("0.5h", 1800.0)]
)
def test_durations(text, seconds):
    assert duration(text) == seconds


@pytest.mark.parametrize(
    ("parse", "text"),
    [(fraction, "%"), (fraction, "1 pc"), (duration, "min"), (duration, "60m"), (count, "1.5")],
)
def test_what_is_no_number_is_refused(parse, text):
    with pytest.raises(ValueError):
        parse(text)
