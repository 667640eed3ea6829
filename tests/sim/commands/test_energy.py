"""The energy books in words."""

from sim.commands.energy import band_lines, print_books
from sim.photons.energy import EnergyBooks

BOOKS = EnergyBooks(
    4.0, 1.0, 2.0, 0.5, 0.5,
    by_band=((1.0, 0.25, 0.5, 0.125, 0.125), (3.0, 0.75, 1.5, 0.375, 0.375)),
)  # fmt: skip


def test_every_band_has_a_line_in_the_order_of_the_columns(capsys):
    print_books(BOOKS, [450.0, 550.0])
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ["emitted", "4", "W", "100.000%"]
    assert lines[3].split() == ["absorbed", "2", "W", "50.000%"]
    assert lines[-3].split()[2:] == ["emitted", "deposited", "absorbed", "escaped", "culled"]
    assert lines[-2].split() == ["450", "nm", "1", "0.25", "0.5", "0.125", "0.125"]
    assert lines[-1].split() == ["550", "nm", "3", "0.75", "1.5", "0.375", "0.375"]
    # A number under the end of its heading.
    assert len({len(line) for line in lines[-3:]}) == 1


def test_books_without_bands_have_no_table():
    assert band_lines((), [450.0]) == []
