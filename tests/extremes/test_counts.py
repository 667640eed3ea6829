"""Numbers of photons at their extremes, without tracing them all: indices, slots, sums."""


import numpy as np
import pytest

import scenes
from sim.errors import SettingsError
from sim.photons import tracing
from sim.photons.energy import EnergyBooks
from sim.photons.lamps import Stream
from sim.sampling.counter import fold_key
from sim.settings import RenderSettings
from sim.stopwatch import Stopwatch

LARGEST_PASS = 2**28


def floor_scene():
    """Tracing it takes kernels that other tests compile, too."""
    return scenes.load("ball")


@pytest.mark.parametrize("photons", [0, -1, LARGEST_PASS + 1, 2**31, 2**63, 1.5, True])
def test_passes_of_no_or_too_many_photons_are_refused(photons):
    with pytest.raises(SettingsError, match="allowed: a whole number from 1 to 268435456"):
        RenderSettings(photons=photons)


def test_progress_tells_of_two_billion_photons_and_one():
    # What is counted on the host, range by range, as tracing cuts them; no photon is traced.
    # 2³¹ + 1 = 3 · 715,827,883 = … in passes of 2²⁸ at most: nine, of 238,609,294 and a bit.
    total = 2**31 + 1
    passes = 9
    photons = -(-total // passes)
    plan = RenderSettings(photons=photons, passes=passes).resolved(floor_scene())
    assert plan.photons * plan.passes >= total
    told = []
    watch = Stopwatch(plan, told.append)
    for _ in range(passes):
        for _, count in tracing.cut_ranges(photons, tracing.RANGE_SIZE):
            watch.photons_done += count
    watch.report()
    assert told[-1].photons_done == told[-1].photons_total == passes * photons > 2**31


@pytest.mark.parametrize("photons", [1, 7, 10**6, 89_478_485, 89_478_486, LARGEST_PASS])
def test_every_photon_of_a_pass_has_its_place(photons):
    # Kernels hold slots and indices in 32 bits. Two streams, of which the second has one photon.
    streams = [Stream(0, 0, photons), Stream(1, 2, 1)]
    shares, slots = tracing._share_out(streams, tracing.RANGE_SIZE)
    assert slots < 2**31
    starts = np.array([share.start for share in shares])
    counts = np.array([share.count for share in shares])
    rows = np.array([share.stream_row for share in shares])
    firsts = np.array([share.first_slot for share in shares])
    rooms = np.array([share.slot_count for share in shares])
    assert counts[rows == 0].sum() == photons
    np.testing.assert_array_equal(starts[rows == 0][1:], np.cumsum(counts[rows == 0])[:-1])
    # The slots follow on one another, and there is room for one deposit a photon at least.
    np.testing.assert_array_equal(firsts, np.concatenate([[0], np.cumsum(rooms)[:-1]]))
    assert np.all(rooms >= counts)
    assert slots == rooms.sum()


def test_a_pass_that_leaves_more_than_can_be_stored_says_so():
    shares, _ = tracing._share_out([Stream(0, 0, LARGEST_PASS)], 2**27)
    counts = np.full((2, 3), 2**30 + 1, dtype=np.int32)
    with pytest.raises(SettingsError, match=r"photons: 268435456 .* at most about 268435455"):
        tracing._make_room(shares, counts)
    counts[1] = 2**30 - 3
    assert tracing._make_room(shares, counts) == 2**31 - 2


def test_the_last_photons_of_the_largest_pass_are_as_good_as_the_first(monkeypatch, trace_passes):
    # Of each stream of 2²⁸ photons only the last 512 are traced, and of one of 2²⁰: each carries
    # its share of the flux, and no two are the same.
    def last(total, size):
        return [(total - 512, 512)] if total >= 512 else []

    monkeypatch.setattr(tracing, "cut_ranges", last)
    scene = floor_scene()
    few = trace_passes(scene, photons=2**20)
    many = trace_passes(scene, photons=LARGEST_PASS)
    for traced in (few, many):
        (photons,), (books,) = traced.photons, traced.books
        for name in ("position", "direction", "flux", "wavelength_nm"):
            assert np.all(np.isfinite(photons[name]))
        spent = books.deposited + books.absorbed + books.escaped + books.culled
        assert spent == pytest.approx(books.emitted, rel=1e-12)
        # Those that leave one lamp in one direction, but in another colour, can end in one place.
        whole = np.column_stack([photons["position"], photons["wavelength_nm"], photons["flux"]])
        assert len(np.unique(whole, axis=0)) == len(whole) > 100
    # The more photons in all, the less each; streams share a pass nearly in the same ratio.
    ratio = few.books[0].emitted / many.books[0].emitted
    assert ratio == pytest.approx(LARGEST_PASS / 2**20, rel=0.2)


def test_keys_of_all_passes_differ():
    # Passes at most 2²⁰, a few streams each: a sample of those at the ends.
    passes = [*range(5000), *range(2**20 - 5000, 2**20)]
    keys = {fold_key(2**63 - 1, one, stream) for one in passes for stream in range(4)}
    assert len(keys) == 4 * len(passes)


def test_books_of_a_million_passes_lose_no_digits():
    one = EnergyBooks(emitted=1.0, deposited=0.3, absorbed=0.2, escaped=0.4, culled=0.1)
    mean = EnergyBooks.mean([one] * 2**16)
    assert mean.emitted == 1.0
    assert mean.deposited == 0.3  # 2¹⁶ of it are as exact as one
    rows = np.tile([1e-9, 3e-10, 2e-10, 4e-10, 1e-10], (10**6, 1))
    total = EnergyBooks.from_rows(rows)
    # Columns are added up exactly and rounded once, as this product is.
    assert total.totals == tuple(1e6 * term for term in rows[0])
    # u = 2⁻⁵³ for each of: a term and its sum, emitted and spent, 4 u; three additions; the ratio.
    assert abs(total.residual) <= 8 * 2.0**-53
