"""A study's runs are those of a rendering, and its bins those of its photons."""

import dataclasses

import numpy as np
import pytest

import sim
from sim.settings import RenderSettings
from sim.study.glass_chain import bin_chain, find_chain, select_chain
from sim.study.setup import RESULTS, Setup
from sim.study.workshop import Workshop

PHOTONS = 20_000


@pytest.fixture(scope="module")
def workshop():
    return Workshop(threads=2, rows=4)


@pytest.fixture(scope="module")
def setup(small_scene, workshop):
    settings = RenderSettings(photons=PHOTONS, passes=2, radius=0.05, threads=2)
    made = Setup(small_scene, settings.resolved(small_scene))
    batch = workshop.trace(made, workshop.lamps(made, 0), 0, 0)
    workshop.chain = find_chain(small_scene, batch, cells=6, bands=2)
    return made


def test_rows_are_those_of_the_whole_picture(workshop, setup, small_scene):
    sample = workshop.run(setup, 7, ("picture",))
    picture = sim.render(small_scene, dataclasses.replace(setup.settings, seed=7))
    rows = workshop.exposed_rows(small_scene.film)
    # Four of eight rows, in the middle of each pair: (0.5, 1.5, …) · 8/4.
    np.testing.assert_array_equal(rows, [1, 3, 5, 7])
    np.testing.assert_allclose(sample.xyz, picture.xyz[rows], rtol=1e-12, atol=0.0)
    assert sample.irradiance is None
    # Kernels of another build add in another order: some ulps of what roulette leaves out.
    assert sample.books.totals == pytest.approx(picture.energy.totals, rel=1e-12)


def test_a_film_used_before_leaves_no_trace(workshop, setup):
    first = workshop.run(setup, 8, ("picture",))
    workshop.run(setup.with_settings(radius=0.2), 9, ("picture",))
    again = workshop.run(setup, 8, ("picture",))
    np.testing.assert_array_equal(first.xyz, again.xyz)
    np.testing.assert_array_equal(first.bias, again.bias)


def test_another_camera_seed_changes_the_picture_but_not_the_photons(workshop, setup):
    one = workshop.run(setup, 8, RESULTS, camera_seed=1)
    other = workshop.run(setup, 8, RESULTS, camera_seed=2)
    np.testing.assert_array_equal(one.irradiance, other.irradiance)
    assert not np.array_equal(one.xyz, other.xyz)


def test_the_chain_is_the_light_through_the_ball(workshop, setup):
    chain = workshop.chain
    assert (chain.emitter, chain.receiver, chain.refractions, chain.side) == ("lamp", "floor", 2, 0)
    batch = workshop.trace(setup, workshop.lamps(setup, 3), 3, 0)
    photons = batch.to_numpy()
    kept = (photons["refractions"] == 2) & (photons["reflections"] == 0)
    kept &= (photons["bounces"] == 0) & (photons["object"] == 1)
    chosen = select_chain(batch, chain)
    assert len(chosen.slots) == np.count_nonzero(kept) > 0
    # The same by another way of binning; sums in another order differ by rounding alone, but
    # photons at an edge in single precision may change their band.
    found = bin_chain(chosen, chain)
    expected = chain.bins.bin_photons({k: v[kept] for k, v in photons.items()}, chain.edges_nm)
    assert np.mean(np.isclose(found, expected, rtol=1e-9, atol=0.0)) > 0.95
    assert found.sum() == pytest.approx(expected.sum(), rel=1e-6)


def test_gathering_over_a_bin_gives_what_is_in_it(workshop, setup):
    # The same photons: a narrow kernel asked at 4 points a bin leaves sampling noise alone. All
    # bins together hold the flux of a hundred thousand kernels' worth: a few percent.
    by_bins = workshop.run(setup, 5, ("bins",))
    by_gather = workshop.run(dataclasses.replace(setup, estimator="gather"), 5, ("bins",))
    chain = workshop.chain
    inner = np.s_[1:-1, 1:-1]  # no kernel reaches over the caustic's edge there
    ratio = by_gather.irradiance[inner].sum() / by_bins.irradiance[inner].sum()
    assert ratio == pytest.approx(1.0, abs=0.1)
    assert by_gather.irradiance.shape == (6, 6, len(chain.edges_nm) - 1)


def test_costs_count_what_was_done_and_scale_the_gather(workshop, setup, monkeypatch):
    clock = iter(range(1000))
    monkeypatch.setattr("sim.study.sample.time.process_time", lambda: float(next(clock)))
    costs = workshop.run(setup, 6, RESULTS).costs
    # Each timed block takes one tick: the lamps and two passes; half of the rows are exposed.
    assert (costs.trace, costs.bin, costs.map, costs.gather) == (3.0, 2.0, 2.0, 4.0)
    assert costs.of("bins") == 5.0
    assert costs.of("picture") == 9.0
