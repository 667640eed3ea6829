"""The thinnest and the thickest, the flattest and the steepest; scenes of any size, anywhere.

Errors of angles are stated in ε, the spacing of the precision's numbers at 1.
"""

import math

import mpmath
import numpy as np
import pytest

import scenes
from sim import analytic

ETA = 1.5
mpmath.mp.dps = 60


def angle_of(path):
    return float(analytic.angle_between(path.directions[0], path.directions[-1]))


# --- prisms ------------------------------------------------------------------------------------


def prism_deviation(apex, theta_i, eta):
    """θ_i + θ_e − A, sinθ_e = η sin(A − θ_t) (Born & Wolf 1999, §4.7.2), in 60 digits."""
    apex, theta_i = mpmath.mpf(apex), mpmath.mpf(theta_i)
    inside = mpmath.asin(mpmath.sin(theta_i) / eta)
    return float(theta_i + mpmath.asin(eta * mpmath.sin(apex - inside)) - apex)


@pytest.mark.parametrize("apex_deg", [1e-6, 1e-4, 1e-2, 1.0])
@pytest.mark.parametrize("theta_i", [0.0, 0.3, -0.3, 1.2, -1.3])
def test_the_sharpest_prisms_deviate_as_their_formula_says(
    follow, solid, precision, eps, apex_deg, theta_i
):
    # Deviations are differences of directions: known to some ε of 1, however small they are, and
    # where light leaves at θ_e, to 1/cosθ_e times that.
    apex = math.radians(apex_deg)
    shape = scenes.Prism(
        position=(0, 0, 0), apex_deg=apex_deg, base=0.1, length=1.0, height=0.8
    )
    half = 0.5 * apex
    inward = np.array([math.cos(half), -math.sin(half), 0.0])  # normal of the left face
    along = np.array([math.sin(half), math.cos(half), 0.0])  # toward the apex
    way = math.cos(theta_i) * inward + math.sin(theta_i) * along
    start = np.array([0.4 * math.tan(half) - 0.05, 0.0, 0.0]) - 0.2 * way
    (path,) = follow([solid(shape, ETA)], start, way, precision=precision)
    assert path.events == ("refract", "refract", "escape")
    expected = prism_deviation(apex, theta_i, ETA)
    tolerance = 8.0 * eps[precision] / min(math.cos(theta_i), math.cos(theta_i - abs(expected)))
    assert angle_of(path) == pytest.approx(abs(expected), rel=0, abs=tolerance)


# --- plates ------------------------------------------------------------------------------------


@pytest.mark.parametrize("thickness", [1e-9, 1e-6, 1e-3, 1.0, 1e3])
@pytest.mark.parametrize("theta_i", [0.0, 0.5, 1.5])
def test_plates_of_a_nanometre_and_a_kilometre(follow, solid, precision, eps, thickness, theta_i):
    plate = scenes.Box(position=(0, 0, 0), size=(2e4, thickness, 2e4))
    way = np.array([math.sin(theta_i), -math.cos(theta_i), 0.0])
    (path,) = follow(
        [solid(plate, ETA)], -0.75 * thickness / math.cos(theta_i) * way, way, precision=precision
    )
    assert path.events == ("refract", "refract", "escape")
    np.testing.assert_allclose(path.directions[-1], way, rtol=0, atol=8 * eps[precision])
    # Lateral shift t sinθ (1 − cosθ/√(η² − sin²θ)) (Born & Wolf 1999, §1.5.1): from point to
    # point, relative to the thickness, since the plate is the whole scene.
    chord = path.points[2] - path.points[1]
    shift = np.linalg.norm(chord - np.dot(chord, way) * way)
    expected = float(analytic.plate_lateral_shift(theta_i, ETA, thickness))
    slack = 16 * eps[precision] * thickness / math.cos(theta_i)
    assert shift == pytest.approx(expected, rel=0, abs=slack)


# --- lenses ------------------------------------------------------------------------------------


def plano_convex(radius):
    """Of 1 mm² or so, 0.2 mm thick; flat where the radius is infinite."""
    first = {"curvature": 0.0} if math.isinf(radius) else {"radius": radius}
    return scenes.Lens(
        position=(0, 0, 1e-4), axis=(0, 0, 1), thickness=2e-4, aperture=4e-4,
        first=scenes.LensSurface(**first), second=scenes.LensSurface(curvature=0.0),
    )  # fmt: skip


