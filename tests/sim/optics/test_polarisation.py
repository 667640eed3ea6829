"""Stokes vectors on the device, against the complex field itself followed in three dimensions.

The reference knows no Stokes vector and no frame: it carries the field E, splits it along s and p,
and puts it together again with Fresnel's amplitudes.
"""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from sim.analytic_polarisation import fresnel_amplitudes as expected_amplitudes
from sim.device import start_device
from sim.optics.dielectric import cos2_theta_t, reflect, refract
from sim.optics.polarisation import (
    apply_surface,
    conductor_matrix,
    frame_across,
    fresnel_amplitudes,
    share_of_flux,
    total_reflection_phase,
    turn_frame,
)
from sim.precision import precision_types

COUNT = 2000


@functools.cache
def make_probes(precision):
    """One module a precision, so that it is compiled once."""
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3
    options = {"module": f"tests_polarisation_{precision}", "enable_backward": False}

    @wp.kernel(**options)
    def meet(
        directions: wp.array(dtype=vec3),
        normals: wp.array(dtype=vec3),
        eta: real,
        k: real,
        sign: real,
        io_light: wp.array2d(dtype=vec3),
        io_s: wp.array(dtype=vec3),
        out_shares: wp.array2d(dtype=real),
        out_directions: wp.array2d(dtype=vec3),
    ):
        """Reflected in column 0, let through in column 1; `sign` −1 takes the transposed matrix."""
        i = wp.tid()
        d = directions[i]
        n = normals[i]
        light, s = turn_frame(io_light[i, 0], io_s[i], d, n)
        cos_theta_i = wp.min(-wp.dot(d, n), real(1.0))
        reflected = reflect(d, n, cos_theta_i)
        refracted = reflected
        mean = real(1.0)
        half = real(0.0)
        cosine = real(0.0)
        sine = real(0.0)
        passed_cosine = real(0.0)
        cos2 = cos2_theta_t(cos_theta_i, eta)
        if k > real(0.0):
            mean, half, cosine, sine = conductor_matrix(cos_theta_i, eta, k)
        elif eta != real(1.0) and cos2 <= real(0.0):
            cosine, sine = total_reflection_phase(cos_theta_i, cos2, eta)
        else:
            cos_theta_t = wp.sqrt(wp.max(cos2, real(0.0)))
            r_s, r_p, together = fresnel_amplitudes(cos_theta_i, cos_theta_t, eta)
            mean = real(0.5) * (r_s * r_s + r_p * r_p)
            half = real(0.5) * (r_s * r_s - r_p * r_p)
            cosine = r_s * r_p
            passed_cosine = together
            refracted = refract(d, n, cos_theta_i, cos_theta_t, eta)
        out_shares[i, 0] = share_of_flux(light[0], mean, half)
        out_shares[i, 1] = share_of_flux(light[0], real(1.0) - mean, -half)
        io_light[i, 0] = apply_surface(light, mean, half, cosine, sign * sine)
        io_light[i, 1] = apply_surface(light, real(1.0) - mean, -half, passed_cosine, real(0.0))
        io_s[i] = s
        out_directions[i, 0] = reflected
        out_directions[i, 1] = refracted

    @wp.kernel(**options)
    def turn(
        directions: wp.array(dtype=vec3),
        normals: wp.array2d(dtype=vec3),
        io_light: wp.array(dtype=vec3),
        io_s: wp.array(dtype=vec3),
    ):
        """Turn the frame to many normals, one after the other."""
        i = wp.tid()
        light = io_light[i]
        s = io_s[i]
        for j in range(normals.shape[1]):
            light, s = turn_frame(light, s, directions[i], normals[i, j])
        io_light[i] = light
        io_s[i] = s

    @wp.kernel(**options)
    def stand(
        directions: wp.array(dtype=vec3), ups: wp.array(dtype=vec3), out_s: wp.array(dtype=vec3)
    ):
        i = wp.tid()
        out_s[i] = frame_across(directions[i], ups[i])

    return SimpleNamespace(meet=meet, turn=turn, stand=stand, types=types)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def eps(precision):
    return float(np.finfo(precision).eps)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_light(precision, *, seed=3, closest=0.05):
    """Directions, normals that face them, frames, and fields E of unit flux across the ray."""
    rng = np.random.default_rng(seed)
    direction, normal = unit(rng.normal(size=(2, COUNT, 3))).astype(precision).astype(np.float64)
    direction, normal = unit(direction), unit(normal)
    cosine = np.sum(direction * normal, axis=1)
    normal = -np.sign(cosine)[:, None] * normal
    direction = np.where((np.abs(cosine) < closest)[:, None], -normal, direction)  # some are 0°
    s = unit(np.cross(direction, unit(rng.normal(size=(COUNT, 3)))))
    a, b, c, d = unit(rng.normal(size=(COUNT, 4))).T
    field = (a + 1j * b)[:, None] * s + (c + 1j * d)[:, None] * np.cross(direction, s)
    return direction, normal, s, field


