"""What is true of every prism, lens and stack of plates: Snell, Fresnel, Helmholtz, Liouville.

Hypothesis draws the glass; its examples are the same in every run.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import scenes
from sim import analytic

EPS = float(np.finfo(np.float64).eps)
FEW = settings(derandomize=True, max_examples=25, deadline=None)
RAYS = 40

indices = st.sampled_from([1.0 + 1e-9, 1.0 + 1e-4, 1.2, 1.33, 1.5, 2.4, 4.0])
angles = st.floats(0.0, 360.0)
turns = st.tuples(angles, angles, angles)


@st.composite
def prisms(draw):
    return scenes.Prism(
        position=(0, 0, 0), apex_deg=draw(st.floats(1.0, 150.0)), base=draw(st.floats(0.1, 3.0)),
        length=draw(st.floats(0.1, 3.0)), rotation_deg=draw(turns),
    )  # fmt: skip


@st.composite
def lenses(draw):
    curvatures = st.one_of(st.just(0.0), st.floats(-0.9, 0.9))
    conics = st.sampled_from([0.0, -1.0, -2.25, 0.5])
    surfaces = [
        scenes.LensSurface(curvature=draw(curvatures), conic=draw(conics)) for _ in range(2)
    ]
    try:
        return scenes.Lens(
            position=(0, 0, 0), axis=(0, 0, 1), thickness=draw(st.floats(0.01, 1.5)),
            aperture=draw(st.floats(0.2, 1.6)), first=surfaces[0], second=surfaces[1],
        )  # fmt: skip
    except scenes.SceneError:
        assume(False)
        raise


solids = st.one_of(prisms(), lenses())


def rays_at(shape, seed, count=RAYS):
    """From all around, at points of the inner half of the solid's bounding sphere."""
    rng = np.random.default_rng(seed)
    centre, radius = shape.bounding_sphere()
    starts = rng.normal(size=(count, 3))
    starts *= 3.0 * radius / np.linalg.norm(starts, axis=1, keepdims=True)
    ways = rng.uniform(-0.3, 0.3, (count, 3)) * radius - starts
    return centre + starts, ways / np.linalg.norm(ways, axis=1, keepdims=True)


def vertices(path, eta):
    """(event, d before, d after, normal toward the ray, η_i, η_t, R) of each boundary met."""
    inside = False
    for k, event in enumerate(path.events[:-1]):
        eta_i, eta_t = (eta, 1.0) if inside else (1.0, eta)
        yield (
            event, path.directions[k], path.directions[k + 1], path.normals[k], eta_i, eta_t,
            path.reflectances[k],
        )  # fmt: skip
        inside ^= event == "refract"


@FEW
@given(solids, indices, st.integers(0, 2**32 - 1))
def test_snell_and_fresnel_hold_at_every_vertex(follow, solid, shape, eta, seed):
    paths = follow([solid(shape, eta)], *rays_at(shape, seed), max_interactions=12)
    for path in paths:
        for event, before, after, normal, eta_i, eta_t, reflectance in vertices(path, eta):
            cosine = -float(before @ normal)
            assert cosine >= 0.0
            if event == "refract":
                # η_i d × n = η_t d' × n, vectors of length 1 rounded by some ε.
                jump = eta_i * np.cross(before, normal) - eta_t * np.cross(after, normal)
                assert np.max(np.abs(jump)) <= 8 * EPS * max(eta_i, eta_t)
                assert float(after @ normal) <= 0.0
            else:
                expected = before + 2.0 * cosine * normal
                np.testing.assert_allclose(after, expected, rtol=0, atol=8 * EPS)
                assert event == "total internal reflection"
                sine = math.sqrt((1.0 - min(cosine, 1.0)) * (1.0 + cosine))
                assert sine >= eta_t / eta_i * (1.0 - 8 * EPS)
            if event == "refract" and path.events[0] == "refract" and cosine > 0.0:
                assert 0.0 <= reflectance <= 1.0
        # The first boundary meets natural light: R is the mean of R_s and R_p. It is as sharp as
        # cosθ_t is known, whose square is rounded by ε.
        if path.events[0] == "refract":
            cosine = -float(path.directions[0] @ path.normals[0])
            r_s, r_p = analytic.fresnel_reflectance(min(cosine, 1.0), 1.0, eta)
            expected = 0.5 * float(r_s + r_p)
            assert path.reflectances[0] == pytest.approx(expected, rel=0, abs=32 * EPS / cosine)


