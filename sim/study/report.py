"""The study as one page that needs nothing else: figures, tables and advice."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from sim.study.advice import advise
from sim.study.expected_slope import expected_slope
from sim.study.figures import draw_effects, draw_front, draw_parts, to_svg
from sim.study.findings import effects, saving, slopes
from sim.study.outcome import REFERENCE_SHARE, Outcome, Row
from sim.study.setup import RESULTS, ResultKind
from sim.study.statistics import Interval
from sim.study.table import COLUMNS
from sim.version import VERSION

__all__ = ["encode_html"]

_HEADINGS: dict[ResultKind, str] = {
    "bins": "Irradiance on a receiver, in exact bins", "picture": "The picture"
}
_TEMPERED = "as --target-error counts it"
_THEORY = (
    "Theory: a bin is an indicator over d sampled dimensions, and scrambled low-discrepancy points "
    "leave it an error of the order N^(-1/2 - 1/(2d)) (He and Wang 2015, SIAM J. Numer. Anal. 53, "
    "2488), once bins or gather discs hold many photons; while they hold few, errors fall as those "
    "of random points do, as N^-1/2. A pair of dimensions is a direction or a place on the lamp, "
    "one is the wavelength. Error holds the bias too, which no photons lower."
)
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; font-size: 13px; margin: 1em 0; }
td, th { border-bottom: 1px solid #ccc; padding: 2px 8px; text-align: right; }
td:first-child, th:first-child { text-align: left; }
svg { max-width: 100%; height: auto; }
.warning { background: #fff3cd; padding: 0.5em 1em; }
"""


def encode_html(outcome: Outcome) -> bytes:
    """The page, UTF-8."""
    title = f"Speed for accuracy: {outcome.title or outcome.scene}"
    parts = [
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style></head><body><h1>{escape(title)}</h1>",
        *(_paragraph(text) for text in _preface(outcome)),
    ]
    for result in RESULTS:
        if result in outcome.references:
            parts += _section(outcome, result)
    if "bins" not in outcome.references:
        parts.append(_paragraph(outcome.bins_text))
    parts.append("<h2>Columns of study.csv</h2>")
    parts.append(_table(("column", "what it holds"), COLUMNS.items()))
    parts.append("</body></html>\n")
    return "\n".join(parts).encode("utf-8")


def _preface(outcome: Outcome) -> list[str]:
    """What was done, and how time and errors are counted."""
    centre = outcome.rows[0]
    kind = "A quick study" if outcome.plan.quick else "A full study"
    return [
        f"{kind} of the scene '{outcome.scene}' with Nephroid {VERSION}; it took "
        f"{outcome.cpu_s:.0f} CPU-seconds. Its centre has {centre.photons:,} photons in each of "
        f"{centre.passes} passes: {_multiple(outcome.scale)} of the scene's own photons, and its "
        "own passes. One axis at a time is varied around it, and photons and passes together.",
        "Time is CPU time of the whole process over all threads, spent on tracing (its pilot "
        "included), the photon map and the gather, or on tracing and binning; compiling is not "
        f"counted. Of the picture, {outcome.coverage:.2g} of the rows were exposed, spread evenly "
        "over its height, and the gather's time is multiplied to that of the whole picture.",
        f"Every point was run {outcome.plan.replicates} times, with seeds that nothing else uses. "
        "Intervals hold the true value with probability 95%: Student's t over the replicates, and "
        "of slopes over the residuals of the fit. Noise is the replicates' scatter; bias is what "
        "they share, by products of different replicates, so that noise does not count as bias.",
    ]


def _section(outcome: Outcome, result: ResultKind) -> list[str]:
    """All about one result."""
    parts = [f"<h2>{_HEADINGS[result]}</h2>"]
    if result == "bins":
        parts.append(_paragraph(
            outcome.bins_text + ". A mesh's time includes the coarser ones that tell its error."
        ))
    parts += [f"<ul>{''.join(f'<li>{escape(one)}</li>' for one in advise(outcome, result))}</ul>"]
    parts += _about_reference(outcome, result)
    parts += ["<h3>Error against time</h3>", to_svg(draw_front(outcome, result)),
              "<h3>The Pareto set</h3>", _pareto_table(outcome.pareto(result), outcome),
              _paragraph("Of photons and passes alone, all else as in the centre:"),
              _pareto_table(outcome.pareto(result, amounts_only=True), outcome),
              "<h3>Noise and bias</h3>", to_svg(draw_parts(outcome, result)),
              _slope_table(outcome, result)]
    if saving(outcome, result):
        parts += ["<h3>Random, unaimed, roulette</h3>", _paragraph(
            "Photons that this method needs, as a multiple of those of Sobol points, aiming and "
            "branch weights, for the same error. Its photons are independent, so that its error² "
            "is c/N exactly; c is measured. Of the picture it is the photons' part, with the "
            "camera held still."), _saving_table(outcome, result)]
    parts += ["<h3>Each axis at equal time</h3>", to_svg(draw_effects(outcome, result)),
              _paragraph("error² × time relative to the centre: as many times the photons for the "
                         "same error. It holds for noise; a bias stays whatever is spent."),
              _effect_table(outcome, result)]
    return parts


