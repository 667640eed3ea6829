"""`nephroid explain`: every feature, why it is on or off, and what that can cost."""

import dataclasses
import json
import subprocess
import sys

import pytest

import sim.feature_costs
from sim.canary import CanaryReport
from sim.cli import main
from sim.features import null, registered, registry


def rows(text):
    """The table: feature, on or off, bound, time and why; the first two lines are heads."""
    names = {one.name for one in registered()}
    found = {}
    for line in text.splitlines()[2:]:
        name = line[2:22].strip()
        if line.startswith("  ") and name in names:
            on, bound = line[23:].split()[:2]
            found[name] = on, float(bound), line
    return found


def explain(capsys, *arguments, status=0):
    assert main(["explain", *arguments]) == status
    return capsys.readouterr()


def test_all_features_are_listed_with_their_reasons(capsys):
    output = explain(capsys, "prism").out
    assert output.startswith("prism: White light through a prism\n")
    table = rows(output)
    assert list(table) == [one.name for one in registered()]
    assert table["spheres"][:2] == ("off", 0.0)
    assert table["spheres"][2].endswith(" no sphere")
    assert table["polyhedra"][:2] == ("on", 1.0)
    assert table["polyhedra"][2].endswith(" 1 polyhedron")
    assert table["dispersion"][0] == "on"
    assert table["undispersed photons"][0] == "off"
    assert "their bounds add up to 0 of the tolerated 1e-06" in output
    assert "recorded on" in output
    for one in registered():
        if one.cost is not None:
            assert f"{one.cost.ratio:.2f} ({one.cost.scene})" in table[one.name][2]


def test_what_is_left_out_at_a_price_is_in_the_sum(capsys, tmp_path, small_scene):
    text = small_scene.source_text.replace(
        'medium = "N-BK7"',
        'medium = {type = "table", wavelength_nm = [300, 900], eta = [1.5, 1.5000000001]}',
    )
    (tmp_path / "table.toml").write_text(text, encoding="utf-8")
    # The film has 320 nm of the table's 600: Δ = 320/600 · 1e-10/1.5 = 3.6e-11.
    output = explain(capsys, str(tmp_path / "table.toml"), "--tolerance", "0.01").out
    on, bound, line = rows(output)["dispersion"]
    assert on == "off"
    assert 1e-5 < bound < 1e-2
    assert line.endswith(" indices vary by 3.6e-11 over the film's range")
    assert f"add up to {bound:.2g} of the tolerated 0.01" in output
    refused = explain(capsys, str(tmp_path / "table.toml")).out
    assert rows(refused)["dispersion"][0] == "on"
    assert "refused" in rows(refused)["dispersion"][2]


def test_single_precision_is_the_users_choice(capsys):
    on, bound, line = rows(explain(capsys, "ball", "--precision", "float32").out)[
        "double precision"
    ]
    assert (on, 0.0 < bound <= 1.0) == ("off", True)
    assert "float32" in line


def test_it_loads_no_warp_to_explain():
    script = (
        "import sys; from sim.cli import main; main(['explain', 'lens']);"
        "print('warp' in sys.modules, 'matplotlib' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "False False"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nowhere"], "nowhere"),
        (["prism", "--tolerance", "nan"], "omission_tolerance"),
        (["prism", "--tolerance", "-1"], "omission_tolerance"),
        (["prism", "--tolerance", "much"], "--tolerance"),
        (["prism", "--device", "gpu"], "device"),
        (["prism", "--check", "--device", "cuda:77"], "cuda:77"),
    ],
)
def test_bad_input_is_one_message(capsys, arguments, message):
    errors = explain(capsys, *arguments, status=2).err
    assert errors.startswith("nephroid: error: ")
    assert message in errors


@pytest.fixture
def small_file(tmp_path, small_scene):
    path = tmp_path / "small.toml"
    path.write_text(small_scene.source_text, encoding="utf-8")
    return str(path)


def test_the_canary_is_sent_when_asked_for(capsys, small_file):
    output = explain(capsys, small_file, "--check").out
    # Next to the 1e-12 of rounding, that of Stokes vectors, of photons and of camera paths, which a
    # ball does not need.
    line = output.splitlines()[-1]
    assert line.startswith("canary: 1000 photons differ by ")
    assert line.endswith(" from those of the full kernel; allowed: 1e-12")
    assert float(line.split()[5]) < 1e-15


def test_a_breach_is_an_exit_status(capsys, monkeypatch, small_file):
    wrong = dataclasses.replace(registry._registered["spheres"], judge=lambda _: null("by mistake"))
    monkeypatch.setitem(registry._registered, "spheres", wrong)
    output = explain(capsys, small_file, "--check", status=1)
    line = output.out.splitlines()[-1]
    assert line.startswith("canary: 1000 photons differ by ")
    assert float(line.split()[5]) > 0.1


def test_measured_times_take_the_place_of_recorded_ones(capsys, monkeypatch, small_file):
    def measured(plan, scene, settings, *, device):
        assert (scene.title[:7], settings.precision, device) == ("A small", "float64", "cpu")
        return {"tables": 1.25, "full photon kernel": 1.5}

    monkeypatch.setattr(sim.feature_costs, "measure_costs", measured)
    output = explain(capsys, small_file, "--measure").out
    assert " 1.25 " in rows(output)["tables"][2]
    assert " – " in rows(output)["spheres"][2]
    assert "measured here, on this scene" in output
    assert "full photon kernel: 1.50 of the time of the one that the scene requires\n" in output


def test_a_report_says_what_was_allowed():
    report = CanaryReport(1500, 2.5e-7, 1e-6)
    assert "1500 photons differ by 2.5e-07" in str(report)
    assert str(report).endswith("allowed: 1e-06")
    assert json.dumps(dataclasses.asdict(report))
