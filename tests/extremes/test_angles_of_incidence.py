"""Snell and Fresnel at grazing, normal and critical incidence, and where indices nearly agree.

References are the textbook's formulas in 60 digits, of the angles that were meant: what a ray's
direction is rounded by is part of the error, and of its tolerance.
"""

import functools

import mpmath
import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.features import Features
from sim.scene_structs import make_scene_structs
from sim.surfaces import make_surfaces

mpmath.mp.dps = 60
HALF_PI = mpmath.pi / 2


@functools.cache
def make_probe(precision):
    structs = make_scene_structs(precision)
    real, vec3, vec4 = structs.real, structs.vec3, structs.vec4
    cross = make_surfaces(precision, Features()).cross

    @wp.kernel(module=f"tests_extreme_incidence_{precision}", enable_backward=False)
    def meet(
        directions: wp.array(dtype=vec3),
        etas: wp.array(dtype=real),
        out_total: wp.array(dtype=int),
        out_matrix: wp.array(dtype=vec4),
        out_reflected: wp.array(dtype=vec3),
        out_refracted: wp.array(dtype=vec3),
    ):
        i = wp.tid()
        normal = vec3(real(0.0), real(1.0), real(0.0))
        total, matrix, _together, reflected, refracted = cross(directions[i], normal, etas[i])
        out_total[i] = total
        out_matrix[i] = matrix
        out_reflected[i] = reflected
        out_refracted[i] = refracted

    return meet, structs


def meet(precision, thetas, etas):
    """Total or not, R_s, R_p, and both directions, of light in the x-y plane; all float64."""
    start_device("cpu")
    kernel, structs = make_probe(precision)
    n = len(thetas)
    ways = np.array([[float(mpmath.sin(t)), -float(mpmath.cos(t)), 0.0] for t in thetas])
    total = wp.zeros(n, dtype=int, device="cpu")
    matrix = wp.zeros(n, dtype=structs.vec4, device="cpu")
    reflected, refracted = (wp.zeros(n, dtype=structs.vec3, device="cpu") for _ in range(2))
    inputs = [
        wp.array(ways, dtype=structs.vec3, device="cpu"),
        wp.array(np.array(etas), dtype=structs.real, device="cpu"),
    ]
    outputs = [total, matrix, reflected, refracted]
    wp.launch(kernel, dim=n, inputs=inputs, outputs=outputs, device="cpu")
    rows = matrix.numpy().astype(np.float64)
    r_s, r_p = rows[:, 0] + rows[:, 1], rows[:, 0] - rows[:, 1]
    return (
        total.numpy(), r_s, r_p, reflected.numpy().astype(np.float64),
        refracted.numpy().astype(np.float64),
    )  # fmt: skip


def exact(theta, eta):
    """(cosθ_t, R_s, R_p), η = η_i/η_t exactly; None, 1, 1 where reflection is total."""
    c, s = mpmath.cos(theta), mpmath.sin(theta)
    eta = mpmath.mpf(eta)
    square = 1 - (eta * s) ** 2
    if square <= 0 and eta > 1:
        return None, 1.0, 1.0
    g = mpmath.sqrt(square)
    if eta == 1:
        return g, 0.0, 0.0
    # Born & Wolf 1999, §1.5.2 eq. (21).
    r_s = (eta * c - g) / (eta * c + g)
    r_p = (c - eta * g) / (c + eta * g)
    return g, float(r_s**2), float(r_p**2)


def rounded(precision, etas):
    """Indices as the kernel is given them, exactly."""
    return [float(np.dtype(precision).type(eta)) for eta in etas]


NEAR_ONE = [1.0 - 1e-12, 1.0 + 1e-12, 1.0 - 1e-6, 1.0 + 1e-6, 1.0 - 1e-3, 1.0 + 1e-3]
ETAS = [*NEAR_ONE, 1.0, 1 / 1.5, 1.5, 1 / 4.0, 4.0]
ANGLES = [
    *(mpmath.mpf(10) ** -k for k in (300, 20, 12, 9, 6, 3, 1)),
    mpmath.mpf(0), mpmath.pi / 4, mpmath.mpf(1),
    *(HALF_PI - mpmath.mpf(10) ** -k for k in (1, 2, 3, 4, 5, 6, 8, 12, 15)),
]  # fmt: skip


def cases(precision):
    return [(t, eta) for t in ANGLES for eta in rounded(precision, ETAS)]


def slack_of(theta, eta, g, unit):
    """How far cosθ_t may be off, g: its square is rounded by some ε of what it is the sum of.

    These are (1 − η)(1 + η) + (η cosθ_i)² below 45°, and 1 − η² sin²θ_i above, where the cosine's
    own rounding, ε/2, makes η² ε.
    """
    eta, c2 = mpmath.mpf(eta), mpmath.cos(theta) ** 2
    terms = abs((1 - eta) * (1 + eta)) + eta**2 * c2 if c2 < 0.5 else 1 + eta**2
    return float(4 * unit * terms / (2 * g)) if g else 0.0


