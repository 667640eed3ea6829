"""CIE tables from colour-science, asked for once and kept on disk.

Importing colour-science takes more than a second, and all that is wanted of it is some tables.
The first process that needs one copies them all into the user's cache folder; later ones read that
file and never import colour-science. The folder is ``$NEPHROID_CACHE``, or ``nephroid`` under
``$XDG_CACHE_HOME``, or ``~/.cache/nephroid``. A cache that cannot be read or written costs time,
never an error.
"""

import contextlib
import functools
import importlib.metadata
import io
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np

from spectra.arrays import FloatArray, read_only
from spectra.colour_science import import_colour_science

__all__ = ["illuminant_tables", "observer_tables"]

# What the file holds and how; raised when either changes, so that older files are not read.
_LAYOUT = 1

_ILLUMINANT = "illuminant/"
_OBSERVER = "observer/"

_OBSERVERS = {
    "CIE 1931 2 degree": "CIE 1931 2 Degree Standard Observer",
    "CIE 2015 2 degree": "CIE 2015 2 Degree Standard Observer",
}


def illuminant_tables() -> Mapping[str, FloatArray]:
    """CIE illuminants by name: wavelength [nm] and relative power per nm, each shape (n, 2)."""
    return _part(_ILLUMINANT)


def observer_tables() -> Mapping[str, FloatArray]:
    """Colour matching functions by name: wavelength [nm], x̄, ȳ, z̄, each shape (n, 4)."""
    return _part(_OBSERVER)


@functools.cache
def _part(prefix: str) -> Mapping[str, FloatArray]:
    tables = {key: table for key, table in _tables().items() if key.startswith(prefix)}
    return MappingProxyType({key.removeprefix(prefix): table for key, table in tables.items()})


@functools.cache
def _tables() -> dict[str, FloatArray]:
    path = _cache_path()
    tables = _read(path) if path else None
    if tables is None:
        tables = _ask_colour_science()
        if path:
            _write(path, tables)
    return {key: read_only(table) for key, table in tables.items()}


def _cache_path() -> Path | None:
    """Where the tables of the installed colour-science are kept; None without a home folder."""
    version = importlib.metadata.version("colour-science")
    try:
        return _cache_folder() / f"cie-tables-{_LAYOUT}-colour-science-{version}.npz"
    except RuntimeError:
        return None


def _cache_folder() -> Path:
    own = os.environ.get("NEPHROID_CACHE", "")
    if own:
        return Path(own)
    # The XDG base directory specification has relative paths ignored.
    shared = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (shared if shared.is_absolute() else Path.home() / ".cache") / "nephroid"


def _read(path: Path) -> dict[str, FloatArray] | None:
    """The tables of a cache file, or None if it is missing, damaged or not ours."""
    try:
        # From memory: given a path, NumPy leaves a damaged archive open.
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as file:
            tables = {key: file[key] for key in file.files}
    except Exception:  # Whatever a missing, foreign or damaged file makes NumPy or zlib raise.
        return None
    return tables if _is_sound(tables) else None


def _is_sound(tables: Mapping[str, FloatArray]) -> bool:
    columns = {_ILLUMINANT: 2, _OBSERVER: 4}
    for key, table in tables.items():
        prefix = key.partition("/")[0] + "/"
        if table.ndim != 2 or table.shape[1] != columns.get(prefix) or table.dtype != np.float64:
            return False
    required = {_OBSERVER + name for name in _OBSERVERS} | {_ILLUMINANT + "D65"}
    return required <= tables.keys()


def _write(path: Path, tables: Mapping[str, FloatArray]) -> None:
    """Write the cache file in one step, so that no reader meets half of it; give up in silence."""
    partial = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".npz", delete=False) as file:
            partial = Path(file.name)
            np.savez_compressed(file, allow_pickle=False, **tables)
        os.replace(partial, path)
    except OSError:
        if partial:
            with contextlib.suppress(OSError):
                partial.unlink()


def _ask_colour_science() -> dict[str, FloatArray]:
    """Sample every table we know of."""
    colour = import_colour_science()
    tables = {
        _ILLUMINANT + name: np.column_stack([spectrum.wavelengths, spectrum.values])
        for name, spectrum in colour.SDS_ILLUMINANTS.items()
        if not name.startswith("ISO ")  # Photographic ones, not the CIE's.
    }
    for name, theirs in _OBSERVERS.items():
        cmfs = colour.MSDS_CMFS[theirs]
        tables[_OBSERVER + name] = np.column_stack([cmfs.wavelengths, cmfs.values])
    return tables
