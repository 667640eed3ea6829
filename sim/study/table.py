"""The study as a table: one row a point and result, every column documented."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from typing import Any

from sim.study.outcome import REFERENCE_SHARE, Outcome, Row
from sim.study.statistics import Interval

__all__ = ["COLUMNS", "encode_csv", "read_csv"]

Cell = Callable[[Outcome, Row], Any]

_PARTS = ("tracing", "binning", "mapping", "gathering")

_INTERVALS: dict[str, tuple[str, Callable[[Row], Interval]]] = {
    "error": ("relative L2 error of one run, noise and bias together", lambda r: r.errors.error),
    "noise": ("its part by chance", lambda r: r.errors.noise),
    "bias": ("its part that replicates share; 0 if none shows", lambda r: r.errors.bias),
    "cpu_s": ("CPU-seconds of a run over all threads, without compiling", lambda r: r.cpu_s),
    "tempered_error": (
        "root mean square of the picture's error as --target-error counts it, each pixel's over "
        "its luminance plus the mean", lambda r: r.tempered
    ),
    "ciede2000_mean": ("mean colour difference of the picture", lambda r: r.ciede_mean),
    "ciede2000_p95": ("95% of the pixels differ less", lambda r: r.ciede_p95),
    "centroid_arcsec": (
        "root mean square over bands of the angle between where light is and should be",
        lambda r: r.centroid_arcsec,
    ),
}


def _columns() -> dict[str, tuple[str, Cell]]:
    """Name → (what it holds, how it is found)."""
    columns: dict[str, tuple[str, Cell]] = {
        "scene": ("name of the scene", lambda o, r: o.scene),
        "result": ("bins: irradiance on a receiver; picture: its luminance", lambda o, r: r.result),
        "axis": ("what was varied; centre: nothing", lambda o, r: r.axis),
        "value": ("to what", lambda o, r: r.value),
        "photons": ("photons in a pass", lambda o, r: r.photons),
        "passes": ("passes of a run", lambda o, r: r.passes),
        "photons_of_default": (
            "photons in a pass relative to the scene's default",
            lambda o, r: r.photons / o.default_photons,
        ),
        "passes_of_default": (
            "passes relative to the scene's default", lambda o, r: r.passes / o.default_passes
        ),
        "replicates": ("independent runs, each with its own seed", lambda o, r: r.replicates),
    }
    for name, (text, of) in _INTERVALS.items():
        columns[name] = (text, lambda o, r, of=of: of(r).value)  # type: ignore[misc]
        columns[f"{name}_low"] = ("lower end of its 95% interval", lambda o, r, of=of: of(r).low)  # type: ignore[misc]
        columns[f"{name}_high"] = ("upper end of it", lambda o, r, of=of: of(r).high)  # type: ignore[misc]
    for i, part in enumerate(_PARTS):
        text = f"CPU-seconds of {part}" + (", scaled to the whole picture" if i == 3 else "")
        columns[f"{part}_cpu_s"] = (text, lambda o, r, i=i: r.parts_s[i])  # type: ignore[misc]
    columns |= {
        "energy_residual": (
            "largest share of the emitted flux unaccounted for", lambda o, r: r.energy_residual
        ),
        "pareto": (
            "1 if no other point is better in both time and error",
            lambda o, r: int(any(r is one for one in o.pareto(r.result))),
        ),
        "reference": ("what errors are measured against", lambda o, r: o.references[r.result].kind),
        "reference_error": (
            "its relative L2 error", lambda o, r: o.references[r.result].error
        ),
        "resolved": (
            f"1 if that is at most {REFERENCE_SHARE:g} of this row's error",
            lambda o, r: int(
                o.references[r.result].error <= REFERENCE_SHARE * r.errors.error.value
            ),
        ),
    }
    return columns


_COLUMNS = _columns()

COLUMNS = {name: text for name, (text, _) in _COLUMNS.items()}
"""What each column of ``study.csv`` holds, in their order."""


def encode_csv(outcome: Outcome) -> bytes:
    """The table as CSV (RFC 4180, but for plain line ends), its first line the columns' names."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for row in outcome.rows:
        writer.writerow([_text(of(outcome, row)) for _, of in _COLUMNS.values()])
    return text.getvalue().encode("utf-8")


def read_csv(data: bytes) -> list[dict[str, str]]:
    """The rows of a table as `encode_csv` writes it."""
    return list(csv.DictReader(io.StringIO(data.decode("utf-8"))))


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
