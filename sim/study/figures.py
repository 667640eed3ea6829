"""A study's figures, as SVG to put into a page."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.study.findings import Effect, effects, slopes
from sim.study.outcome import PLAIN_LADDER, Outcome, Row, ladder_rows
from sim.study.plan import CENTRE
from sim.study.setup import ResultKind

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_effects", "draw_front", "draw_parts", "to_svg"]

_ERROR_NAME = {
    "bins": "relative L2 error of irradiance",
    "picture": "relative L2 error of luminance",
}
_MARKERS = "osD^v<>PXp*hd"
_STAIR = "#444444"


def draw_front(outcome: Outcome, result: ResultKind) -> Figure:
    """Every point's error against its time, the Pareto set, and the power law of the photons."""
    figure, axes = _frame("CPU-seconds of a run", _ERROR_NAME[result])
    _draw_points(axes, outcome.of(result))
    best = outcome.pareto(result)
    axes.plot(
        [row.cpu_s.value for row in best], [row.errors.error.value for row in best],
        drawstyle="steps-post", color=_STAIR, linewidth=1.0, label="Pareto set", zorder=1,
    )
    axes.scatter(
        [row.cpu_s.value for row in best], [row.errors.error.value for row in best],
        s=130, facecolors="none", edgecolors=_STAIR, linewidths=1.0, zorder=2,
    )
    law = slopes(outcome, result).get("time")
    if law is not None:
        times = np.array([row.cpu_s.value for row in ladder_rows(outcome.of(result))])
        ends = np.array([times.min(), times.max()])
        slope = law.slope
        axes.plot(
            ends, [law.at(float(end)).value for end in ends], color="black", linestyle="--",
            linewidth=1.2,
            label=f"photons: time^{slope.value:.2f} [{slope.low:.2f}, {slope.high:.2f}]",
        )
    _draw_reference(axes, outcome, result)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    return figure


def _draw_points(axes: Axes, rows: list[Row]) -> None:
    """Points with their intervals, a colour and a marker an axis."""
    from matplotlib import colormaps

    names = list(dict.fromkeys(row.axis for row in rows))
    for i, name in enumerate(names):
        chosen = [row for row in rows if row.axis == name]
        errors = np.array([row.errors.error for row in chosen])
        style: dict[str, Any] = {"color": colormaps["tab20"](i % 20), "fmt": _MARKERS[i % 13]}
        if name == CENTRE:
            style = {"color": "black", "fmt": "*"}
        axes.errorbar(
            [row.cpu_s.value for row in chosen], errors[:, 0],
            yerr=_whiskers(errors), markersize=9 if name == CENTRE else 5, linewidth=0,
            elinewidth=0.8, label=name, zorder=3, **style,
        )


def draw_parts(outcome: Outcome, result: ResultKind) -> Figure:
    """Error, noise and bias against the photons of a pass, with the slopes."""
    figure, axes = _frame("photons in a pass", _ERROR_NAME[result])
    ladder, laws = ladder_rows(outcome.of(result)), slopes(outcome, result)
    photons = np.array([row.photons for row in ladder], dtype=float)
    lines = {
        "error": ("black", [row.errors.error for row in ladder]),
        "noise": ("tab:blue", [row.errors.noise for row in ladder]),
        "bias": ("tab:red", [row.errors.bias for row in ladder]),
    }
    for shift, (name, (colour, values)) in zip((0.97, 1.0, 1.03), lines.items(), strict=True):
        known = np.array(values)
        lit = known[:, 0] > 0.0
        axes.errorbar(
            photons[lit] * shift, known[lit, 0], yerr=_whiskers(known[lit]), fmt="o", markersize=4,
            color=colour, linewidth=0, elinewidth=0.8,
            label=_with_slope(name, laws) if lit.any() else None,
        )
        # Where no bias shows, the interval tells how much there could be.
        if not lit.all():
            axes.plot(photons[~lit] * shift, known[~lit, 2], "v", color=colour, markersize=5,
                      markerfacecolor="none", label=f"{name}: not more than")
        if name in laws:
            law = laws[name]
            axes.plot(photons, [law.at(n).value for n in photons], color=colour, linewidth=0.8)
    if outcome.photon_noise and result == "picture":
        still = [one for one in outcome.photon_noise if not one.plain]
        axes.plot([one.photons for one in still], [one.noise for one in still], "s--",
                  color="tab:green", markersize=4, linewidth=0.8,
                  label=_with_slope("photon noise", laws) + ", camera held still")
    plain = [row for row in outcome.of(result) if row.axis == PLAIN_LADDER]
    if plain:
        axes.plot([row.photons for row in plain], [row.errors.error.value for row in plain], "x:",
                  color="tab:purple", linewidth=0.8, label="error, random, unaimed, roulette")
    _draw_reference(axes, outcome, result)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    return figure


def _with_slope(name: str, laws: dict[str, Any]) -> str:
    if name not in laws:
        return name
    slope = laws[name].slope
    return f"{name}: N^{slope.value:.2f} [{slope.low:.2f}, {slope.high:.2f}]"


def draw_effects(outcome: Outcome, result: ResultKind) -> Figure:
    """Photons for the same error, at equal time, of every value that is not of the ladders."""
    from matplotlib.figure import Figure

    found = sorted(effects(outcome, result), key=_of_ratio)
    figure = Figure(figsize=(8.5, 0.6 + 0.22 * len(found)), layout="constrained")
    axes = figure.add_subplot()
    values = np.array([one.ratio for one in found])
    places = np.arange(len(found))
    axes.errorbar(values[:, 0], places, xerr=_whiskers(values), fmt="o", markersize=4, linewidth=0,
                  elinewidth=1.0, color="tab:blue")
    axes.axvline(1.0, color="black", linewidth=0.8)
    axes.set_xscale("log")
    axes.set_yticks(places, [one.row.name for one in found], fontsize=7)
    axes.set_xlabel("error² × time relative to the centre: right of 1 is worse")
    axes.grid(axis="x", linewidth=0.3)
    return figure


def _of_ratio(effect: Effect) -> float:
    return effect.ratio.value


def _draw_reference(axes: Axes, outcome: Outcome, result: ResultKind) -> None:
    error = outcome.references[result].error
    if error > 0.0 and math.isfinite(error):
        axes.axhline(error, color="gray", linestyle=":", linewidth=1.0,
                     label=f"the reference's own error, {error:.2g}")


def _whiskers(intervals: Any) -> Any:
    """(2, n) lengths below and above, kept finite and above zero on a logarithmic axis."""
    value, low, high = intervals[:, 0], intervals[:, 1], intervals[:, 2]
    below = value - np.maximum(low, 0.02 * value)
    above = np.minimum(high, 50.0 * value) - value
    return np.maximum(np.stack([below, above]), 0.0)


def _frame(x: str, y: str) -> tuple[Figure, Axes]:
    """A figure with logarithmic axes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.5, 4.6), layout="constrained")
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(which="both", linewidth=0.25)
    return figure, axes


def to_svg(figure: Figure) -> str:
    """The figure as an <svg> element that asks for nothing outside of itself."""
    from matplotlib import rc_context

    text = io.StringIO()
    with rc_context({"svg.hashsalt": "nephroid", "svg.fonttype": "path"}):
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    svg = text.getvalue()
    start = svg.index("<svg")
    # The metadata names vocabularies by their addresses; a page needs none of it.
    head, _, rest = svg[start:].partition("<metadata>")
    return head + rest.partition("</metadata>")[2] if rest else head
