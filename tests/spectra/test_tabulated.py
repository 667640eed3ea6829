import importlib.metadata
import os
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from spectra import tabulated
from spectra.arrays import FloatArray

# Reads one table and says whether colour-science was needed for it.
PROGRAM = """\
import sys
from spectra import observer, spectrum
assert spectrum("D65").density_at(560.0) == 100.0
assert observer().cmf.shape == (471, 3)
print("colour" in sys.modules)
"""


@pytest.fixture
def forgetful() -> Iterator[None]:
    """Nothing is remembered in memory, before or after."""
    for cached in (tabulated._tables, tabulated._part):
        cached.cache_clear()
    yield
    for cached in (tabulated._tables, tabulated._part):
        cached.cache_clear()


@pytest.fixture(scope="module")
def true_tables() -> dict[str, FloatArray]:
    return tabulated._ask_colour_science()


def run(cache: Path) -> bool:
    """In another process, whether colour-science was imported; fails if it complained."""
    finished = subprocess.run(
        [sys.executable, "-W", "error", "-c", PROGRAM],
        env={**os.environ, "NEPHROID_CACHE": str(cache)},
        cwd=Path(tabulated.__file__).parents[1],
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
    assert finished.stderr == ""
    return finished.stdout.strip() == "True"


def cache_file(folder: Path) -> Path:
    (only,) = folder.iterdir()
    return only


def test_the_second_process_does_not_import_colour_science(tmp_path: Path) -> None:
    cache = tmp_path / "not" / "there"
    assert run(cache)
    assert importlib.metadata.version("colour-science") in cache_file(cache).name
    assert not run(cache)


def test_an_unwritable_folder_costs_time_and_no_error(tmp_path: Path) -> None:
    # A file where the folder should be: nobody may create one below it, not even root.
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert run(blocked)
    assert blocked.read_text() == ""


def test_the_whole_table_is_as_colour_science_has_it(
    tmp_path: Path, true_tables: dict[str, FloatArray]
) -> None:
    path = tmp_path / "cache.npz"
    tabulated._write(path, true_tables)
    kept = tabulated._read(path)
    assert kept is not None
    assert kept.keys() == true_tables.keys()
    for key, table in true_tables.items():
        np.testing.assert_array_equal(kept[key], table)
        assert np.all(np.diff(table[:, 0]) > 0.0)


def test_any_damage_is_noticed(tmp_path: Path, true_tables: dict[str, FloatArray]) -> None:
    path = tmp_path / "cache.npz"
    tabulated._write(path, true_tables)
    sound = path.read_bytes()
    positions = np.random.default_rng(3).integers(0, len(sound), 60)
    for position in positions:
        path.write_bytes(sound[:position])
        assert tabulated._read(path) is None
        flipped = bytearray(sound)
        flipped[position] ^= 0xFF
        path.write_bytes(flipped)
        kept = tabulated._read(path)
        # Some bytes do not matter, such as time stamps; none may change a table.
        if kept is not None:
            for key, table in kept.items():
                np.testing.assert_array_equal(table, true_tables[key])


@pytest.mark.parametrize("content", [b"", b"nonsense", b"PK\x03\x04", b"\x93NUMPY\x01\x00"])
def test_a_foreign_file_is_replaced(
    content: bytes,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    forgetful: None,
) -> None:
    monkeypatch.setenv("NEPHROID_CACHE", str(tmp_path))
    path = tabulated._cache_path()
    assert path is not None
    path.write_bytes(content)
    assert tabulated.observer_tables()["CIE 1931 2 degree"].shape == (471, 4)
    assert tabulated._read(path) is not None
    assert cache_file(tmp_path) == path


@pytest.mark.parametrize(
    "tables",
    [
        {},
        {"illuminant/D65": np.ones((3, 2))},
        {"surprise": np.ones((3, 2))},
        {"illuminant/D65": np.ones(3)},
        {"illuminant/D65": np.ones((3, 2), dtype=np.float32)},
    ],
)
def test_a_file_with_other_tables_is_not_ours(
    tables: dict[str, FloatArray], tmp_path: Path
) -> None:
    path = tmp_path / "cache.npz"
    tabulated._write(path, tables)
    assert path.exists()
    assert tabulated._read(path) is None


def test_a_failed_write_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    tabulated._write(tmp_path / "cache.npz", {})
    assert list(tmp_path.iterdir()) == []


def test_tables_are_asked_for_once_in_a_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, forgetful: None
) -> None:
    asked = []

    def ask() -> dict[str, FloatArray]:
        asked.append(1)
        return {"illuminant/D65": np.array([[300.0, 1.0], [800.0, 1.0]])}

    monkeypatch.setattr(tabulated, "_ask_colour_science", ask)
    monkeypatch.setenv("NEPHROID_CACHE", str(tmp_path))
    for _ in range(3):
        assert list(tabulated.illuminant_tables()) == ["D65"]
        assert list(tabulated.observer_tables()) == []
    assert asked == [1]


def test_where_the_cache_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("NEPHROID_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert tabulated._cache_folder() == tmp_path / "xdg" / "nephroid"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert tabulated._cache_folder() == tmp_path / "home" / ".cache" / "nephroid"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert tabulated._cache_folder() == tmp_path / "home" / ".cache" / "nephroid"
    monkeypatch.setenv("NEPHROID_CACHE", str(tmp_path / "own"))
    assert tabulated._cache_folder() == tmp_path / "own"


def test_without_a_home_there_is_no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("NEPHROID_CACHE", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", homeless)
    assert tabulated._cache_path() is None


def test_numpy_prints_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == "colour"]:
        monkeypatch.delitem(sys.modules, name)
    before = np.get_printoptions()
    tabulated._ask_colour_science()
    assert np.get_printoptions() == before


def test_the_cache_file_is_only_the_users(
    tmp_path: Path, true_tables: dict[str, FloatArray]
) -> None:
    path = tmp_path / "cache.npz"
    tabulated._write(path, true_tables)
    assert not stat.S_IMODE(path.stat().st_mode) & (stat.S_IWGRP | stat.S_IWOTH)
