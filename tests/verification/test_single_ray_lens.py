"""Single rays through lenses: the lensmaker's foci, conics that focus exactly, and the rim."""

import math

import numpy as np
import pytest

import scenes
from sim import analytic, trace_ray
from sim.device import start_device
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays
from spectra import glass

EPS = float(np.finfo(np.float64).eps)


def surface(radius, conic=0.0):
    """A radius of inf is a plane."""
    if math.isinf(radius):
        return scenes.LensSurface(curvature=0.0)
    return scenes.LensSurface(radius=radius, conic=conic)


def lens_scene(first, second, thickness, aperture, medium, *, axis=(0.0, 0.0, 1.0)):
    shape = scenes.Lens(
        position=(0.0, 0.0, 0.0), axis=axis, thickness=thickness, aperture=aperture,
        first=first, second=second,
    )  # fmt: skip
    material = scenes.Dielectric(medium=medium)
    return scenes.Scene(objects=[scenes.SceneObject(name="lens", shape=shape, material=material)])


def constant(eta):
    return scenes.ConstantMedium(eta=eta)


def traced(scene, origins, directions, wavelengths_nm=550.0, **options):
    start_device("cpu")
    origins = np.asarray(origins, dtype=np.float64)
    directions = np.broadcast_to(np.asarray(directions, dtype=np.float64), origins.shape)
    wavelengths_nm = np.broadcast_to(np.float64(wavelengths_nm), len(origins)).copy()
    return trace_compiled_rays(
        compile_scene(scene), origins, np.ascontiguousarray(directions), wavelengths_nm,
        **{"max_interactions": 8, **options},
    )  # fmt: skip


LENSES = {
    "biconvex": (0.05, -0.05, 0.005),
    "plano-convex": (0.05, math.inf, 0.004),
    "convex-plano": (math.inf, -0.05, 0.004),
    "meniscus": (0.03, 0.08, 0.006),
    "diverging meniscus": (0.08, 0.03, 0.003),
    "biconcave": (-0.05, 0.07, 0.002),
    "plano-concave": (math.inf, 0.04, 0.003),
    "thick": (0.03, -0.02, 0.045),
}


@pytest.mark.parametrize("name", LENSES)
def test_paraxial_rays_meet_in_the_lensmakers_focus(name):
    # y = h outside, slope u' behind: f = −h/u', and the focus lies −y'/u' behind the vertex.
    r1, r2, thickness = LENSES[name]
    scene = lens_scene(surface(r1), surface(r2), thickness, 0.02, "N-BK7")
    wavelengths_nm = np.array([400.0, 486.1327, 587.5618, 700.0])
    height = 1e-6
    paths = traced(scene, [[0.0, height, -0.05]] * 4, [0.0, 0.0, 1.0], wavelengths_nm)
    eta = glass("N-BK7").eta(wavelengths_nm)
    way = np.array([path.directions[-1] for path in paths])
    slope = way[:, 1] / way[:, 2]
    leaves = np.array([path.points[2] for path in paths])
    focus = leaves[:, 2] - leaves[:, 1] / slope - 0.5 * thickness
    # Third-order aberration is of relative size (h/R)² < 1e-8; ε rounds a slope of 1e-5 by 1e-11.
    expected = analytic.lensmaker_focal_length(eta, r1, r2, thickness)
    np.testing.assert_allclose(-height / slope, expected, rtol=1e-8)
    expected = analytic.lensmaker_back_focal_length(eta, r1, r2, thickness)
    np.testing.assert_allclose(focus, expected, rtol=1e-8)
    # Blue bends more, whichever way.
    assert abs(slope[0]) > abs(slope[-1])