HEIGHT = 1e-4


def deviation_of_sphere(radius, height):
    """Of light along the axis: refracted by a sphere at h = R sinθ, then by a plane."""
    if math.isinf(radius):
        return 0.0
    theta = mpmath.asin(mpmath.mpf(height) / radius)
    inside = theta - mpmath.asin(mpmath.sin(theta) / ETA)
    return float(mpmath.asin(ETA * mpmath.sin(inside)))


RADII = [1e-3, 1e-2, 1.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, math.inf]


@pytest.mark.parametrize("radius", RADII)
def test_lenses_from_a_millimetre_to_a_plane_refract_as_spheres(
    follow, solid, precision, eps, radius
):
    for sign in (1.0, -1.0):
        shape = plano_convex(sign * radius)
        (path,) = follow(
            [solid(shape, ETA)], (HEIGHT, 0, -1e-3), (0, 0, 1), precision=precision
        )
        assert path.events == ("refract", "refract", "escape")
        expected = sign * deviation_of_sphere(radius, HEIGHT)
        # Directions known to some ε; the height in the beam to ε of the scene, 1e-3, over the
        # radius. On the axis' way, −x is toward it.
        slack = eps[precision] * (8.0 + 8.0 * 1e-3 / radius)
        assert -path.directions[-1][0] == pytest.approx(math.sin(expected), rel=0, abs=slack)
        sag = HEIGHT**2 / radius / (1.0 + math.sqrt(1.0 - (HEIGHT / radius) ** 2))
        assert path.points[1][2] == pytest.approx(sign * sag, rel=0, abs=8e-3 * eps[precision])


def test_as_the_radius_grows_nothing_jumps(follow, solid, precision, eps):
    # Successive radii differ by 10 %: from the one at which the formula's deviation is below ε on,
    # all the directions are one.
    radii = 1e-3 * 1.1 ** np.arange(290)
    ends = []
    for radius in [*radii[::7], math.inf]:
        (path,) = follow(
            [solid(plano_convex(radius), ETA)], (HEIGHT, 0, -1e-3), (0, 0, 1),
            precision=precision,
        )  # fmt: skip
        ends.append(-path.directions[-1][0])
    expected = [math.sin(deviation_of_sphere(r, HEIGHT)) for r in [*radii[::7], math.inf]]
    np.testing.assert_allclose(ends, expected, rtol=0, atol=16 * eps[precision])
    assert ends[-1] == 0.0


# --- scale and place ---------------------------------------------------------------------------

COUNT = 400


def bench(solid, scale=1.0, shift=(0.0, 0.0, 0.0)):
    """A lens, a turned prism and a ball, one after another; sizes of `scale`."""

    def at(x, y, z):
        return tuple((np.array([x, y, z]) * scale + shift).tolist())

    return [
        solid(
            scenes.Lens(
                position=at(-0.6, 0, 0), axis=(1, 0.1, 0), thickness=0.15 * scale,
                aperture=0.5 * scale, first=scenes.LensSurface(radius=0.8 * scale, conic=-0.5),
                second=scenes.LensSurface(curvature=-0.5 / scale),
            ),
            1.5, "lens",
        ),
        solid(
            scenes.Prism(
                position=at(0, 0, 0), apex_deg=40.0, base=0.5 * scale, length=0.7 * scale,
                rotation_deg=(4.0, 8.0, 12.0),
            ),
            1.7, "prism",
        ),
        solid(scenes.Sphere(position=at(0.7, 0, 0), radius=0.35 * scale), 1.33, "ball"),
    ]  # fmt: skip


def rays(scale=1.0, shift=(0.0, 0.0, 0.0)):
    rng = np.random.default_rng(31)
    starts = np.column_stack([np.full(COUNT, -1.0), rng.uniform(-0.2, 0.2, (COUNT, 2))])
    ways = np.column_stack([np.ones(COUNT), rng.uniform(-0.1, 0.1, (COUNT, 2))])
    return starts * scale + np.asarray(shift), ways


