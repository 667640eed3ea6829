"""`nephroid spectrum`: what it tells of a light."""

import numpy as np
import pytest
from PIL import Image

import spectra
from sim.cli import main


def told(capfd, *arguments):
    assert main(["spectrum", *arguments]) == 0
    return capfd.readouterr().out


def test_without_a_name_it_lists_them(capfd):
    assert told(capfd).strip().split(", ") == list(spectra.spectrum_names())


def test_an_illuminant_by_name(capfd):
    shown = told(capfd, "D65")
    # CIE 015:2018: x = 0.31272, y = 0.32903, 6504 K; sRGB's white is D65.
    for text in ("360 to 780 nm", "x = 0.3127, y = 0.3290", "650", "Duv +0.0032", "#ffffff"):
        assert text in shown


def test_a_lamp_tells_its_lines(capfd):
    shown = told(capfd, "sodium")
    assert "588.9950 nm, 1\n" in shown
    assert "589.5924 nm, 0.5\n" in shown
    assert "range" not in shown


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("3000K", "blackbody 3000 K"),
        ("3000K", "temperature  3000 K, Duv +0.0000"),
        ("532nm", "laser 532 nm"),
        ("532nm", "no blackbody is of about this colour"),
        ("532nm", "#00ff00 (clip"),
        ("1500nm", "the eye does not see it"),
    ],
)
def test_blackbodies_and_lasers_by_their_number(capfd, name, text):
    assert text in told(capfd, name)


@pytest.mark.parametrize("name", ["D65", "mercury", "1500nm"])
def test_it_plots(capfd, tmp_path, name):
    path = tmp_path / "plot.png"
    told(capfd, name, "-o", str(path))
    with Image.open(path) as image:
        assert np.asarray(image).std() > 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sodum"], "unknown spectrum 'sodum'; nearest: sodium"),
        (["300OK"], "unknown spectrum '300OK'"),
        (["nanK"], "allowed: above 0"),
        (["0nm"], "allowed: above 0"),
        (["D65", "-o", "plot.pdf"], "does not end in .png or .svg"),
        (["D65", "-o", "/nowhere/plot.png"], "/nowhere"),
    ],
)
def test_what_is_wrong_is_one_message(capfd, arguments, message):
    assert main(["spectrum", *arguments]) == 2
    captured = capfd.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert message in captured.err
