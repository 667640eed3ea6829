"""The benchmarks' history: what is recorded can be read, and compared with what is asked."""

import csv
import importlib.util
import re
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent / "benchmarks"


@pytest.fixture(scope="module")
def history():
    """The module that keeps it; benchmarks are scripts, and no package."""
    spec = importlib.util.spec_from_file_location("benchmark_history", HERE / "history.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look for their module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def read(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_measures_are_added_below_those_that_are_there(history, tmp_path):
    path = tmp_path / "history.csv"
    first = history.median_measure("ratio", "ball", [3.0, 1.0, 2.0], ">= 0.7", "9 photons")
    assert (first.value, first.low, first.high) == (2.0, 1.0, 3.0)
    history.record([first], path)
    history.record([history.Measure("power, of N", "lens", 0.5, 0.25, 0.75)], path)
    rows = read(path)
    assert tuple(rows[0]) == history.COLUMNS
    assert [row["measure"] for row in rows] == ["ratio", "power, of N"]
    assert [float(rows[0][key]) for key in ("value", "low", "high")] == [2.0, 1.0, 3.0]
    assert (rows[0]["asked"], rows[0]["note"], rows[1]["asked"]) == (">= 0.7", "9 photons", "")


def test_the_record_is_in_order(history):
    rows = read(history.HISTORY)
    assert rows
    assert tuple(rows[0]) == history.COLUMNS
    for row in rows:
        assert re.fullmatch(r"\d{4}-\d\d-\d\d", row["date"])
        value = float(row["value"])
        if row["low"]:
            assert float(row["low"]) <= value <= float(row["high"]), row
        if row["asked"]:
            assert re.fullmatch(r"[<>]=? -?[\d.]+", row["asked"]), row
