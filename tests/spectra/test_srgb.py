from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from spectra import (
    SpectraError,
    encode_srgb,
    luminance,
    map_to_gamut,
    observer,
    wavelength_to_srgb,
    xyz_to_linear_srgb,
)
from spectra.srgb import Gamut

METHODS: tuple[Gamut, Gamut] = ("preserve", "clip")
COLOURS = arrays.arrays(np.float64, (4, 3), elements=st.floats(-10.0, 10.0))


@pytest.mark.parametrize("nm", ["486", "532", "633"])
def test_spectral_lines_at_luminance_1(nm: str, references: dict[str, Any]) -> None:
    published = references["colour_2_degree"]["linear_srgb_of_lines_at_Y_1"][nm]
    xyz = observer().cmf[int(nm) - 360]
    # 3 decimals are printed. One unit, not half: the standard's matrix has 4 decimals, and against
    # one computed from the primaries the third decimal of 6.465 already turns.
    assert xyz_to_linear_srgb(xyz / xyz[1]).tolist() == pytest.approx(published, abs=1e-3)


def test_the_matrix_is_the_standards_inverse() -> None:
    # IEC 61966-2-1:1999/AMD1:2003, annex F: the inverse with 7 decimals.
    printed = [
        [3.2406255, -1.5372080, -0.4986286],
        [-0.9689307, 1.8757561, 0.0415175],
        [0.0557101, -0.2040211, 1.0569959],
    ]
    np.testing.assert_allclose(xyz_to_linear_srgb(np.eye(3)).T, printed, rtol=0, atol=0.6e-7)


def test_d65_white_is_white() -> None:
    # Of x, y = 0.3127, 0.3290; the standard's matrix has 4 decimals.
    white = xyz_to_linear_srgb([0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290])
    assert white.tolist() == pytest.approx([1.0, 1.0, 1.0], abs=3e-4)


@settings(deadline=None)
@given(COLOURS)
def test_luminance_is_y_again(xyz: np.ndarray[Any, np.dtype[np.float64]]) -> None:
    # Cancellation between channels of up to 33, at 1e-16 each.
    np.testing.assert_allclose(luminance(xyz_to_linear_srgb(xyz)), xyz[:, 1], rtol=0, atol=1e-13)


@settings(deadline=None)
@given(COLOURS)
def test_desaturating_keeps_luminance_and_fits(
    linear: np.ndarray[Any, np.dtype[np.float64]],
) -> None:
    mapped = map_to_gamut(linear)
    assert mapped.min() >= 0.0
    assert mapped.max() <= 1.0
    expected = np.clip(luminance(linear), 0.0, 1.0)
    np.testing.assert_allclose(luminance(mapped), expected, rtol=0, atol=1e-14)


@settings(deadline=None)
@given(COLOURS)
def test_desaturating_moves_straight_toward_grey(
    linear: np.ndarray[Any, np.dtype[np.float64]],
) -> None:
    y = luminance(linear)[:, np.newaxis]
    inside = ((y > 1e-3) & (y < 1.0 - 1e-3)).ravel()
    before = (linear - y)[inside]
    after = (map_to_gamut(linear) - y)[inside]
    # Parallel, in the same sense, no longer than before.
    np.testing.assert_allclose(np.cross(before, after), 0.0, atol=1e-12)
    assert np.all(np.sum(before * after, axis=-1) >= 0.0)
    assert np.all(np.linalg.norm(after, axis=-1) <= np.linalg.norm(before, axis=-1) + 1e-14)


def test_desaturating_stops_at_the_wall() -> None:
    # By hand: Y = 0.2126 + 0.7152 · 0.15 - 0.0722 · 0.25, and blue goes 0.25 below the wall of the
    # Y + 0.25 it is away from the grey.
    y = 0.30183
    share = y / (y + 0.25)
    expected = [y + share * (1.0 - y), y + share * (0.15 - y), 0.0]
    assert map_to_gamut([1.0, 0.15, -0.25]).tolist() == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("linear", "mapped"),
    [
        ([0.2, 0.5, 0.9], [0.2, 0.5, 0.9]),  # Inside already.
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([1.0, 1.0, 1.0], [1.0, 1.0, 1.0]),
        ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([9.0, 0.1, 0.1], [1.0, 1.0, 1.0]),  # As bright as white or brighter: white.
        ([5.0, 5.0, 5.0], [1.0, 1.0, 1.0]),
        ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]),  # Darker than black: black.
    ],
)
def test_desaturating_by_example(linear: list[float], mapped: list[float]) -> None:
    assert map_to_gamut(linear).tolist() == pytest.approx(mapped, abs=1e-15)


def test_clipping_cuts_each_channel() -> None:
    assert map_to_gamut([-0.5, 0.5, 1.5], "clip").tolist() == [0.0, 0.5, 1.0]


