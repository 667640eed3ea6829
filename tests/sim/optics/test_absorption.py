"""1 − exp(−α d) with all its digits, from nothing to everything."""

import functools

import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.optics.absorption import absorbed_fraction
from sim.precision import precision_types


@functools.cache
def make_probe(precision):
    real = precision_types(precision).real

    @wp.kernel(module=f"tests_absorption_{precision}", enable_backward=False)
    def probe(
        alpha: wp.array(dtype=real), distance: wp.array(dtype=real), out_lost: wp.array(dtype=real)
    ):
        i = wp.tid()
        out_lost[i] = absorbed_fraction(alpha[i], distance[i])

    return probe


@pytest.fixture(params=["float64", "float32"])
def absorb(request):
    device = start_device("cpu")
    types = precision_types(request.param)

    def measure(alpha, distance):
        alpha, distance = np.broadcast_arrays(
            np.asarray(alpha, dtype=types.dtype), np.asarray(distance, dtype=types.dtype)
        )
        lost = wp.zeros(alpha.size, dtype=types.real, device=device)
        inputs = [
            wp.array(np.ravel(one), dtype=types.real, device=device) for one in (alpha, distance)
        ]
        wp.launch(make_probe(request.param), dim=alpha.size, inputs=inputs, outputs=[lost],
                  device=device)  # fmt: skip
        return lost.numpy()

    measure.dtype = types.dtype
    return measure


def test_it_is_one_minus_the_exponential(absorb):
    eps = float(np.finfo(absorb.dtype).eps)
    alpha = np.float64(1.0) * np.asarray(10.0 ** np.linspace(-12, 3, 400), dtype=absorb.dtype)
    lost = absorb(alpha, 0.5)
    # Of the series the next term is x⁴/120: 1e-14 of x at its end, 1e-3. Behind it, 1 − exp(−x)
    # loses 1/x of its digits.
    expected = -np.expm1(-0.5 * alpha)
    allowed = 4.0 * eps * np.maximum(1.0, 1.0 / np.maximum(0.5 * alpha, 1e-3) * (alpha > 1.9e-3))
    assert np.all(np.abs(lost / expected - 1.0) <= allowed + 1e-14)
    assert np.all(np.diff(lost) >= -eps)


@pytest.mark.parametrize(
    ("alpha", "distance", "expected"),
    [
        (0.0, 5.0, 0.0), (0.0, np.inf, 0.0), (3.0, 0.0, 0.0), (3.0, np.inf, 1.0),
        (1e30, 1.0, 1.0), (1e30, 0.0, 0.0), (3.0, -1e-15, 0.0), (-1e-20, 2.0, 0.0),
    ],
)  # fmt: skip
def test_at_its_ends_it_is_a_number(absorb, alpha, distance, expected):
    assert absorb([alpha], [distance])[0] == expected