def test_a_lens_without_curvature_is_a_plate():
    scene = lens_scene(surface(math.inf), surface(math.inf), 0.01, 0.04, "N-BK7")
    theta_i = np.radians(np.linspace(-50.0, 50.0, 21))
    ways = np.column_stack([np.zeros(21), np.sin(theta_i), np.cos(theta_i)])
    paths = traced(scene, np.array([0.0, 0.0, -0.005]) - 0.01 * ways, ways)
    eta = glass("N-BK7").eta(550.0)
    for path, angle, way in zip(paths, theta_i, ways, strict=True):
        assert path.events == ("refract", "refract", "escape")
        assert path.deviation < 8.0 * EPS
        # The ray leaves beside where it would have gone, by the plate's shift.
        gap = path.points[2] - path.points[0]
        across = np.array([0.0, math.cos(angle), -math.sin(angle)])
        shift = -float(gap @ across)
        expected = analytic.plate_lateral_shift(angle, eta, 0.01)
        assert shift == pytest.approx(expected, abs=1e-17)
        assert np.allclose(path.directions[-1], way, rtol=0, atol=4.0 * EPS)


@pytest.mark.parametrize("oblique", [0.0, 0.3])
def test_curvature_fades_into_a_plane_without_a_jump(oblique):
    # Small curvatures: the deflection is linear in c, through 0.
    steps = np.geomspace(1e-12, 1e-3, 10)
    curvatures = np.concatenate([-steps[::-1], [0.0], steps])
    slopes = []
    for c in curvatures:
        scene = lens_scene(
            scenes.LensSurface(curvature=float(c)), surface(math.inf), 0.01, 0.04, constant(1.5)
        )
        start = [0.001, 0.01 - 0.045 * oblique, -0.05]  # toward y = 0.01 on the first surface
        (path,) = traced(scene, [start], [0.0, oblique, 1.0])
        assert path.events == ("refract", "refract", "escape")
        slopes.append(path.directions[-1])
    change = np.array(slopes) - slopes[10]
    assert np.array_equal(change[10], np.zeros(3))
    # Straight on, dφ/dc = −(η − 1) y, 0.005 m here; obliquely somewhat more. The next order is
    # smaller by c ρ = 1e-5.
    per_curvature = 0.5 * (change[-1, 1] - change[0, 1]) / curvatures[-1]
    assert -0.01 < per_curvature < -0.0049
    error = np.abs(change[:, 1] - per_curvature * curvatures)
    assert np.all(error <= 4.0 * EPS + 1e-3 * np.abs(per_curvature * curvatures))


def crossing_of_axis(path):
    """Where the last segment comes nearest to the z axis: its height and its distance there."""
    point, way = path.points[-2], path.directions[-1]
    t = -(point[0] * way[0] + point[1] * way[1]) / (way[0] ** 2 + way[1] ** 2)
    nearest = point + t * way
    return nearest[2], math.hypot(nearest[0], nearest[1])


def ring_of_rays(radii, z):
    phi = 1.3 * np.arange(len(radii))
    return np.column_stack([radii * np.cos(phi), radii * np.sin(phi), np.full(len(radii), z)])


@pytest.mark.parametrize("wavelength_nm", [450.0, 550.0, 650.0])
def test_a_hyperboloid_with_conic_minus_eta_squared_focuses_exactly(wavelength_nm):
    # Collimated light inside glass meets the hyperboloid κ = −η² of vertex radius R and comes to
    # one point R/(η − 1) behind the vertex (Descartes' ovals; Hecht 2017, §5.2.1).
    eta = glass("SF11").eta(wavelength_nm)
    scene = lens_scene(surface(math.inf), surface(-0.02, -(eta**2)), 0.02, 0.03, "SF11")
    paths = traced(
        scene, ring_of_rays(np.linspace(1e-4, 0.0149, 60), -0.05), [0.0, 0.0, 1.0], wavelength_nm
    )
    expected = 0.01 + 0.02 / (eta - 1.0)
    for path in paths:
        assert path.events == ("refract", "refract", "escape")
        height, distance = crossing_of_axis(path)
        # Angles round by a few ε, lengths of 0.03 by ε; near the axis the crossing is shallow.
        slope = math.hypot(path.directions[-1][0], path.directions[-1][1])
        assert height == pytest.approx(expected, abs=0.3 * EPS / slope)
        assert distance < 1e-16