def assert_same(before, after, tolerance):
    """The same events, but where an edge or the critical angle lies within the tolerance."""
    same = [a.events == b.events and a.objects == b.objects
            for a, b in zip(before, after, strict=True)]  # fmt: skip
    # Rays are spread over 0.4 by 0.4; a strip of the tolerance along some ten edges and critical
    # curves of length 1 holds at most this many of them, and one by chance.
    assert np.sum(np.logical_not(same)) <= 1 + COUNT * 10 * tolerance / 0.4**2
    errors = [
        np.abs(a.directions[-1] - b.directions[-1]).max()
        for a, b, one in zip(before, after, same, strict=True) if one
    ]  # fmt: skip
    # Six to ten refractions, of which each may enlarge an error: twice on average, ten times where
    # light leaves at a steep angle, so that one ray in a hundred is let off a further factor 100.
    assert np.quantile(errors, 0.99) <= 64 * tolerance
    assert np.max(errors) <= 6400 * tolerance


@pytest.fixture(scope="module")
def at_home(follow, solid):
    return {
        name: follow(bench(solid), *rays(), precision=name, max_interactions=16)
        for name in ("float64", "float32")
    }


@pytest.mark.parametrize("scale", [1e-8, 1e-6, 1e-3, 1e3, 1e6, 1e9, 2.0**-26, 2.0**29])
def test_scenes_of_any_size_are_alike(follow, solid, at_home, precision, eps, scale):
    # 1e-8 m, since no part of the bench may be smaller than a nanometre.
    paths = follow(bench(solid, scale), *rays(scale), precision=precision, max_interactions=16)
    power_of_two = math.frexp(scale)[0] == 0.5
    if power_of_two:
        for before, after in zip(at_home[precision], paths, strict=True):
            assert before.events == after.events
            np.testing.assert_array_equal(before.directions, after.directions)
    assert_same(at_home[precision], paths, eps[precision])
    for path in paths:
        assert np.all(np.isfinite(path.points))


@pytest.mark.parametrize("distance", [1e3, 1e6, 9e8])
def test_a_billion_sizes_from_the_origin_only_the_descriptions_digits_are_lost(
    follow, solid, at_home, precision, eps, distance
):
    # Positions are float64 numbers of `distance`: they are rounded by ε/2 of that before anything
    # is traced, in either precision; the local frame adds nothing.
    shift = distance * np.array([0.6, -0.7, 0.3])
    paths = follow(
        bench(solid, 1.0, shift), *rays(1.0, shift), precision=precision, max_interactions=16
    )
    tolerance = eps[precision] + distance * eps["float64"]
    assert_same(at_home[precision], paths, tolerance)


@pytest.mark.parametrize("distance", [1e3, 1e6, 1e9])
def test_rays_from_afar_meet_what_they_are_aimed_at(follow, solid, precision, eps, distance):
    # A ray that starts `distance` radii away knows where it is to ε of that. Once that is a part
    # of the ball there is no right answer left, but one all the same: a path of finite numbers,
    # whose directions are unit vectors.
    ball = solid(scenes.Sphere(position=(0, 0, 0), radius=1.0), ETA)
    rng = np.random.default_rng(32)
    way = rng.normal(size=(200, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    aims = rng.uniform(-0.5, 0.5, (200, 3))
    starts = aims - distance * way
    paths = follow([ball], starts, way, precision=precision, max_interactions=8)
    known = eps[precision] * distance
    for path, one in zip(paths, way, strict=True):
        assert np.all(np.isfinite(path.points))
        norms = np.linalg.norm(path.directions, axis=1)
        np.testing.assert_allclose(norms, 1.0, rtol=0, atol=4 * eps[precision])
        assert np.all((path.reflectances >= 0.0) & (path.reflectances <= 1.0))
        if known > 1e-3:
            continue
        assert path.events == ("refract", "refract", "escape")
        # δ = 2 (θ − asin(sinθ/η)), sinθ the distance of the ray from the centre over R.
        start = path.points[0]
        sine = np.linalg.norm(np.cross(start, one))
        # As one knows them, b = |o × d| is off by a rounding of the start.
        expected = 2.0 * (math.asin(sine) - math.asin(sine / ETA))
        assert angle_of(path) == pytest.approx(expected, rel=0, abs=8.0 * (known + eps[precision]))
