"""Fresnel's equations of metals, against complex arithmetic and printed reflectances."""

import functools

import numpy as np
import pytest
import warp as wp

from sim import analytic
from sim.device import start_device
from sim.optics.conductor import conductor_reflectance
from sim.precision import precision_types


@functools.cache
def make_probe(precision):
    real = precision_types(precision).real

    @wp.kernel(module=f"tests_conductor_{precision}", enable_backward=False)
    def probe(
        cosines: wp.array(dtype=real), n: wp.array(dtype=real), k: wp.array(dtype=real),
        out_s: wp.array(dtype=real), out_p: wp.array(dtype=real),
    ):  # fmt: skip
        i = wp.tid()
        r_s, r_p = conductor_reflectance(cosines[i], n[i], k[i])
        out_s[i] = r_s
        out_p[i] = r_p

    return probe


@pytest.fixture(params=["float64", "float32"])
def reflect(request):
    device = start_device("cpu")
    types = precision_types(request.param)

    def measure(cosines, n, k):
        arrays = [np.ravel(a) for a in np.broadcast_arrays(cosines, n, k)]
        inputs = [wp.array(a, dtype=types.real, device=device) for a in arrays]
        outs = [wp.zeros(arrays[0].size, dtype=types.real, device=device) for _ in range(2)]
        wp.launch(make_probe(request.param), dim=arrays[0].size, inputs=inputs, outputs=outs,
                  device=device)  # fmt: skip
        return [one.numpy().astype(np.float64) for one in outs]

    measure.eps = float(np.finfo(types.dtype).eps)
    return measure


METALS = [(0.05, 3.3), (0.18, 3.4), (1.4, 7.6), (0.6, 0.1), (1.5, 0.0), (3.0, 4.0), (50.0, 60.0)]


@pytest.mark.parametrize(("n", "k"), METALS)
def test_reflectances_are_those_of_a_complex_index(reflect, n, k):
    # r_s = (c − N c')/(c + N c'), r_p = (N c − c')/(N c + c'), c' = √(1 − s²/N²), N = n + ik
    # (Born & Wolf 1999, §14.2).
    cosines = np.linspace(0.0, 1.0, 500).astype(np.float32).astype(np.float64)
    index = np.complex128(n + 1j * k)
    behind = np.sqrt(1.0 - (1.0 - cosines**2) / index**2)
    expected_s = np.abs((cosines - index * behind) / (cosines + index * behind)) ** 2
    expected_p = np.abs((index * cosines - behind) / (index * cosines + behind)) ** 2
    r_s, r_p = reflect(cosines, n, k)
    # Numerators are sums of terms as large as the denominators, rounded a dozen times; where k
    # vanishes a² + b² + Re loses the digits of the angle besides.
    np.testing.assert_allclose(r_s, expected_s, rtol=0, atol=64 * reflect.eps)
    np.testing.assert_allclose(r_p, expected_p, rtol=0, atol=64 * reflect.eps)
    assert r_s[0] == 1.0
    assert r_p[0] == 1.0
    assert r_s[-1] == pytest.approx(r_p[-1], abs=16 * reflect.eps)


@pytest.mark.parametrize(
    ("n", "k", "expected"),
    [
        # Born & Wolf 1999, §14.2, Table 14.1: n, n κ and the reflectivity at normal incidence, for
        # sodium light.
        (0.044, 2.42, 0.97), (0.20, 3.44, 0.94), (0.37, 4.42, 0.93), (0.47, 2.83, 0.82),
        (1.62, 4.41, 0.75), (0.62, 2.57, 0.73), (1.58, 3.42, 0.66),
    ],
)  # fmt: skip
def test_printed_reflectances(reflect, n, k, expected):
    r_s, r_p = reflect(1.0, n, k)
    # Two digits are printed, of indices of two or three.
    assert r_s[0] == pytest.approx(expected, abs=0.01)
    assert r_p[0] == pytest.approx(expected, abs=0.01)


def test_without_absorption_a_metal_is_glass(reflect):
    cosines = np.linspace(0.05, 1.0, 100).astype(np.float32).astype(np.float64)
    r_s, r_p = reflect(cosines, 1.5, 0.0)
    expected_s, expected_p = analytic.fresnel_reflectance(cosines, 1.0, 1.5)
    np.testing.assert_allclose(r_s, expected_s, rtol=0, atol=32 * reflect.eps)
    np.testing.assert_allclose(r_p, expected_p, rtol=0, atol=32 * reflect.eps)


def test_no_light_is_made(reflect):
    random = np.random.default_rng(2)
    n, k = 10.0 ** random.uniform(-2, 2, (2, 20_000))
    r_s, r_p = reflect(random.uniform(0.0, 1.0, 20_000), n, k)
    for share in (r_s, r_p):
        assert np.all((share >= 0.0) & (share <= 1.0 + 4 * reflect.eps))