def stokes(field, s, direction):
    """(I, Q, U, V) of fields in frames, (n, 4): I + Q = 2|E_s|², U + iV = 2 E_s E_p*."""
    along = np.sum(field * s, axis=1)
    across = np.sum(field * np.cross(direction, s), axis=1)
    mixed = 2.0 * along * np.conj(across)
    flux_s, flux_p = np.abs(along) ** 2, np.abs(across) ** 2
    return np.stack([flux_s + flux_p, flux_s - flux_p, mixed.real, mixed.imag], axis=1)


def split_field(direction, normal, field, eta, k):
    """The field reflected and the one let through, and their directions.

    Amplitudes t_s = 1 + r_s, t_p = η(1 + r_p), times the root of the flux's factor, of a field
    that is split along s = d × n and p = d × s (Born & Wolf 1999, §1.5.2).
    """
    cos_i = -np.sum(direction * normal, axis=1)
    across = np.cross(direction, normal)
    size = np.linalg.norm(across, axis=1, keepdims=True)
    s = np.where(size > 0.0, across / np.where(size > 0.0, size, 1.0), unit(
        np.cross(direction, [0.3, -0.7, 0.64])
    ))  # fmt: skip
    r_s, r_p = expected_amplitudes(cos_i, 1.0, eta + 1j * k if k else 1.0 / eta)
    e_s = np.sum(field * s, axis=1)
    e_p = np.sum(field * np.cross(direction, s), axis=1)
    reflected = direction + 2.0 * cos_i[:, None] * normal
    cos_t = np.sqrt(np.maximum(1.0 - eta * eta * (1.0 - cos_i * cos_i), 0.0))
    refracted = eta * direction + (eta * cos_i - cos_t)[:, None] * normal
    root = np.sqrt(cos_t / (eta * cos_i))
    both = []
    for way, a_s, a_p in (
        (reflected, r_s, r_p),
        (refracted, root * (1.0 + r_s), root * eta * (1.0 + r_p)),
    ):
        both.append((a_s * e_s)[:, None] * s + (a_p * e_p)[:, None] * np.cross(way, s))
    return both, (reflected, refracted)


def launch_meet(precision, direction, normal, light, s, eta, k=0.0, sign=1.0):
    """(n, 2) shares, (n, 2, 3) light, (n, 3) frames and (n, 2, 3) directions, all float64."""
    probes = make_probes(precision)
    real, vec3 = probes.types.real, probes.types.vec3
    io_light = wp.array(np.stack([light, light], axis=1), dtype=vec3, device="cpu")
    io_s = wp.array(s, dtype=vec3, device="cpu")
    shares = wp.zeros((len(s), 2), dtype=real, device="cpu")
    ways = wp.zeros((len(s), 2), dtype=vec3, device="cpu")
    inputs = [wp.array(a, dtype=vec3, device="cpu") for a in (direction, normal)]
    wp.launch(
        probes.meet, dim=len(s), inputs=[*inputs, real(eta), real(k), real(sign), io_light, io_s],
        outputs=[shares, ways], device="cpu",
    )  # fmt: skip
    return [a.numpy().astype(np.float64) for a in (shares, io_light, io_s, ways)]


def rounding(precision, direction, normal, eta, k):
    """What rounding may do to a Stokes vector at a surface, (n,).

    As for the reflectances (test_dielectric): next to the critical angle, cosθₜ has an error of
    ε/cosθₜ. The frame and the sums are some ten roundings more.
    """
    cos_i = np.sum(direction * normal, axis=1)
    distance = 1.0 if k else np.abs(1.0 - eta * eta * (1.0 - cos_i * cos_i))
    return eps(precision) * (40.0 + 20.0 * max(eta, 1.0) ** 2 / distance)


SURFACES = {
    "into glass": (1.0 / 1.5, 0.0),
    "out of glass": (1.5, 0.0),  # two thirds of the directions are reflected totally
    "out of diamond": (2.42, 0.0),
    "gold": (0.37, 2.82),
    "iron": (2.9, 3.1),
}


