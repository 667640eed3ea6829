"""Energy books add up, and average."""

import dataclasses
import json

import numpy as np
import pytest

from sim.photons.energy import BOOK_COLUMNS, EnergyBooks


def test_the_residual_is_what_is_unaccounted_for():
    books = EnergyBooks(emitted=4.0, deposited=1.0, absorbed=0.5, escaped=1.5, culled=0.25)
    assert books.residual == 0.75 / 4.0
    assert EnergyBooks(0.0, 0.0, 0.0, 0.0, 0.0).residual == 0.0


def test_rows_of_ranges_add_up_in_the_order_of_the_columns():
    rows = np.arange(15.0).reshape(3, 5)
    books = EnergyBooks.from_rows(rows)
    assert [getattr(books, name) for name in BOOK_COLUMNS] == rows.sum(axis=0).tolist()


def test_rows_of_bands_add_up_band_by_band():
    rows, band_rows = np.ones((2, 5)), np.arange(20.0).reshape(2, 10)
    books = EnergyBooks.from_rows(rows, band_rows)
    assert books.by_band == ((10.0, 12.0, 14.0, 16.0, 18.0), (20.0, 22.0, 24.0, 26.0, 28.0))
    assert [one.totals for one in books.bands] == list(books.by_band)
    assert EnergyBooks.from_rows(rows).bands == ()
    mean = EnergyBooks.mean([books, EnergyBooks.from_rows(rows, 3.0 * band_rows)])
    assert mean.by_band[1] == (40.0, 44.0, 48.0, 52.0, 56.0)
    # As JSON gives them back.
    assert EnergyBooks(**json.loads(json.dumps(dataclasses.asdict(books)))) == books


def test_passes_are_averaged():
    one = EnergyBooks(1.0, 0.5, 0.25, 0.25, 0.0)
    two = EnergyBooks(3.0, 1.5, 0.75, 0.5, 0.25)
    mean = EnergyBooks.mean([one, two])
    assert mean == EnergyBooks(2.0, 1.0, 0.5, 0.375, 0.125)
    assert mean.residual == pytest.approx(0.0, abs=1e-15)
