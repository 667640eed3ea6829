"""Patches of colour, by gamut mapping."""

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from sim.charts.swatches import draw_swatches, hex_code, shown_colours, to_full_brightness
from spectra.srgb import GAMUT_METHODS


def test_codes_are_written_as_style_sheets_have_them():
    assert hex_code(np.array([255, 9, 0], dtype=np.uint8)) == "#ff0900"


def test_mappings_differ_where_a_colour_is_out_of_gamut():
    inside = shown_colours([0.5, 0.5, 0.5])
    assert tuple(inside) == GAMUT_METHODS
    assert len({hex_code(codes) for codes in inside.values()}) == 1
    # Of a red of luminance 0.2126 · 1 - 0.0722 · 0.1, clipping keeps red and cuts blue; the other
    # keeps luminance, and so must add green.
    outside = shown_colours([1.0, 0.0, -0.1])
    assert hex_code(outside["clip"]) == "#ff0000"
    assert outside["desaturate"][1] > 0


def test_full_brightness_keeps_the_ratios():
    found = to_full_brightness([0.2, 0.1, -0.05])
    np.testing.assert_allclose(found, [1.0, 0.5, -0.25], rtol=1e-15)


def test_each_patch_has_its_colour_and_says_it():
    axes = Figure().add_subplot()
    colours = {"red": [1.0, 0.0, -0.1], "dark": [0.01, 0.01, 0.01]}
    draw_swatches(axes, colours)
    codes = [hex_code(code) for one in colours.values() for code in shown_colours(one).values()]
    assert [to_hex(patch.get_facecolor()) for patch in axes.patches] == codes
    assert [text.get_text() for text in axes.texts] == codes
    assert [label.get_text() for label in axes.get_xticklabels()] == list(colours)
    assert [label.get_text() for label in axes.get_yticklabels()] == list(GAMUT_METHODS)
    # The upper row is the first method's: rows count downwards.
    low, high = axes.get_ylim()
    assert low > high
    assert axes.texts[0].get_color() == "black"
    assert axes.texts[-1].get_color() == "white"


@pytest.mark.parametrize("colour", [[0.0, 0.0, 0.0], [5.0, 5.0, 5.0]])
def test_black_and_glare_can_be_shown(colour):
    draw_swatches(Figure().add_subplot(), {"": colour})