@pytest.mark.parametrize("surface", SURFACES)
def test_stokes_vectors_are_those_of_the_field(precision, surface):
    eta, k = SURFACES[surface]
    direction, normal, s, field = random_light(precision)
    light = stokes(field, s, direction)[:, 1:]
    shares, after, frames, _ = launch_meet(precision, direction, normal, light, s, eta, k)
    fields, expected_ways = split_field(direction, normal, field, eta, k)
    tolerance = rounding(precision, direction, normal, eta, k)
    for branch in (0,) if k else (0, 1):
        expected = stokes(fields[branch], frames, expected_ways[branch])
        found = shares[:, branch, None] * np.c_[np.ones(len(s)), after[:, branch]]
        error = np.max(np.abs(found - expected), axis=1)
        assert np.all(error <= tolerance), (branch, np.max(error / tolerance))


@pytest.mark.parametrize("surface", SURFACES)
def test_frames_stay_across_the_ray(precision, surface):
    eta, k = SURFACES[surface]
    direction, normal, s, field = random_light(precision)
    light = stokes(field, s, direction)[:, 1:]
    _, _, frames, ways = launch_meet(precision, direction, normal, light, s, eta, k)
    tolerance = 8.0 * eps(precision)
    np.testing.assert_allclose(np.linalg.norm(frames, axis=1), 1.0, rtol=0, atol=tolerance)
    for vectors in (normal, ways[:, 0], ways[:, 1]):
        oblique = np.linalg.norm(np.cross(direction, normal), axis=1) > 0.0
        along = np.sum(frames * vectors, axis=1)[oblique]
        np.testing.assert_allclose(along, 0.0, rtol=0, atol=tolerance)


def test_a_frame_stands_as_upright_as_it_can(precision):
    direction, up, _, _ = random_light(precision)
    up[:4] = direction[:4]  # along the ray: any frame will do
    up[4:8] = unit(direction[4:8] + 1e-2 * up[4:8])  # nearly
    probes = make_probes(precision)
    vec3 = probes.types.vec3
    out = wp.zeros(COUNT, dtype=vec3, device="cpu")
    inputs = [wp.array(a, dtype=vec3, device="cpu") for a in (direction, up)]
    wp.launch(probes.stand, dim=COUNT, inputs=inputs, outputs=[out], device="cpu")
    s = out.numpy().astype(np.float64)
    np.testing.assert_allclose(np.linalg.norm(s, axis=1), 1.0, atol=8.0 * eps(precision))
    np.testing.assert_allclose(np.sum(s * direction, axis=1), 0.0, atol=8.0 * eps(precision))
    across = up - direction * np.sum(up * direction, axis=1)[:, None]
    length = np.linalg.norm(across[4:], axis=1)
    known = length > 1e-3  # the probe's threshold; at normal incidence `up` is along the ray
    nearest = across[4:][known] / length[known, None]
    # The difference that `across` is has roundings of the size of `up`.
    error = np.linalg.norm(s[4:][known] - nearest, axis=1)
    assert np.all(error <= 8.0 * eps(precision) / length[known])


def test_turning_the_frame_does_not_turn_the_light(precision):
    direction, _, s, field = random_light(precision)
    rng = np.random.default_rng(8)
    normals = unit(rng.normal(size=(COUNT, 100, 3)))
    normals[:, ::7] = direction[:, None, :]  # normal incidence among them, but for rounding
    probes = make_probes(precision)
    vec3 = probes.types.vec3
    light = wp.array(stokes(field, s, direction)[:, 1:], dtype=vec3, device="cpu")
    frames = wp.array(s, dtype=vec3, device="cpu")
    inputs = [wp.array(direction, dtype=vec3, device="cpu"),
              wp.array(normals, dtype=vec3, device="cpu")]  # fmt: skip
    wp.launch(probes.turn, dim=COUNT, inputs=[*inputs, light, frames], device="cpu")
    turned = frames.numpy().astype(np.float64)
    # A hundred turns of a few roundings each.
    tolerance = 100 * 8.0 * eps(precision)
    np.testing.assert_allclose(np.sum(turned * direction, axis=1), 0.0, atol=tolerance)
    expected = stokes(field, turned, direction)[:, 1:]
    np.testing.assert_allclose(light.numpy(), expected, rtol=0, atol=tolerance)


def test_turning_mends_the_frames_length(precision):
    # A Newton step: |s| = 1 + e becomes 1 − 3e²/2 − e³/2.
    direction, normal, s, field = random_light(precision)
    oblique = np.linalg.norm(np.cross(direction, normal), axis=1) > 0.0
    light = stokes(field, s, direction)[:, 1:]
    _, _, frames, _ = launch_meet(precision, direction, normal, light, 1.001 * s, 1.5)
    expected = 1.0 - 1.5e-6 - 0.5e-9
    length = np.linalg.norm(frames, axis=1)[oblique]
    np.testing.assert_allclose(length, expected, rtol=0, atol=8.0 * eps(precision))


