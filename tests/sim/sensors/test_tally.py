"""What passes add up to, and that thinned rays stand for all of them."""

import numpy as np
import pytest

import scenes
from sim.sensors.pass_crossings import PassCrossings
from sim.sensors.ray_store import RayStore
from sim.sensors.replicates import Replicates
from sim.sensors.sensor_bank import SensorBank
from sim.sensors.tally import SensorTally

SHAPE = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0))


def make_rays(rng, count, sensor=0):
    return {
        "sensor": np.full(count, sensor, dtype=np.int32),
        "flux": rng.exponential(1.0, count),
        "lot": rng.random(count, dtype=np.float32),
    }


def test_replicates_have_the_mean_and_its_error():
    values = np.random.default_rng(1).normal(3.0, 2.0, (9, 4, 5))
    found = Replicates.of_shape((4, 5))
    assert np.isnan(found.standard_error).all()
    for one in values:
        found.add(one)
    np.testing.assert_allclose(found.mean, values.mean(axis=0), rtol=1e-14)
    # σ/√n, σ with n − 1.
    expected = values.std(axis=0, ddof=1) / np.sqrt(9)
    np.testing.assert_allclose(found.standard_error, expected, rtol=1e-13)


def test_rays_with_room_are_all_kept():
    rng, store = np.random.default_rng(2), RayStore(1000)
    passes = [make_rays(rng, 100) for _ in range(4)]
    for one in passes:
        store.add(one)
    rays = store.rays()
    assert (store.kept, store.crossings, len(rays["flux"])) == (1.0, 400, 400)
    # A pass's flux is all of the light: the mean over the passes is a quarter of each.
    np.testing.assert_allclose(rays["flux"], np.concatenate([one["flux"] for one in passes]) / 4)
    np.testing.assert_array_equal(rays["pass_index"], np.repeat(np.arange(4), 100))
    assert rays["flux"].sum() == pytest.approx(float(store.flux.mean), rel=1e-14)


def test_a_pass_without_rays_counts_as_one():
    store = RayStore(10)
    store.add({})
    store.add(make_rays(np.random.default_rng(3), 5))
    assert store.flux.count == 2
    assert store.rays()["flux"].sum() == pytest.approx(float(store.flux.mean), rel=1e-14)
    assert np.all(store.rays()["pass_index"] == 1)


def test_thinned_rays_are_few_enough_and_carry_the_flux_of_all(assert_mean):
    rng, ratios = np.random.default_rng(4), []
    for _ in range(64):
        store = RayStore(300)
        for _ in range(5):
            store.add(make_rays(rng, 450))
        rays = store.rays()
        assert 0 < len(rays["flux"]) <= 300
        assert np.all(rays["lot"] < store.kept)
        assert store.crossings == 2250
        ratios.append(rays["flux"].sum() / float(store.flux.mean))
    assert_mean(ratios, 1.0)
    assert np.std(ratios) < 0.2


def test_what_is_kept_does_not_depend_on_how_passes_came():
    rng = np.random.default_rng(5)
    passes = [make_rays(rng, 400) for _ in range(3)]
    gradual, at_once = RayStore(200), RayStore(200)
    for one in passes:
        gradual.add(one)
    at_once.add({name: np.concatenate([one[name] for one in passes]) for name in passes[0]})
    np.testing.assert_array_equal(gradual.rays()["lot"], at_once.rays()["lot"])


def make_tally():
    sensors = (
        scenes.IrradianceSensor(name="bins", shape=SHAPE, pixels=(3, 2), bands=2),
        scenes.RaySensor(name="rays", shape=SHAPE),
    )
    return SensorTally(
        SensorBank(None, sensors, (slice(0, 12), slice(12, 12)), np.array([400.0, 700.0]))
    )


def test_each_sensor_gets_its_own():
    rng, tally = np.random.default_rng(6), make_tally()
    passes = [PassCrossings(rng.exponential(1.0, 12), make_rays(rng, 7, 1)) for _ in range(5)]
    for one in passes:
        tally.add(one)
    fluxes = np.array([one.flux for one in passes])
    np.testing.assert_allclose(tally.bins.mean, fluxes.mean(axis=0))
    cells = fluxes.reshape(5, 2, 3, 2).sum(axis=3)
    np.testing.assert_allclose(tally.cells[0].mean, cells.mean(axis=0))
    error = cells.std(axis=0, ddof=1) / np.sqrt(5)
    np.testing.assert_allclose(tally.cells[0].standard_error, error)
    np.testing.assert_allclose(tally.totals.mean, [fluxes.sum(axis=1).mean(), 0.0])
    assert tally.stores[1].crossings == 35
    accuracy = tally.accuracy()
    assert (accuracy.replicates, accuracy.relative_bias) == (5, 0.0)
    # Of cells of value v and error e, both over their mean: e/(v + 1), root mean square.
    total = np.array([one.rays["flux"].sum() for one in passes])
    v = np.append(cells.mean(axis=0).ravel() / cells.mean(), 1.0)
    e = np.append(error.ravel() / cells.mean(), total.std(ddof=1) / np.sqrt(5) / total.mean())
    expected = np.sqrt(np.mean((e / (v + v.mean())) ** 2))
    assert accuracy.relative_error == pytest.approx(expected, rel=1e-12)


def test_in_the_dark_there_is_nothing_to_be_sure_of():
    tally = make_tally()
    for _ in range(2):
        tally.add(PassCrossings(np.zeros(12), {}))
    assert tally.accuracy().relative_error == 0.0
