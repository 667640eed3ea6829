"""A photon's random numbers: each is used for one thing."""

import itertools

import pytest

from sim import RenderSettings
from sim.errors import SettingsError
from sim.photons.photon_path import COLOURS
from sim.sampling import draws

GOLDEN = 0x9E3779B97F4A7C15
"""What a counter is multiplied by, see `sim.sampling.counter`."""

MOST_PHOTONS, MOST_INTERACTIONS = 2**28, 2**16
OFFSETS = {
    name: int(getattr(draws, name)) for name in draws.__all__ if name != "first_draw"
}


def test_the_limits_are_those_of_the_settings():
    for field, most in (("photons", MOST_PHOTONS), ("max_interactions", MOST_INTERACTIONS)):
        RenderSettings(**{field: most})
        with pytest.raises(SettingsError):
            RenderSettings(**{field: most + 1})


def test_surfaces_and_colours_have_room_below_the_next_photon():
    assert MOST_INTERACTIONS <= 2**17
    assert int(COLOURS) * 2**17 <= 2**24


@pytest.mark.parametrize("pair", [*itertools.combinations(OFFSETS, 2)], ids=str)
def test_no_two_purposes_share_a_number(pair):
    # key + d + G (c + 1) = key + d' + G (c' + 1) modulo 2⁶⁴ means c − c' = (d' − d) G⁻¹.
    one, other = (OFFSETS[name] for name in pair)
    apart = (one - other) * pow(GOLDEN, -1, 2**64) % 2**64
    assert min(apart, 2**64 - apart) > MOST_PHOTONS * 2**24