def test_at_normal_incidence_the_frame_stays(precision):
    direction = np.array([[0.0, 0.0, -1.0]])
    s, light = np.array([[0.6, 0.8, 0.0]]), np.array([[0.3, -0.5, 0.7]])
    shares, after, frames, _ = launch_meet(precision, direction, -direction, light, s, 1.0 / 1.5)
    np.testing.assert_array_equal(frames, s.astype(precision))
    assert shares[0, 0] == pytest.approx(0.04, abs=eps(precision))
    # Reflected at r_s = −r_p: the diagonals and the handedness change their signs.
    np.testing.assert_allclose(after[0, 0], [0.3, 0.5, -0.7], atol=8.0 * eps(precision))
    np.testing.assert_allclose(after[0, 1], [0.3, -0.5, 0.7], atol=8.0 * eps(precision))


def test_p_light_at_brewsters_angle_is_not_reflected(precision):
    theta = np.arctan(1.5)
    direction = np.array([[np.sin(theta), -np.cos(theta), 0.0]])
    normal = np.array([[0.0, 1.0, 0.0]])
    s = np.array([[0.0, 0.0, 1.0]])
    of_p, of_s = np.array([[-1.0, 0.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])
    shares, after, _, _ = launch_meet(precision, direction, normal, of_p, s, 1.0 / 1.5)
    assert shares[0, 0] == pytest.approx(0.0, abs=eps(precision))
    assert np.all(np.isfinite(after))
    # R_s = ((n² − 1)/(n² + 1))² (Born & Wolf 1999, §1.5.3).
    shares, _, _, _ = launch_meet(precision, direction, normal, of_s, s, 1.0 / 1.5)
    assert shares[0, 0] == pytest.approx((1.25 / 3.25) ** 2, abs=8.0 * eps(precision))


@pytest.mark.parametrize("case", [(1.0, 0.0), (1.0 / 1.5, 0.0), (1.5, 0.0)])
def test_grazing_light_and_equal_media(precision, case):
    eta, k = case
    direction, normal = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 1.0, 0.0]])
    light, s = np.array([[0.5, 0.5, 0.5]]), np.array([[0.0, 0.0, 1.0]])
    shares, after, _, _ = launch_meet(precision, direction, normal, light, s, eta, k)
    if eta == 1.0:
        np.testing.assert_array_equal(shares[0], [0.0, 1.0])
        np.testing.assert_allclose(after[0, 1], light[0], atol=4.0 * eps(precision))
    else:
        np.testing.assert_array_equal(shares[0], [1.0, 0.0])
        np.testing.assert_allclose(after[0, 0], light[0], atol=4.0 * eps(precision))


@pytest.mark.parametrize("surface", SURFACES)
def test_the_eye_sees_what_the_lamp_sends(precision, surface):
    """wᵀ M S is the same whether M is applied to the light or, transposed, to the eye.

    Light goes along d and is reflected to d'; the eye's path comes along −d' and is reflected to
    −d, with w in the same frames about its own directions: there U and V have other signs.
    """
    eta, k = SURFACES[surface]
    direction, normal, s, field = random_light(precision)
    reflected = direction - 2.0 * np.sum(direction * normal, axis=1)[:, None] * normal
    light = stokes(field, s, direction)[:, 1:]
    rng = np.random.default_rng(9)
    seen = 0.9 * unit(rng.normal(size=(COUNT, 3)))
    eye_s = unit(np.cross(reflected, unit(rng.normal(size=(COUNT, 3)))))
    there, arriving, frames, _ = launch_meet(precision, direction, normal, light, s, eta, k)
    back, looking, eye_frames, _ = launch_meet(
        precision, -reflected, normal, seen, eye_s, eta, k, sign=-1.0
    )
    swap = np.array([1.0, -1.0, -1.0])
    forward = there[:, 0] * (
        1.0 + np.sum(seen * swap * in_frame(arriving[:, 0], frames, reflected, eye_s), axis=1)
    )
    backward = back[:, 0] * (
        1.0 + np.sum(looking[:, 0] * swap * in_frame(light, s, direction, eye_frames), axis=1)
    )
    tolerance = 2.0 * rounding(precision, direction, normal, eta, k)
    assert np.all(np.abs(forward - backward) <= tolerance)


def in_frame(light, s, direction, new_s):
    """(q, u, v) in another frame about the same direction."""
    cosine = np.sum(new_s * s, axis=1)
    sine = np.sum(new_s * np.cross(direction, s), axis=1)
    cos2, sin2 = cosine**2 - sine**2, 2.0 * cosine * sine
    q, u, v = light.T
    return np.stack([q * cos2 + u * sin2, u * cos2 - q * sin2, v], axis=1)
