"""Snell and Fresnel on the device, against the closed forms in float64."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from sim import analytic
from sim.device import start_device
from sim.optics.dielectric import (
    cos2_theta_t,
    fresnel_reflectance,
    reflect,
    refract,
    renormalize,
    schlick_reflectance,
)
from sim.precision import precision_types


@functools.cache
def make_probes(precision):
    """One module a precision, so that it is compiled once."""
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3
    options = {"module": f"tests_dielectric_{precision}", "enable_backward": False}

    @wp.kernel(**options)
    def boundary(
        cos_theta_i: wp.array(dtype=real),
        eta: wp.array(dtype=real),
        out_cos2: wp.array(dtype=real),
        out_r_s: wp.array(dtype=real),
        out_r_p: wp.array(dtype=real),
    ):
        i = wp.tid()
        cos2 = cos2_theta_t(cos_theta_i[i], eta[i])
        cos_theta_t = wp.sqrt(wp.max(cos2, real(0.0)))
        r_s, r_p = fresnel_reflectance(cos_theta_i[i], cos_theta_t, eta[i])
        out_cos2[i] = cos2
        out_r_s[i] = r_s
        out_r_p[i] = r_p

    @wp.kernel(**options)
    def directions(
        incoming: wp.array(dtype=vec3),
        normals: wp.array(dtype=vec3),
        eta: wp.array(dtype=real),
        out_reflected: wp.array(dtype=vec3),
        out_refracted: wp.array(dtype=vec3),
        out_renormalized: wp.array(dtype=vec3),
    ):
        i = wp.tid()
        d = incoming[i]
        n = normals[i]
        cos_theta_i = -wp.dot(d, n)
        cos_theta_t = wp.sqrt(cos2_theta_t(cos_theta_i, eta[i]))
        out_reflected[i] = reflect(d, n, cos_theta_i)
        out_refracted[i] = refract(d, n, cos_theta_i, cos_theta_t, eta[i])
        out_renormalized[i] = renormalize(d)

    @wp.kernel(**options)
    def approximate(
        cos_theta_i: wp.array(dtype=real), eta: wp.array(dtype=real), out: wp.array(dtype=real)
    ):
        i = wp.tid()
        cos2 = cos2_theta_t(cos_theta_i[i], eta[i])
        cos_theta_t = wp.sqrt(wp.max(cos2, real(0.0)))
        out[i] = schlick_reflectance(cos_theta_i[i], cos_theta_t, eta[i])

    return SimpleNamespace(
        boundary=boundary, directions=directions, approximate=approximate, types=types
    )


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def eps(precision):
    return float(np.finfo(precision).eps)


def boundary(precision, cos_theta_i, eta):
    """cos²θₜ, R_s and R_p, and the inputs as they were rounded, all float64."""
    probes = make_probes(precision)
    pair = np.broadcast_arrays(*(np.asarray(a, dtype=precision) for a in (cos_theta_i, eta)))
    inputs = [wp.array(np.ascontiguousarray(a), dtype=probes.types.real, device="cpu")
              for a in pair]  # fmt: skip
    outs = [wp.zeros(pair[0].size, dtype=probes.types.real, device="cpu") for _ in range(3)]
    wp.launch(probes.boundary, dim=pair[0].size, inputs=inputs, outputs=outs, device="cpu")
    return [np.asarray(a, dtype=np.float64) for a in (*(out.numpy() for out in outs), *pair)]


def directions(precision, incoming, normals, eta):
    """Reflected, refracted and renormalised directions, float64."""
    probes = make_probes(precision)
    vectors = [wp.array(a, dtype=probes.types.vec3, device="cpu") for a in (incoming, normals)]
    etas = wp.array(np.full(len(incoming), eta), dtype=probes.types.real, device="cpu")
    outs = [wp.zeros(len(incoming), dtype=probes.types.vec3, device="cpu") for _ in range(3)]
    wp.launch(
        probes.directions, dim=len(incoming), inputs=[*vectors, etas], outputs=outs, device="cpu"
    )
    return [out.numpy().astype(np.float64) for out in outs]


ETAS = [1.0 / 2.42, 1.0 / 1.5168, 1.0 / 1.001, 1.001, 1.5168, 2.42]


@pytest.mark.parametrize("eta", ETAS)
def test_reflectance_is_fresnels(precision, eta):
    """η = η_i/η_t; analytic takes both indices."""
    cos_theta_i = np.concatenate([np.linspace(0.0, 1.0, 501), np.geomspace(1e-6, 1.0, 100)])
    results = np.stack(boundary(precision, cos_theta_i, eta))
    cos2, r_s, r_p, c, relative = results[:, results[0] > 0.0]
    expected = analytic.fresnel_reflectance(c, relative, 1.0)
    # cos²θₜ carries a rounding of some ε of its two terms, so cosθₜ one of that over 2 cosθₜ, and
    # an amplitude (a - b)/(a + b) twice the relative error of its terms; R = r².
    above, below = 1.0 + relative**2 * (1.0 - c**2), np.abs(1.0 - relative**2) + relative**2 * c**2
    terms = np.where(c * c > 0.5, above, below)
    error = eps(precision) * (6.0 + 2.0 * terms / cos2)
    for ours, theirs in zip((r_s, r_p), expected, strict=True):
        difference = np.abs(ours - theirs)
        assert np.all(difference <= 2.0 * np.sqrt(theirs) * error + error**2)
        # Where the cosine has digits, that is a few ulps of 1.
        assert np.max(difference[cos2 > 0.1]) <= 16.0 * eps(precision)


@pytest.mark.parametrize("eta", ETAS)
def test_reflectance_is_a_share(precision, eta):
    cos_theta_i = np.concatenate([[0.0], np.geomspace(1e-30, 1.0, 2000), [1.0]])
    _, r_s, r_p, _, _ = boundary(precision, cos_theta_i, eta)
    for share in (r_s, r_p):
        assert share.min() >= 0.0
        assert share.max() <= 1.0


def test_normal_incidence(precision):
    eta = np.array([1.0 / 2.42, 1.0 / 1.5, 1.0 + 1e-3, 1.5, 2.42])
    _, r_s, r_p, _, relative = boundary(precision, 1.0, eta)
    expected = ((relative - 1.0) / (relative + 1.0)) ** 2  # Born & Wolf 1999, §1.5.2, eq. 36
    np.testing.assert_allclose(r_s, expected, rtol=8 * eps(precision))
    np.testing.assert_allclose(r_p, expected, rtol=8 * eps(precision))


def test_equal_media_reflect_nothing_at_any_angle(precision):
    _, r_s, r_p, _, _ = boundary(precision, np.array([0.0, 1e-30, 1e-9, 1e-3, 0.5, 1.0]), 1.0)
    assert not r_s.any()
    assert not r_p.any()


@pytest.mark.parametrize("eta", [0.4, 0.999, 1.5])
def test_grazing_light_is_reflected_whole(precision, eta):
    _, r_s, r_p, _, _ = boundary(precision, np.array([0.0, -1e-9]), eta)
    assert r_s.tolist() == r_p.tolist() == [1.0, 1.0]


def test_light_beyond_the_critical_angle_is_told_apart(precision):
    eta = 1.5
    cos_critical = np.sqrt(1.0 - 1.0 / eta**2)
    step = 8.0 * eps(precision)
    cos2, _, _, _, _ = boundary(precision, cos_critical + np.array([step, -step]), eta)
    assert cos2[0] > 0.0 >= cos2[1]


def test_small_angles_keep_their_digits(precision):
    # 1 - c² of a cosine next to 1: exact differences, so a relative error of a few ulps; then one
    # rounding of a number next to 1.
    cos_theta_i = 1.0 - eps(precision) * np.array([1.0, 2.0, 7.0, 100.0])
    cos2, _, _, c, eta = boundary(precision, cos_theta_i, 1.5)
    expected = eta**2 * (1.0 - c) * (1.0 + c)
    np.testing.assert_allclose(1.0 - cos2, expected, rtol=4 * eps(precision), atol=eps(precision))


def random_boundaries(count, precision, *, least_cosine=0.0):
    """Unit directions and unit normals that face them, both exact in the precision."""
    rng = np.random.default_rng(5)
    incoming, normals = rng.normal(size=(2, 4 * count, 3))
    incoming /= np.linalg.norm(incoming, axis=1, keepdims=True)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    cosine = np.sum(incoming * normals, axis=1)
    normals = -np.sign(cosine)[:, None] * normals
    keep = np.flatnonzero(np.abs(cosine) > least_cosine)[:count]
    assert len(keep) == count
    return (a[keep].astype(precision).astype(np.float64) for a in (incoming, normals))


@pytest.mark.parametrize("eta", [1.0 / 2.42, 1.0 / 1.5, 1.0, 1.3])
def test_refraction_obeys_snell(precision, eta):
    # Below η sinθᵢ = 0.95 where it could be total, so that cosθₜ > 0.3 keeps its digits.
    least = np.sqrt(max(0.0, 1.0 - (0.95 / eta) ** 2)) if eta > 1.0 else 0.0
    incoming, normals = random_boundaries(2000, precision, least_cosine=least)
    _, refracted, _ = directions(precision, incoming, normals, eta)
    tolerance = 12 * eps(precision)
    # n × (η d - t) = 0: Snell's law and the plane of incidence in one (Born & Wolf §1.5.1, eq. 8).
    np.testing.assert_allclose(
        np.cross(normals, eta * incoming - refracted), 0.0, rtol=0, atol=tolerance
    )
    assert np.all(np.sum(refracted * normals, axis=1) < 0.0)  # on to the other side
    np.testing.assert_allclose(np.linalg.norm(refracted, axis=1), 1.0, rtol=0, atol=tolerance)


def test_refraction_between_equal_media_changes_nothing(precision):
    incoming, normals = random_boundaries(2000, precision, least_cosine=0.1)
    _, refracted, _ = directions(precision, incoming, normals, 1.0)
    np.testing.assert_allclose(refracted, incoming, rtol=0, atol=20 * eps(precision))


def test_reflection_mirrors(precision):
    incoming, normals = random_boundaries(2000, precision)
    reflected, _, _ = directions(precision, incoming, normals, 1.0)
    tolerance = 8 * eps(precision)
    np.testing.assert_allclose(
        np.sum(reflected * normals, axis=1), -np.sum(incoming * normals, axis=1), atol=tolerance
    )
    np.testing.assert_allclose(np.cross(normals, reflected - incoming), 0.0, atol=tolerance)
    np.testing.assert_allclose(np.linalg.norm(reflected, axis=1), 1.0, rtol=0, atol=tolerance)


@pytest.mark.parametrize("error", [0.0, 1e-3, -1e-3, 1e-5])
def test_renormalising_squares_the_error_of_the_length(precision, error):
    # |d| = 1 + e becomes 1 - 3e²/2 - e³/2.
    incoming, normals = random_boundaries(500, precision)
    scaled = incoming * (1.0 + error)
    _, _, renormalized = directions(precision, scaled, normals, 1.0)
    length = np.linalg.norm(scaled.astype(precision).astype(np.float64), axis=1)
    e = length - 1.0
    np.testing.assert_allclose(
        np.linalg.norm(renormalized, axis=1), 1.0 - 1.5 * e**2 - 0.5 * e**3, rtol=0,
        atol=2 * eps(precision),
    )  # fmt: skip


def schlick(precision, cos_theta_i, eta):
    """Schlick's reflectance on the device, where light is not reflected totally."""
    probes = make_probes(precision)
    pair = np.broadcast_arrays(*(np.asarray(a, dtype=precision) for a in (cos_theta_i, eta)))
    real = probes.types.real
    inputs = [wp.array(np.ascontiguousarray(a), dtype=real, device="cpu") for a in pair]
    out = wp.zeros(len(pair[0]), dtype=real, device="cpu")
    wp.launch(probes.approximate, dim=len(out), inputs=[*inputs, out], device="cpu")
    return out.numpy().astype(np.float64)


