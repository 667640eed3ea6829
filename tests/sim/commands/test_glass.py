"""`nephroid glass`: what it tells of media and metals."""

import numpy as np
import pytest
from PIL import Image

import spectra
from sim.cli import main


def told(capfd, *arguments):
    assert main(["glass", *arguments]) == 0
    return capfd.readouterr().out


def test_without_a_name_it_lists_them(capfd):
    shown = told(capfd)
    for name in (*spectra.glasses(), *spectra.conductors()):
        assert name in shown


@pytest.mark.parametrize("name", spectra.glasses())
def test_it_tells_what_is_known_of_a_medium(capfd, name):
    shown = told(capfd, name)
    medium = spectra.glass(name)
    for text in (
        name, medium.source, medium.relative_to, f"{medium.n_d:.6f}", f"{medium.abbe_number:.2f}"
    ):  # fmt: skip
        assert text in shown
    assert ("not published here" in shown) == (name not in spectra.absorbing_media())


@pytest.mark.parametrize("thickness", ["25mm", "2.5cm", "0.025m", "0.025"])
def test_it_tells_the_internal_transmittance_of_a_thickness(capfd, thickness):
    shown = told(capfd, "SF11", "--thickness", thickness)
    absorption = spectra.published_absorption("SF11")
    assert "through 25 mm" in shown
    assert f"at d       {absorption.transmittance(587.5618, 0.025):.4f}\n" in shown
    assert absorption.source in shown
    assert "sRGB #" in shown


@pytest.mark.parametrize("name", spectra.conductors())
def test_it_tells_what_is_known_of_a_metal(capfd, name):
    shown = told(capfd, name)
    metal = spectra.conductor(name)
    eta, k = metal.eta(587.5618), metal.k(587.5618)
    # R = ((η - 1)² + k²)/((η + 1)² + k²).
    reflectance = ((eta - 1.0) ** 2 + k**2) / ((eta + 1.0) ** 2 + k**2)
    for text in (name, metal.source, f"{eta:.4f} + {k:.4f}i, reflects {reflectance:.4f}"):
        assert text in shown


@pytest.mark.parametrize("name", ["SF11", "diamond", "gold"])
def test_it_plots(capfd, tmp_path, name):
    path = tmp_path / "plot.png"
    told(capfd, name, "-o", str(path))
    with Image.open(path) as image:
        assert np.asarray(image).std() > 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["BK9"], "unknown glass 'BK9'; nearest: N-BK7"),
        (["gould"], "nearest: gold"),
        (["SF11", "--thickness", "0"], "is not above 0"),
        (["SF11", "--thickness", "nan"], "is not above 0"),
        (["SF11", "--thickness", "2km"], "invalid length value: '2km'"),
        (["SF11", "--thickness", "thick"], "invalid length value: 'thick'"),
    ],
)
def test_what_is_wrong_is_one_message(capfd, arguments, message):
    assert main(["glass", *arguments]) == 2
    captured = capfd.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert message in captured.err
