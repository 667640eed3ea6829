"""The energy books hold at 10⁹ photons: their error has a bound that knows no number of photons.

The bound is `sim.photons.energy`'s, with u = 2⁻⁵³ a rounding: `STEPS` surfaces of a photon, in its
books and in the flux that is shared out at each, then the photons of a thread and the threads of a
range. All further sums are exact. By measurement, what a beam had sent after 30 passes of 2²⁵
photons was off by 52 u = 5.8e-15, as much as in each range alone; ranges added up one after the
other had made it 65 u.
"""

import math
from fractions import Fraction

import numpy as np
import pytest

import scenes
from sim.device import start_device
from sim.photons.energy import BOOK_COLUMNS, EnergyBooks
from sim.photons.lamps import compile_lamps
from sim.photons.tracing import RANGE_SIZE, RUN_LENGTH, trace_photons
from sim.scene_data import compile_scene

U = 2.0**-53
STEPS = 256
OF_A_RANGE = (RUN_LENGTH + RANGE_SIZE // RUN_LENGTH) * U
BOUND = OF_A_RANGE + 2 * STEPS * U


def trace(scene, photons, pass_index=0):
    compiled = compile_scene(scene, device=start_device("cpu"))
    lamps = compile_lamps(compiled, scene.film.edges_nm, photons)
    batch = trace_photons(
        compiled, lamps, seed=0, pass_index=pass_index, max_interactions=STEPS, threads=2
    )
    return batch, lamps


@pytest.mark.parametrize("photons", [RANGE_SIZE, 1 << 18, 3_000_000])
def test_what_a_beam_sends_is_what_its_photons_carry(photons):
    # Each photon of a beam carries Φ/N, rounded once; all end on a black wall. Φ/N, added N times,
    # is off by N u/2 where nothing is done about it, for every sum errs to the same side.
    wall = scenes.SceneObject(
        name="wall", material=scenes.Absorber(),
        shape=scenes.Plane(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0)),
    )
    beam = scenes.Beam(
        position=(0.0, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=0.7, spectrum="E",
        profile=scenes.RoundProfile(radius=0.1),
    )
    batch, lamps = trace(scenes.Scene(objects=(wall,), emitters=(beam,)), photons)
    expected = Fraction(lamps.flux / photons) * photons
    for column in (batch.books.emitted, batch.books.absorbed):
        assert abs(Fraction(column) - expected) <= OF_A_RANGE * expected
    assert (batch.books.deposited, batch.books.escaped, batch.books.culled) == (0.0, 0.0, 0.0)


def test_what_is_deposited_is_what_is_stored_and_nothing_is_missing():
    # Of a glass ball: every photon has another flux, and splits into many.
    batch, _ = trace(scenes.load("ball"), 1 << 18)
    books = batch.books
    stored = math.fsum(batch.data.flux.numpy()[batch.slots].tolist())
    assert len(batch) > 1 << 18
    assert abs(books.deposited - stored) <= (OF_A_RANGE + STEPS * U) * stored
    assert abs(books.residual) <= BOUND


def rounded_sum(values):
    """The sum of floats, rounded once."""
    return float(sum(map(Fraction, values)))


def test_ranges_add_up_exactly():
    # As many ranges as the largest pass has, 2²⁸/2¹⁴, of like flux and of fluxes far apart.
    rng = np.random.default_rng(1)
    rows = np.exp(rng.normal(0.0, [0.0, 1.0, 5.0, 20.0, 1.0], (1 << 14, 5))) * 0.1
    rows[:, 4] *= rng.choice([-1.0, 1.0], len(rows))
    books = EnergyBooks.from_rows(rows)
    for name, column in zip(BOOK_COLUMNS, rows.T.tolist(), strict=True):
        assert getattr(books, name) == rounded_sum(column)


def test_passes_are_averaged_exactly():
    rng = np.random.default_rng(2)
    rows = rng.normal(0.7, [1e-15, 1e-9, 0.1, 0.1, 10.0], (4096, 5))
    mean = EnergyBooks.mean([EnergyBooks(*row) for row in rows.tolist()])
    for name, column in zip(BOOK_COLUMNS, rows.T.tolist(), strict=True):
        assert getattr(mean, name) == rounded_sum(column) / 4096