@pytest.mark.parametrize("eta", [1.0 / 1.5, 1.5, 1.0 / 2.4, 2.4, 1.0])
def test_schlick_meets_fresnel_at_normal_incidence(precision, eta):
    # R₀ = ((η − 1)/(η + 1))² (Born & Wolf 1999, §1.5.3 eq. 36), and no more: 1 − cosθ = 0.
    expected = ((eta - 1.0) / (eta + 1.0)) ** 2
    found = schlick(precision, [1.0], [eta])
    np.testing.assert_allclose(found, expected, rtol=8.0 * eps(precision))


def test_schlick_reflects_grazing_light_whole(precision):
    # From outside at cosθᵢ = 0, from inside at the critical angle, sin²θᵢ = 1/η², where
    # cosθₜ = 0 but for rounding: a relative error ε of sin²θₜ makes cosθₜ = √ε, and 1 − R is
    # 5 (1 − R₀) cosθₜ.
    assert schlick(precision, [0.0], [1.0 / 1.5])[0] == pytest.approx(1.0, abs=4.0 * eps(precision))
    critical = np.sqrt(1.0 - 1.0 / 1.5**2) * (1.0 + 4.0 * eps(precision))
    found = schlick(precision, [critical], [1.5])[0]
    assert found == pytest.approx(1.0, abs=5.0 * np.sqrt(20.0 * eps(precision)))


def test_schlick_between_is_the_formula(precision):
    # R₀ + (1 − R₀)(1 − cosθ)⁵ at 60° outside, cosθ = 1/2: 0.04 + 0.96/32, for η = 1.5; the same
    # backwards, from inside at sinθᵢ = sin 60°/1.5.
    inside = np.sqrt(1.0 - 0.75 / 2.25)
    found = schlick(precision, [0.5, inside], [1.0 / 1.5, 1.5])
    np.testing.assert_allclose(found, 0.04 + 0.96 / 32.0, rtol=20.0 * eps(precision))