def test_an_ellipsoid_with_conic_minus_one_over_eta_squared_focuses_exactly():
    # Collimated light in air meets the ellipsoid κ = −1/η² and comes to a point η R/(η − 1) behind
    # its vertex, inside the glass; the second surface, a sphere about that point, lets it pass.
    eta, radius, thickness = 1.5, 0.02, 0.02
    focus = eta * radius / (eta - 1.0)
    first = surface(radius, -1.0 / eta**2)
    scene = lens_scene(first, surface(focus - thickness), thickness, 0.024, constant(eta))
    paths = traced(scene, ring_of_rays(np.linspace(1e-4, 0.0119, 60), -0.05), [0.0, 0.0, 1.0])
    for path in paths:
        height, distance = crossing_of_axis(path)
        slope = math.hypot(path.directions[-1][0], path.directions[-1][1])
        assert height == pytest.approx(focus - 0.5 * thickness, abs=0.3 * EPS / slope)
        assert distance < 1e-16
        # The second surface is met straight on.
        assert np.allclose(path.directions[1], path.directions[2], rtol=0, atol=8.0 * EPS)


@pytest.mark.parametrize("off_axis", [0.001, 0.005, 0.0099])
def test_a_paraboloid_reflects_to_its_focus(off_axis):
    # κ = −1: light along the axis onto the hollow side is reflected to R/2 before the vertex.
    scene = lens_scene(surface(-0.02, -1.0), surface(0.05), 0.004, 0.02, constant(1.5))
    (path,) = traced(
        scene, [[0.0, off_axis, -0.05]], [0.0, 0.0, 1.0], branches=("reflect",)
    )
    assert path.events[0] == "reflect"
    t = -path.points[1][1] / path.directions[1][1]
    focus = path.points[1] + t * path.directions[1]
    assert focus[2] == pytest.approx(-0.002 - 0.01, abs=0.1 * EPS / off_axis)


def test_a_spherical_lens_has_the_aberration_of_its_refractions():
    # The same ray by Snell's law at two spheres, in the plane, angle by angle.
    eta, r1, r2, thickness, height = 1.6, 0.04, -0.03, 0.012, 0.008
    scene = lens_scene(surface(r1), surface(r2), thickness, 0.018, constant(eta))
    (path,) = traced(scene, [[0.0, height, -0.05]], [0.0, 0.0, 1.0])
    theta_1 = math.asin(height / r1)
    turn = math.asin(math.sin(theta_1) / eta) - theta_1  # slope angle inside, downward
    z = r1 - math.sqrt(r1**2 - height**2)
    # Distance of the ray inside from the second centre gives sinθ there.
    centre = thickness + r2
    miss = height + (centre - z) * math.tan(turn)
    sin_theta = -miss * math.cos(turn) / r2
    out = turn + math.asin(sin_theta) - math.asin(eta * sin_theta)
    angle = math.atan2(path.directions[-1][1], path.directions[-1][2])
    assert angle == pytest.approx(out, abs=16.0 * EPS)


# Faces hit twice, and the rim


def circle_deviation(miss_over_radius, eta):
    """Straight through a circle: 2 (θᵢ − θₜ)."""
    theta_i = math.asin(miss_over_radius)
    return 2.0 * (theta_i - math.asin(miss_over_radius / eta))


def test_a_ray_may_meet_one_face_of_a_meniscus_twice():
    # Across the bulge of the first surface, in front of the second: a chord of one sphere.
    eta, radius = 1.05, 0.05
    scene = lens_scene(surface(radius), surface(0.06), 0.02, 0.08, constant(eta))
    depth = 0.012  # behind the first vertex, which lies at z = −0.01
    (path,) = traced(scene, [[0.0, -0.1, depth - 0.01]], [0.0, 1.0, 0.0])
    assert path.events == ("refract", "refract", "escape")
    miss = (radius - depth) / radius
    assert path.deviation == pytest.approx(circle_deviation(miss, eta), abs=16.0 * EPS)
    for point in path.points[1:3]:
        on_sphere = np.linalg.norm(point - [0.0, 0.0, radius - 0.01])
        assert on_sphere == pytest.approx(radius, abs=2e-17)


