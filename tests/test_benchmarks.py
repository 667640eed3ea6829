"""The benchmarks: their history can be read and compared, and contestants do equal work."""

import csv
import importlib.util
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent / "benchmarks"


@pytest.fixture(scope="module")
def load():
    """Loads one of their modules; benchmarks are scripts, and no package."""
    loaded = []

    def load_module(name):
        spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module  # where dataclasses, and other benchmarks, look for it
        loaded.append(name)
        spec.loader.exec_module(module)
        return module

    yield load_module
    for name in loaded:
        del sys.modules[name]


@pytest.fixture(scope="module")
def history(load):
    return load("history")


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


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_the_c_program_traces_the_same_photons(history, load, tmp_path):
    # Deposits, their flux and the energy books, to 1e-9: no ratio of rates means anything else.
    rates = load("tracer_rates")
    nephroid = rates.Nephroid("ball", 20_000, polarisation="averaged")
    assert rates.can_follow(nephroid.compiled)
    assert not rates.can_follow(rates.Nephroid("ball", 1000).compiled)
    _, *theirs = rates.Rival("cc", tmp_path, nephroid, "ball").run()
    rates.check_equal_work("ball", nephroid.totals(), np.array(theirs))
