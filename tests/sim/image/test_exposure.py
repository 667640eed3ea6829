"""Automatic exposure, against its definition."""

import numpy as np
import pytest

from sim.image.exposure import WHITE_QUANTILE, automatic_stops


def test_a_uniform_picture_is_developed_to_white():
    # Level 0.25 everywhere: 2**2 brings it to 1.
    assert automatic_stops(np.full((4, 5, 3), 0.25)) == pytest.approx(2.0, abs=1e-12)


def test_the_largest_channel_counts_not_the_luminance():
    blue = np.zeros((4, 5, 3))
    blue[..., 2] = 0.125
    assert automatic_stops(blue) == pytest.approx(3.0, abs=1e-12)


def test_dark_pixels_and_a_few_bright_ones_do_not_count():
    picture = np.zeros((100, 100, 3))
    picture[:10] = 0.5
    picture[0, :5] = 1e6  # 5 of 1000 lit pixels: fewer than 1 - WHITE_QUANTILE of them.
    assert 5 / 1000 < 1.0 - WHITE_QUANTILE
    assert automatic_stops(picture) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("value", [0.0, -1.0])
def test_a_black_picture_needs_none(value):
    assert automatic_stops(np.full((2, 2, 3), value)) == 0.0


def test_the_unit_does_not_matter():
    picture = np.random.default_rng(1).exponential(1.0, (20, 30, 3))
    shifted = automatic_stops(picture * 2.0**-17) - automatic_stops(picture)
    assert shifted == pytest.approx(17.0, abs=1e-12)
