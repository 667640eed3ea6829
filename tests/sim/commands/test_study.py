"""`nephroid study` from end to end, on a small scene: its files, its report, its errors."""

import dataclasses
import os
import re
from html.parser import HTMLParser

import pytest

from sim.cli import main
from sim.study import plan
from sim.study.outcome import PLAIN_LADDER
from sim.study.table import COLUMNS, read_csv

AXES = ("photons", "passes", "estimator", PLAIN_LADDER)
TINY = dataclasses.replace(
    plan.QUICK, replicates=3, rows=4, cells=4, bands=2, axes=AXES,
    points_s=8.0, mesh_s=0.0, bins_s=0.0, picture_s=0.0,
)


@pytest.fixture(scope="module")
def study(tmp_path_factory, small_scene):
    """The folder after a study, and what it wrote to stdout and stderr."""
    folder = tmp_path_factory.mktemp("study")
    text = small_scene.source_text.replace("[render]", "[render]\nradius = 0.05")
    (folder / "bench.toml").write_text(text, "utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plan, "QUICK", TINY)
        patch.setattr("sim.study.references.PASS_PHOTONS", 20_000)
        patch.chdir(folder)
        assert main(["study", "bench.toml", "--quick", "--seed", "11", "--threads", "2"]) == 0
    return folder / "bench-study"


@pytest.fixture(scope="module")
def rows(study):
    return read_csv((study / "study.csv").read_bytes())


def test_the_folder_holds_the_two_files(study):
    assert sorted(os.listdir(study)) == ["study.csv", "study.html"]


def test_the_table_has_a_row_a_point_and_result(rows):
    points = [(row["result"], row["axis"], row["value"]) for row in rows]
    assert len(set(points)) == len(points)
    assert {axis for _, axis, _ in points} == {"centre", *AXES}
    # Bins alone are measured for the estimator.
    assert {result for result, axis, _ in points if axis == "estimator"} == {"bins"}
    for row in rows:
        assert set(row) == set(COLUMNS)
        assert row["scene"] == "bench"
        value, low, high = (float(row[f"error{end}"]) for end in ("", "_low", "_high"))
        assert 0.0 <= low <= value <= high
        assert float(row["cpu_s"]) > 0.0
        assert int(row["replicates"]) == (1 if row["value"].startswith("mesh") else 3)
        if row["replicates"] == "3":
            assert abs(float(row["energy_residual"])) < 1e-12
    assert all(text for text in COLUMNS.values())


def test_costs_and_multiples_fit_together(rows):
    centre = next(row for row in rows if row["axis"] == "centre" and row["result"] == "picture")
    parts = [float(centre[f"{part}_cpu_s"]) for part in ("tracing", "mapping", "gathering")]
    assert float(centre["cpu_s"]) == pytest.approx(sum(parts), rel=1e-4)
    assert float(centre["passes_of_default"]) == 1.0  # the scene's own
    four = next(row for row in rows if row["value"] == "×4" and row["result"] == "picture")
    assert int(four["photons"]) == 4 * int(centre["photons"])


def test_errors_fall_with_photons_and_are_those_of_noise(rows):
    # Sixteen and sixty-four times the photons: error falls at least as N^-0.4 in the long run.
    found = {row["value"]: row for row in rows if row["axis"] == "photons"
             and row["result"] == "bins"}
    few, many = (float(found[value]["error"]) for value in ("×1/16", "×4"))
    assert many < 64.0**-0.4 * few
    noise, error = float(found["×1/16"]["noise"]), float(found["×1/16"]["error"])
    assert noise == pytest.approx(error, rel=0.3)


def test_the_estimators_agree_up_to_their_errors(rows):
    # The mesh is certain, and coarse; the gather blurs the caustic, a tenth of a metre wide.
    found = {row["value"]: row for row in rows if row["axis"] == "estimator"}
    assert float(found["gather"]["error"]) < 0.5
    mesh = found["mesh 16²"]
    assert float(mesh["noise"]) == 0.0
    assert float(mesh["error"]) < 0.2


class References(HTMLParser):
    """Whatever a page refers to."""

    def __init__(self):
        super().__init__()
        self.found, self.tags = [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.found += [v for name, v in attrs if name in ("src", "href", "xlink:href") and v]


def test_only_the_axes_asked_for_are_measured(study, monkeypatch):
    asked = []

    def run_study(scene, plan, **_):
        asked.append(plan.axes)
        raise KeyboardInterrupt

    monkeypatch.chdir(study.parent)
    monkeypatch.setattr("sim.study.study.run_study", run_study)
    for extra in ([], ["--axes", "photons, photons × passes"]):
        assert main(["study", "bench.toml", "-o", "other", *extra]) == 130
    assert asked == [None, ("photons", "photons × passes")]


def test_the_page_is_whole_and_needs_nothing_else(study):
    text = (study / "study.html").read_text("utf-8")
    page = References()
    page.feed(text)
    assert page.found  # figures refer to their own glyphs
    assert all(one.startswith("#") for one in page.found)
    assert not {"script", "link", "img", "iframe", "object"} & set(page.tags)
    # Names of XML's vocabularies are no addresses to fetch; nothing else may look like one.
    assert set(re.findall(r'https?://[^"\s<)]+', text)) <= {
        "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
    }
    assert not re.search(r"url\((?!#)", text)
    assert page.tags.count("svg") == 6
    for heading in ("The Pareto set", "Noise and bias", "Each axis at equal time",
                    "Random, unaimed, roulette"):
        assert heading in text
    for phrase in ("CPU time", "compiling is not", "a reference, ", "turn up", "times the photons"):
        assert phrase in text
    # References this short err more than a tenth of the smallest error, and the page says so.
    assert 'class="warning"' in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nowhere.toml"], "nowhere.toml"),
        (["bench.toml", "-o", "no/such/folder"], "no/such/folder"),
        (["bench.toml", "-o", "bench.toml"], "bench.toml"),
        (["bench.toml", "--threads", "0"], "threads"),
        (["dark.toml"], "emitters"),
        (["bench.toml", "-o", "taken"], "study.csv"),
        (["bench.toml", "--axes", "photons,colour"], "axes: 'colour'"),
    ],
)
def test_what_cannot_be_done_is_told_in_a_line(study, capfd, monkeypatch, arguments, message):
    monkeypatch.chdir(study.parent)
    text = (study.parent / "bench.toml").read_text("utf-8")
    (study.parent / "dark.toml").write_text(text.partition("[[emitters]]")[0], "utf-8")
    (study.parent / "taken" / "study.csv").mkdir(parents=True, exist_ok=True)
    # It is told before any work.
    monkeypatch.setattr("sim.study.study.run_study", lambda *_, **__: pytest.fail("it ran"))
    before = sorted(os.listdir(study.parent))
    assert main(["study", *arguments, "--quick"]) == 2
    error = capfd.readouterr().err
    assert error.startswith("nephroid: error: ")
    assert message in error
    assert "Traceback" not in error
    assert sorted(os.listdir(study.parent)) == before