def _about_reference(outcome: Outcome, result: ResultKind) -> list[str]:
    """Which reference, how its error is known, and whether it is small enough."""
    reference = outcome.references[result]
    smallest = outcome.smallest_error(result)
    text = f"Errors are measured against a reference, {reference.kind}: {reference.how}. "
    text += f"Its error is {reference.error:.2g}, of the smallest error shown, {smallest:.2g}, "
    text += f"{reference.error / smallest:.2g}. {reference.check}"
    parts = [_paragraph(text)]
    if not outcome.reference_is_good(result):
        parts.append(
            f'<p class="warning">That is more than {REFERENCE_SHARE:g}. The known noise of the '
            "reference is taken out of errors and biases; what bias it has is not. Errors of less "
            f"than {reference.error / REFERENCE_SHARE:.2g} are uncertain by it.</p>"
        )
    return parts


def _pareto_table(best: list[Row], outcome: Outcome) -> str:
    head = ("point", "photons, of the default", "passes, of the default", "CPU-seconds", "error",
            _TEMPERED)
    rows = [
        (row.name, _multiple(row.photons / outcome.default_photons),
         _multiple(row.passes / outcome.default_passes), f"{row.cpu_s.value:.3g}",
         _interval(row.errors.error), _interval(row.tempered))
        for row in best
    ]
    columns = len(head) - (best[0].result != "picture")
    return _table(head[:columns], [row[:columns] for row in rows])


def _slope_table(outcome: Outcome, result: ResultKind) -> str:
    names = {
        "error": "error against photons", "time": "error against CPU-seconds",
        "noise": "noise against photons",
        "photon noise": "noise against photons, camera held still",
    }
    expected = {"noise": "", "error": "", "photon noise": "", "time": ""}
    dimensions = outcome.dimensions.get(result)
    if dimensions is not None:
        theory = f"{expected_slope(dimensions):.3f}, by {dimensions} dimensions"
        expected |= {name: theory for name in expected if name != "time"}
    rows = [
        (names[name], _interval(law.slope), expected[name], str(law.points))
        for name, law in slopes(outcome, result).items()
    ]
    head = ("fitted power law", "slope, 95% interval", "theory", "points")
    return _table(head, rows) + _paragraph(_THEORY)


def _saving_table(outcome: Outcome, result: ResultKind) -> str:
    return _table(
        ("photons in a pass", "times the photons"),
        [(f"{photons:,}", _interval(factor)) for photons, factor in saving(outcome, result)],
    )


def _effect_table(outcome: Outcome, result: ResultKind) -> str:
    own = (_TEMPERED, "ΔE₀₀ mean", "ΔE₀₀ p95") if result == "picture" else ("centroid [″]",)
    head = ("value", "photons for the same error", "time", "noise", "bias", *own, "energy")
    centre = outcome.centre(result)
    rows = [(centre.name, "1", "1", *_measures(centre))]
    rows += [
        (one.row.name, _interval(one.ratio), f"{one.time:.3g}", *_measures(one.row))
        for one in effects(outcome, result)
    ]
    return _table(head, rows)


def _measures(row: Row) -> tuple[str, ...]:
    own: tuple[Interval, ...] = (row.centroid_arcsec,)
    if row.result == "picture":
        own = (row.tempered, row.ciede_mean, row.ciede_p95)
    return (
        _interval(row.errors.noise), _interval(row.errors.bias), *(_interval(one) for one in own),
        f"{row.energy_residual:.1g}",
    )


def _multiple(value: float) -> str:
    return f"1/{1.0 / value:g}" if 0.0 < value < 1.0 else f"{value:g}"


def _interval(interval: Interval) -> str:
    if interval.low == interval.high:
        return f"{interval.value:.3g}"
    return f"{interval.value:.3g} [{interval.low:.2g}, {interval.high:.2g}]"


def _paragraph(text: str) -> str:
    return f"<p>{escape(text)}</p>"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    top = "".join(f"<th>{escape(one)}</th>" for one in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(str(one))}</td>" for one in row) + "</tr>" for row in rows
    )
    return f"<table><tr>{top}</tr>{body}</table>"