def test_directions_obey_snell_from_normal_to_grazing(precision, eps):
    chosen = cases(precision)
    unit, smallest = eps[precision], float(np.finfo(precision).tiny)
    total, _, _, reflected, refracted = meet(precision, *zip(*chosen, strict=True))
    for k, (theta, eta) in enumerate(chosen):
        s, c = float(mpmath.sin(theta)), float(mpmath.cos(theta))
        np.testing.assert_allclose(reflected[k], [s, c, 0.0], rtol=0, atol=4 * unit)
        g, *_ = exact(theta, eta)
        assert total[k] == (g is None), (theta, eta)
        if g is None:
            continue
        # η_i sinθ_i = η_t sinθ_t: relative, so that the smallest angles are right too; the length
        # of the direction is mended by as much as cosθ_t is off times cosθ_t.
        off = slack_of(theta, eta, g, unit)
        tolerance = (4 * unit + off * float(g)) * eta * s
        assert abs(refracted[k, 0] - eta * s) <= tolerance + smallest, (theta, eta)
        assert abs(refracted[k, 1] + float(g)) <= off + 4 * unit * float(g), (theta, eta)
        assert refracted[k, 2] == 0.0


def test_reflectances_from_normal_to_grazing(precision, eps):
    chosen = cases(precision)
    unit = eps[precision]
    _, r_s, r_p, _, _ = meet(precision, *zip(*chosen, strict=True))
    for k, (theta, eta) in enumerate(chosen):
        g, true_s, true_p = exact(theta, eta)
        # Both are squares of (a − b)/(a + b), a and b known to ε of themselves and, through cosθ_t,
        # to its relative error: |δr| ≤ (1 − r²)/2 · (δa/a + δb/b), and δR = 2 |r| δr + δr².
        relative = 4 * unit + (slack_of(theta, eta, g, unit) / float(g) if g else 0.0)
        for got, true in ((r_s[k], true_s), (r_p[k], true_p)):
            amplitude = 0.5 * relative * (1.0 - true) + unit
            tolerance = 2.0 * true**0.5 * amplitude + amplitude**2
            assert abs(got - true) <= tolerance + 2 * unit * true, (theta, eta, got, true)
            assert 0.0 <= got <= 1.0 + 4 * unit


def test_equal_media_are_not_there_at_any_angle(precision):
    total, r_s, r_p, _, refracted = meet(precision, ANGLES, [1.0] * len(ANGLES))
    assert not total.any()
    assert not r_s.any()
    assert not r_p.any()
    dtype = np.dtype(precision)
    ways = [[float(mpmath.sin(t)), -float(mpmath.cos(t)), 0.0] for t in ANGLES]
    np.testing.assert_array_equal(refracted, np.array(ways).astype(dtype).astype(np.float64))


@pytest.mark.parametrize("eta", [1.0 + 1e-3, 1.5, 4.0])
def test_a_trillionth_of_a_radian_decides_total_reflection(precision, eps, eta):
    # float64 promises 1e-12 rad. cosθ_t² is rounded by some ε (η² − 1), and changes by
    # 2 η² sinθ cosθ per radian, which at the critical angle is 2 √(η² − 1): the critical angle is
    # known to ε √(η² − 1), and 4 times that is asked of float32.
    (eta,) = rounded(precision, [eta])
    critical = mpmath.asin(1 / mpmath.mpf(eta))
    step = 1e-12
    if precision == "float32":
        step = 4.0 * eps[precision] * max(1.0, (eta**2 - 1.0) ** 0.5)
    steps = step * np.array([1.0, 2.0, 10.0, 1e3, 1e5])
    inside = [critical - mpmath.mpf(x) for x in steps]
    outside = [critical + mpmath.mpf(x) for x in steps]
    total, r_s, r_p, _, refracted = meet(precision, inside + outside, [eta] * 10)
    assert total.tolist() == [0] * 5 + [1] * 5
    np.testing.assert_array_equal(r_s[5:], 1.0)
    np.testing.assert_array_equal(r_p[5:], 1.0)
    for k, theta in enumerate(inside):
        g, true_s, true_p = exact(theta, eta)
        # The direction's cosine and sine, rounded by ε/2 each, are an angle that is off by ε/2.
        off = slack_of(theta, eta, g, eps[precision])
        off += 2.0 * eps[precision] * (eta**2 - 1.0) ** 0.5 / float(g)
        assert abs(refracted[k, 1] + float(g)) <= off
        # Near the critical angle R = 1 − 4 cosθ_t/(η cosθ_i), with 1/η² in place of 1 for p.
        slope = 4.0 * eta * off / float(mpmath.cos(theta))
        assert abs(r_s[k] - true_s) <= slope
        assert abs(r_p[k] - true_p) <= slope * eta


def test_the_critical_angle_itself_and_grazing_light_are_numbers(precision):
    etas = rounded(precision, [1.0 + 1e-3, 1.5, 4.0, 1.0, 0.25, 1.0 - 1e-6])
    thetas = [mpmath.asin(1 / mpmath.mpf(eta)) if eta > 1.0 else HALF_PI for eta in etas]
    _, r_s, r_p, reflected, refracted = meet(precision, thetas, etas)
    for values in (r_s, r_p):
        assert np.all(np.isfinite(values))
        assert np.all((values >= 0.0) & (values <= 1.0))
    for ways in (reflected, refracted):
        np.testing.assert_allclose(
            np.linalg.norm(ways, axis=1), 1.0, rtol=0, atol=4 * np.finfo(precision).eps
        )