@pytest.mark.parametrize(
    ("linear", "mapped"),
    [
        ([0.2, 0.5, 0.9], [0.2, 0.5, 0.9]),  # Inside already.
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([9.0, 0.9, 0.0], [1.0, 0.1, 0.0]),  # Too bright alone: over the largest channel.
        ([5.0, 5.0, 5.0], [1.0, 1.0, 1.0]),
        ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0]),  # Darker than black: black.
        # Out of gamut alone: as desaturating, see above, for Y = 0.30183.
        ([1.0, 0.15, -0.25], map_to_gamut([1.0, 0.15, -0.25]).tolist()),
    ],
)
def test_preserving_by_example(linear: list[float], mapped: list[float]) -> None:
    assert map_to_gamut(linear, "preserve").tolist() == pytest.approx(mapped, abs=1e-15)


@settings(deadline=None)
@given(COLOURS)
def test_preserving_desaturates_below_and_dims_above(
    linear: np.ndarray[Any, np.dtype[np.float64]],
) -> None:
    # C' = Y + s (C - Y) with s = min(1, Y/(Y - min C)), which leaves min C' = 0, over max C' or 1.
    for colour, mapped in zip(linear, map_to_gamut(linear, "preserve"), strict=True):
        y, darkest = max(float(luminance(colour)), 0.0), float(colour.min())
        share = y / (y - darkest) if darkest < 0.0 else 1.0
        moved = y + share * (colour - y)
        expected = moved / max(float(moved.max()), 1.0)
        np.testing.assert_allclose(mapped, expected, rtol=0, atol=1e-14)


def test_preserving_keeps_the_colour_of_a_light_as_it_brightens() -> None:
    # The light of a laser, from dim to glaring: once too bright it is one colour, where
    # desaturating ends in white and clipping turns orange to yellow.
    laser = xyz_to_linear_srgb(observer().cmf[600 - 360])
    series = np.geomspace(1.0, 1e3, 7)[:, np.newaxis] * laser
    preserved, clipped = (map_to_gamut(series, method) for method in METHODS)
    np.testing.assert_allclose(preserved, np.broadcast_to(preserved[0], (7, 3)), atol=1e-14)
    assert preserved[0].max() == pytest.approx(1.0, abs=1e-15)
    assert preserved[0].max() > 2.0 * preserved[0].min() + 0.4
    assert clipped[-1].tolist() == [1.0, 1.0, 0.0]
    assert map_to_gamut(series)[-1].tolist() == pytest.approx([1.0, 1.0, 1.0])


def test_there_are_three_gamut_mappings() -> None:
    allowed = "'perceptual'; allowed: 'desaturate', 'clip', 'preserve'"
    with pytest.raises(SpectraError, match=allowed):
        map_to_gamut([0.0, 0.0, 0.0], "perceptual")  # type: ignore[arg-type]


def test_codes_are_the_standards() -> None:
    # IEC 61966-2-1, §5.2. Half-way, 0.5: 1.055 · 0.5^(1/2.4) - 0.055 = 0.735357, times 255: 187.5;
    # the foot: 0.001 · 12.92 · 255 = 3.29; 0.0031308 is where it ends, 10.3.
    linear = [-1.0, 0.0, 0.001, 0.0031308, 0.5, 0.2140411, 1.0, np.inf]
    assert encode_srgb(linear).tolist() == [0, 0, 3, 10, 188, 127, 255, 255]
    assert encode_srgb(linear).dtype == np.uint8


def test_every_code_comes_back() -> None:
    codes = np.arange(256)
    encoded = codes / 255.0
    # The inverse of §5.2: c / 12.92 up to 0.04045, then ((c + 0.055) / 1.055)^2.4.
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    np.testing.assert_array_equal(encode_srgb(linear), codes)


def test_no_code_stands_for_nan() -> None:
    with pytest.raises(SpectraError, match="1 of 3 colour values are NaN"):
        encode_srgb([0.0, np.nan, 1.0])


def test_rays_are_drawn_in_the_colours_people_expect() -> None:
    violet, blue, green, yellow, red = wavelength_to_srgb([415.0, 460.0, 530.0, 572.0, 640.0])
    assert violet[2] > violet[0] > violet[1]
    assert blue.argmax() == 2
    assert green.tolist() == pytest.approx([0.0, 1.0, 0.0])
    assert min(yellow[:2]) > 0.9
    assert yellow[2] == 0.0
    assert red.tolist() == pytest.approx([1.0, 0.0, 0.0])


def test_ray_colours_fade_but_stay_seen() -> None:
    wavelengths = np.array([np.nextafter(0.0, 1.0), 200.0, 380.0, 555.0, 750.0, 900.0, 10_600.0])
    colours = wavelength_to_srgb(wavelengths)
    assert colours.shape == (7, 3)
    assert np.all((colours >= 0.0) & (colours <= 1.0))
    brightest = colours.max(axis=-1)
    assert brightest[3] == pytest.approx(1.0)
    assert np.all((brightest[[0, 1, 2, 4, 5, 6]] > 0.5) & (brightest[[0, 1, 2, 4, 5, 6]] < 0.7))


def test_one_wavelength_is_one_colour() -> None:
    assert wavelength_to_srgb(555.0).shape == (3,)