def test_a_ray_may_be_reflected_twice_by_the_hollow_of_a_meniscus():
    # 45° of a hollow sphere each time: out the way it came, beside itself.
    radius = 0.05
    scene = lens_scene(surface(-radius), surface(-0.06), 0.02, 0.08, constant(1.5))
    off_axis = radius * math.sin(math.radians(45.0))
    (path,) = traced(
        scene, [[0.0, off_axis, -0.1]], [0.0, 0.0, 1.0], branches=("reflect", "reflect")
    )
    assert path.events == ("reflect", "reflect", "escape")
    assert path.deviation == pytest.approx(math.pi, abs=16.0 * EPS)
    np.testing.assert_allclose(path.points[2], path.points[1] * [1, -1, 1], rtol=0, atol=1e-16)


def test_rays_through_the_rim_see_a_cylinder():
    eta, rim = 1.5, 0.02
    scene = lens_scene(surface(0.1), surface(-0.1), 0.03, 2.0 * rim, constant(eta))
    for miss in (0.0, 0.3, 0.6, 0.95):
        (path,) = traced(scene, [[miss * rim, -0.1, 0.001]], [0.0, 1.0, 0.0])
        assert path.events == ("refract", "refract", "escape")
        assert path.deviation == pytest.approx(circle_deviation(miss, eta), abs=32.0 * EPS)
        for point in path.points[1:3]:
            assert math.hypot(point[0], point[1]) == pytest.approx(rim, abs=1e-17)
            assert point[2] == pytest.approx(0.001, abs=1e-18)


def test_rays_that_start_inside_leave():
    scene = lens_scene(surface(0.05), surface(-0.05), 0.02, 0.03, constant(1.5))
    along, across = traced(scene, [[0.0, 0.0, 0.0]] * 2, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    assert along.events == across.events == ("refract", "escape")
    np.testing.assert_allclose(along.points[1], [0.0, 0.0, 0.01], rtol=0, atol=1e-18)
    np.testing.assert_allclose(across.points[1], [0.0, 0.015, 0.0], rtol=0, atol=1e-18)
    assert along.deviation == across.deviation == 0.0


def test_rays_beside_the_aperture_miss():
    scene = lens_scene(surface(0.05), surface(-0.05), 0.02, 0.03, constant(1.5))
    inside, outside = traced(
        scene, [[0.0, 0.015 * (1.0 - 1e-9), -0.05], [0.0, 0.015 * (1.0 + 1e-9), -0.05]],
        [0.0, 0.0, 1.0],
    )  # fmt: skip
    assert inside.events[0] == "refract"
    assert outside.events == ("escape",)


def test_a_lens_may_point_anywhere():
    # The axis turns, and the ray with it.
    axis = np.array([2.0, -3.0, 6.0]) / 7.0
    turned = lens_scene(surface(0.05), surface(-0.08), 0.01, 0.03, "F2", axis=tuple(axis))
    upright = lens_scene(surface(0.05), surface(-0.08), 0.01, 0.03, "F2")
    u = np.cross(axis, [0.0, 1.0, 0.0])
    u /= np.linalg.norm(u)
    frame = np.stack([u, np.cross(axis, u), axis])
    start, way = np.array([0.004, 0.007, -0.05]), np.array([0.05, -0.1, 1.0])
    expected = trace_ray(upright, start, way, 550.0)
    path = trace_ray(turned, start @ frame, way @ frame, 550.0)
    assert path.events == expected.events
    np.testing.assert_allclose(
        path.directions @ frame.T, expected.directions, rtol=0, atol=16.0 * EPS
    )