@FEW
@given(solids, indices, st.integers(0, 2**32 - 1))
def test_the_branches_of_every_split_share_the_light(follow, solid, shape, eta, seed):
    # R + T = 1: the flux of the four paths that two splits make, "limit" counting as all that is
    # left, is that of the ray. A solid can send what it reflects back to itself.
    starts, ways = rays_at(shape, seed)
    objects = [solid(shape, eta)]
    choices = [[a, b] for a in ("refract", "reflect") for b in ("refract", "reflect")]
    four = [follow(objects, starts, ways, max_interactions=3, branches=one) for one in choices]
    for paths in zip(*four, strict=True):
        # Where there was no second choice, because reflection was total or nothing was met, two of
        # the paths are one.
        different = {path.events: path for path in paths}
        total = sum(path.transmittance for path in different.values())
        assert total == pytest.approx(1.0, abs=8 * EPS)


@FEW
@given(solids, indices, st.integers(0, 2**32 - 1))
def test_every_way_is_its_way_back(follow, solid, shape, eta, seed):
    objects = [solid(shape, eta)]
    paths = follow(objects, *rays_at(shape, seed), max_interactions=12)
    # Those that come near grazing or critical incidence enlarge rounding by 1/cosθ_t; they may be
    # met by one surface more or less on the way back.
    steady = [
        path for path in paths
        if path.events[-1] == "escape" and len(path.events) > 2
        and all(abs(float(d @ n)) > 0.05
                for way in (path.directions[:-1], path.directions[1:])
                for d, n in zip(way, path.normals, strict=False))
    ]  # fmt: skip
    assume(steady)
    ends = np.array([path.points[-2] + path.directions[-1] for path in steady])
    back = np.array([-path.directions[-1] for path in steady])
    for forth, reverse in zip(
        steady, follow(objects, ends, back, max_interactions=12), strict=True
    ):
        assert reverse.events[:-1] == forth.events[:-1][::-1]
        # Up to 12 surfaces, each enlarging what is before it up to 20 η times at cosθ = 0.05, but
        # twice on average; the glass is some units wide.
        off = np.abs(reverse.directions[-1] + forth.directions[0]).max()
        assert off <= 1e5 * EPS * eta
        if len(forth.events) == 3:
            # Natural light that is refracted twice: Helmholtz.
            slack = slack_of_transmittance(forth, reverse, eta)
            assert reverse.transmittance == pytest.approx(forth.transmittance, abs=slack)


def slack_of_transmittance(forth, reverse, eta):
    """How far T of a way through glass and of its way back may be apart by rounding.

    With a = η_i cosθ_i, b = η_t cosθ_t and Snell's law, cosθ_t' = (η_i/η_t)² cosθ_i/cosθ_t,

        |∂R_s/∂cosθ_i| ≤ 4 (b a' + a b')/(a + b)² ≤ a'/a + b'/b = 1/cosθ_i + cosθ_t'/cosθ_t,

    as 4 a b ≤ (a + b)²; R_p has η_t cosθ_i and η_i cosθ_t in their place, with the same ratios. The
    cosines of both ways are known, each to 4 ε; T and R take some 16 ε more.
    """
    slack = 16 * EPS
    for k, (eta_i, eta_t) in enumerate(((1.0, eta), (eta, 1.0))):
        cosine_i, cosine_t = (
            abs(float(way @ reverse.normals[k])) for way in reverse.directions[k : k + 2]
        )
        left = abs(float(forth.directions[2 - k] @ forth.normals[1 - k]))
        steepness = 1.0 / cosine_i + (eta_i / eta_t) ** 2 * cosine_i / cosine_t**2
        slack += steepness * (abs(cosine_i - left) + 8 * EPS)
    return slack


def plane_map(follow, objects, states, z, *, inside):
    """(x, y, p, q) of light along z, p and q its direction cosines times the index, from z = −z.

    Returns (n, 4) at the plane z, or at 0 inside the glass, and which of them came straight.
    """
    x, y, p, q = states.T
    ways = np.column_stack([p, q, np.sqrt(1.0 - p * p - q * q)])
    starts = np.column_stack([x, y, np.full(len(x), -z)])
    paths = follow(objects, starts, ways, max_interactions=4)
    k = 1 if inside else -1
    events = ("refract", "refract", "escape")
    straight = np.array([path.events == events for path in paths])
    points = np.array([path.points[1 if inside else min(2, len(path.points) - 1)]
                       for path in paths])  # fmt: skip
    ends = np.array([path.directions[k] for path in paths])
    reach = ((0.0 if inside else z) - points[:, 2]) / ends[:, 2]
    return np.column_stack([(points + reach[:, None] * ends)[:, :2], ends[:, :2]]), straight


