"""What replicates and a second kernel tell of a picture's error."""

import math

import numpy as np
import pytest
from scipy import stats

import scenes
from sim.image.accuracy import Accuracy

SHAPE = (40, 50)


def make_accuracy(luminance, noise=0.0, bias=0.0, bias_noise=0.0, replicates=8):
    """An Accuracy whose corrected luminance is as noisy as the luminance itself."""
    maps = np.broadcast_arrays(*np.atleast_2d(luminance, noise, bias, bias_noise, noise))
    names = ("luminance", "noise", "bias", "bias_noise", "corrected_noise")
    return Accuracy(**dict(zip(names, maps, strict=True)), replicates=replicates)


def test_figures_are_relative_to_each_pixel_and_the_mean():
    # Pixels 1 and 3, mean 2: noise 0.3/(1 + 2) and 1/(3 + 2), root mean square √((0.01 + 0.04)/2).
    accuracy = make_accuracy([1.0, 3.0], noise=[0.3, 1.0], bias=[0.6, 0.0])
    assert accuracy.relative_noise == pytest.approx(math.sqrt(0.025), rel=1e-12)
    assert accuracy.relative_bias == pytest.approx(math.sqrt(0.02), rel=1e-12)
    assert accuracy.relative_error == pytest.approx(math.sqrt(0.045), rel=1e-12)
    assert accuracy.summary()["replicates"] == 8


def test_the_noise_of_the_bias_is_taken_out():
    # An estimate that is nothing but its own noise comes to nothing, up to σ(1/√n) of the mean.
    draw = np.random.default_rng(1)
    bias_noise = 0.2
    estimate = draw.normal(0.05, bias_noise, SHAPE)
    accuracy = make_accuracy(np.ones(SHAPE), bias=estimate, bias_noise=bias_noise)
    spread = math.sqrt(2.0 * bias_noise**4 + 4.0 * (0.05 * bias_noise) ** 2) / math.sqrt(2000)
    assert abs(4.0 * accuracy.relative_bias**2 - 0.05**2) < 5.0 * spread


def test_one_replicate_knows_no_error():
    accuracy = make_accuracy(np.ones(SHAPE), noise=np.nan, bias_noise=np.nan, replicates=1)
    assert math.isnan(accuracy.relative_error)
    assert accuracy.summary()["relative_error"] is None
    assert np.isnan(accuracy.interval()).all()


def test_a_black_picture_is_exact():
    assert make_accuracy(np.zeros(SHAPE)).relative_error == 0.0


@pytest.mark.parametrize("replicates", [2, 4, 8])
@pytest.mark.parametrize("level", [0.95, 0.5])
def test_intervals_are_students(replicates, level):
    # Means of n normal numbers with their own standard errors: the truth lies inside as often as
    # the level says, whatever n, within 5 √(p (1 − p)/N).
    samples = np.random.default_rng(replicates).normal(10.0, 1.0, (replicates, 200, 100))
    noise = samples.std(axis=0, ddof=1) / math.sqrt(replicates)
    accuracy = make_accuracy(samples.mean(axis=0), noise=noise, replicates=replicates)
    low, high = accuracy.interval(level)
    inside = (low <= 10.0) & (high >= 10.0)
    assert abs(inside.mean() - level) < 5.0 * math.sqrt(level * (1.0 - level) / inside.size)
    quantile = stats.t.ppf(0.5 + 0.5 * level, replicates - 1)
    np.testing.assert_allclose(high - low, 2.0 * quantile * noise, rtol=1e-9)


def test_the_bias_moves_the_interval():
    low, high = make_accuracy([1.0, 2.0], noise=0.1, bias=[0.5, -0.2]).interval()
    np.testing.assert_allclose(0.5 * (low + high)[0], [0.5, 2.2], rtol=1e-12)


def test_the_estimated_bias_is_what_the_kernel_adds(darkroom, assert_mean):
    # Below a point lamp at height h, E = Φ h/(4π (h² + ρ²)^{3/2}), and a gather of radius r reads
    # the mean over its disc, weighted by 2/(π r²)(1 − ρ²/r²): at the foot
    # ∫₀¹ 2 (1 − x) (1 + x r²/h²)^{−3/2} dx, less than 1 by the bias.
    height, radius, passes = 0.5, 0.25, 12
    floor = scenes.SceneObject(
        name="floor",
        shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0)),
        material=scenes.Lambertian(reflectance=0.5),
    )
    lamp = scenes.Point(position=(0.0, height, 0.0), flux=1.0, spectrum="E")
    film = scenes.Film(first_nm=425, last_nm=675, bands=6)
    scene = scenes.Scene(objects=(floor,), emitters=(lamp,), film=film)
    room = darkroom(scene, photons=60_000, radius=radius, passes=passes)
    camera = scenes.Camera(
        position=(0.0, 0.3, 0.1), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=0.5
    )
    found = []
    for index in range(passes):
        picture = room.create_film(width=4, height=4)
        room.expose(picture, camera, index)
        accuracy = picture.accuracy()
        found.append((accuracy.luminance.mean(), accuracy.bias.mean()))
    luminance, bias = np.array(found).T
    c = (radius / height) ** 2
    x = np.linspace(0.0, 1.0, 100_001)
    read = np.trapezoid(2.0 * (1.0 - x) * (1.0 + c * x) ** -1.5, x)
    # What is sensed at half the area, twice the difference: the same to second order in c, and
    # exactly 2 (read(c) − read(c/2)).
    narrow = np.trapezoid(2.0 * (1.0 - x) * (1.0 + 0.5 * c * x) ** -1.5, x)
    ratio = 2.0 * (read - narrow) / read
    assert_mean(bias / luminance, ratio)
    # And that is the bias itself, (read − 1)/read, but for the next order, c² here.
    assert ratio == pytest.approx((read - 1.0) / read, abs=c**2)
    assert bias.mean() / luminance.mean() < -0.05
