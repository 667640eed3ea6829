"""A rendering ends when it is good enough, when its time is up, or with its passes."""

import numpy as np
import pytest

import sim
from sim.image.accuracy import Accuracy
from sim.settings import RenderSettings
from sim.stopping import StopRule


class Clock:
    """A watch that is set by hand."""

    def __init__(self):
        self.seconds = 1.0
        self.error = None


class FilmOf:
    """A film that has had some rounds, with the error 1/rounds."""

    def __init__(self, rounds):
        self.rounds = rounds

    def accuracy(self):
        one = np.ones((1, 1))
        # Relative to luminance plus mean: twice the luminance.
        noise = 2.0 * one / self.rounds
        return Accuracy(
            luminance=one, noise=noise, bias=0 * one, bias_noise=0 * one, corrected_noise=noise,
            replicates=self.rounds,
        )


def rounds_until_the_end(small_scene, *, seconds_a_round=1.0, most=50, **settings):
    clock = Clock()
    rule = StopRule(RenderSettings(**settings).resolved(small_scene), clock)
    for rounds in range(1, most + 1):
        clock.seconds += seconds_a_round
        if rule.ends_after(FilmOf(rounds)):
            return rounds, rule.outcome, clock
    return most, rule.outcome, clock


@pytest.mark.parametrize(("target", "rounds"), [(0.26, 4), (0.1, 10), (0.9, 2), (1.0, 2)])
def test_a_target_ends_it(small_scene, target, rounds):
    ended, outcome, clock = rounds_until_the_end(small_scene, target_error=target)
    assert (ended, outcome) == (rounds, "target error")
    assert clock.error == pytest.approx(1.0 / rounds)


@pytest.mark.parametrize(("budget", "rounds"), [(10.0, 9), (10.5, 9), (2.0, 2), (0.1, 2)])
def test_a_budget_ends_it_before_it_is_exceeded(small_scene, budget, rounds):
    # The first second is spent already; two rounds there always are.
    ended, outcome, clock = rounds_until_the_end(small_scene, time_budget=budget)
    assert (ended, outcome) == (rounds, "time budget")
    assert clock.seconds <= max(budget, 3.0)


def test_whichever_comes_first(small_scene):
    both = {"target_error": 0.2, "time_budget": 4.0}
    assert rounds_until_the_end(small_scene, **both)[:2] == (3, "time budget")
    assert rounds_until_the_end(small_scene, **both, seconds_a_round=0.1)[:2] == (5, "target error")


def test_without_either_all_passes_are_made(small_scene):
    assert rounds_until_the_end(small_scene)[:2] == (50, "all passes")


def test_what_a_target_ended_renders_the_same_again(small_scene):
    settings = sim.RenderSettings(target_error=0.9)
    picture = sim.render(small_scene, settings)
    assert picture.stopping == "target error"
    assert picture.accuracy.relative_error <= 0.9
    assert picture.settings.passes == 4
    again = sim.render(small_scene, picture.settings)
    assert again.stopping == "all passes"
    np.testing.assert_array_equal(again.spectral_radiance, picture.spectral_radiance)
    np.testing.assert_array_equal(again.standard_error, picture.standard_error)


def test_progress_tells_the_error(small_scene):
    told = []
    settings = sim.RenderSettings(passes=8, target_error=1e-9)
    picture = sim.render(small_scene, settings, progress=told.append)
    assert all(one.is_open for one in told)
    assert told[0].error is None
    assert 0.0 < told[-1].error < 1.0
    assert picture.stopping == "all passes"