OMEGA = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])


@FEW
@given(lenses(), st.sampled_from([1.2, 1.5, 2.4, 4.0]), st.integers(0, 2**32 - 1))
def test_glass_keeps_etendue(follow, solid, shape, eta, seed):
    # Hamilton: the map of (x, y, η p, η q) from plane to plane is symplectic, JᵀΩJ = Ω, so that
    # dx dy η² dp dq, the étendue, is conserved (Born & Wolf 1999, §4.8.3; Welford 1986, §5.4). By
    # central differences of h: off by h²/6 of the third derivatives and ε/h.
    rng = np.random.default_rng(seed)
    rays, h, z = 10, 1e-4, 3.0
    rim = 0.2 * shape.aperture
    middle = np.column_stack([
        rng.uniform(-rim, rim, (rays, 2)), rng.uniform(-0.02, 0.02, (rays, 2)),
    ])  # fmt: skip
    # Rays through the middle of the lens, not of the first plane.
    middle[:, :2] -= z * middle[:, 2:]
    steps = h * np.vstack([np.eye(4), -np.eye(4)])
    states = (middle[:, None] + steps[None]).reshape(-1, 4)
    objects = [solid(shape, eta)]
    for inside in (False, True):
        ends, straight = plane_map(follow, objects, states, z, inside=inside)
        ends = ends.reshape(rays, 2, 4, 4)
        straight = straight.reshape(rays, 8).all(axis=1)
        jacobians = np.swapaxes(ends[:, 0] - ends[:, 1], 1, 2) / (2.0 * h)
        if inside:
            jacobians[:, 2:] *= eta
        assume(straight.any())
        for jacobian in jacobians[straight]:
            size = np.abs(jacobian).max()
            # Third derivatives are as large as the curvatures' powers: (η c)³ · z of some 100.
            slack = 1e3 * h**2 * max(1.0, size) ** 2 + 1e3 * EPS / h * max(1.0, size)
            np.testing.assert_allclose(jacobian.T @ OMEGA @ jacobian, OMEGA, rtol=0, atol=slack)
            assert np.linalg.det(jacobian) == pytest.approx(1.0, abs=4 * slack * max(1.0, size))


@FEW
@given(
    st.lists(indices, min_size=3, max_size=3, unique=True),
    st.lists(st.floats(1e-6, 1.0), min_size=3, max_size=6),
    st.floats(0.0, 1.5), st.floats(0.0, 6.0),
)  # fmt: skip
def test_a_stack_of_plates_turns_no_light_and_keeps_its_books(
    follow, etas, thicknesses, theta, phi
):
    # Straight on behind all of them; the flux is that of s and p apart: ½ Σ Π T_k². Each interface
    # appears twice, by the same two indices. Plates a plate's thickness apart.
    plates = [(etas[k % 3], thickness) for k, thickness in enumerate(thicknesses)]
    objects, y = [], 0.0
    for k, (eta, thickness) in enumerate(plates):
        objects.append(scenes.SceneObject(
            name=f"plate {k}",
            shape=scenes.Box(position=(0, y - 0.5 * thickness, 0), size=(100, thickness, 100)),
            material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=eta)),
        ))  # fmt: skip
        y -= thickness + 0.5
    way = np.array([
        math.sin(theta) * math.cos(phi), -math.cos(theta), math.sin(theta) * math.sin(phi),
    ])  # fmt: skip
    (path,) = follow(objects, -0.1 / math.cos(theta) * way, way, max_interactions=64)
    if "total internal reflection" in path.events:
        raise AssertionError("what has come into a plate comes out of it")
    met = [k for k, event in enumerate(path.events) if event == "refract"]
    assert len(met) == 2 * len(plates)
    cosine = math.cos(theta)
    np.testing.assert_allclose(
        path.directions[-1], way, rtol=0, atol=4 * len(met) * EPS / cosine
    )
    # Light that comes back after a pair of reflections is not on this path.
    shares = np.ones(2)
    for eta, _ in plates:
        faces = analytic.fresnel_reflectance(cosine, 1.0, eta)
        shares *= [(1.0 - float(r)) ** 2 for r in faces]
    expected = float(shares.mean())
    assert path.transmittance == pytest.approx(expected, abs=32 * len(met) * EPS / cosine**2)
