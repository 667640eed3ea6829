"""Heights above solids: signs against their own descriptions, distances by the nearest point."""

import numpy as np
import pytest

from scenes import Box, Lens, LensSurface, Plane, Prism, Rectangle, Sphere
from scenes.shapes.depth import height_above

RANDOM = np.random.default_rng(5)
AXIS = (2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0)
MIDDLE = np.array([0.3, -0.2, 0.1])


def lens(first, second, thickness, aperture):
    return Lens(
        position=tuple(MIDDLE.tolist()), axis=AXIS, thickness=thickness, aperture=aperture,
        first=first, second=second,
    )  # fmt: skip


SPHERE = Sphere(position=tuple(MIDDLE.tolist()), radius=0.6)
BALL_LENS = lens(LensSurface(radius=0.5), LensSurface(radius=-0.5), 1.0, 0.99)
BICONCAVE = lens(LensSurface(radius=-1.0), LensSurface(radius=1.0), 0.1, 1.0)


def test_a_spheres_is_the_distance():
    points = RANDOM.uniform(-1.5, 1.5, (500, 3))
    expected = np.linalg.norm(points - MIDDLE, axis=1) - 0.6
    np.testing.assert_allclose(height_above(SPHERE, points), expected, atol=1e-15)


@pytest.mark.parametrize("solid", [
    Box(position=tuple(MIDDLE.tolist()), size=(1.0, 0.6, 0.8), rotation_deg=(10, 20, 30)),
    Prism(position=tuple(MIDDLE.tolist()), apex_deg=50, base=1, length=1),
])  # fmt: skip
def test_inside_a_polyhedron_it_is_the_distance_to_the_nearest_face(solid):
    normals, offsets = solid.faces()
    points = MIDDLE + RANDOM.uniform(-0.7, 0.7, (2000, 3))
    heights = height_above(solid, points)
    above = (points - MIDDLE) @ normals.T - offsets
    np.testing.assert_array_equal(heights < 0.0, np.all(above < 0.0, axis=1))
    inside = heights < 0.0
    assert 50 < inside.sum() < 1500
    np.testing.assert_allclose(-heights[inside], np.min(-above[inside], axis=1), atol=1e-14)


@pytest.mark.parametrize("solid", [BALL_LENS, BICONCAVE], ids=["ball", "biconcave"])
def test_a_lens_is_negative_inside_and_small_next_to_its_faces(solid):
    axis = np.array(AXIS)
    u = np.cross(axis, [0.0, 0.0, 1.0])
    u /= np.linalg.norm(u)
    half, rim = 0.5 * solid.thickness, 0.5 * solid.aperture
    for rho in np.linspace(0.0, 0.98 * rim, 30):
        foot = MIDDLE + rho * u
        low, high = -half + solid.first.sag(rho), half + solid.second.sag(rho)
        for z, inner, cap in ((low, 1.0, solid.first), (high, -1.0, solid.second)):
            face = foot + z * axis
            assert abs(float(height_above(solid, face[None])[0])) < 1e-15
            # Just inside and outside, the height is the way along the axis times the cosine of the
            # slope, c ρ/√(1 − c² ρ²) here: to first order the distance.
            step = 1e-7
            cosine = np.sqrt(1.0 - (cap.curvature * rho) ** 2)
            inside = float(height_above(solid, (face + inner * step * axis)[None])[0])
            outside = float(height_above(solid, (face - inner * step * axis)[None])[0])
            assert inside == pytest.approx(-step * cosine, rel=1e-5, abs=1e-15)
            assert outside == pytest.approx(step * cosine, rel=1e-5, abs=1e-15)
        beside = MIDDLE + (rim + 0.01) * u
        assert float(height_above(solid, beside[None])[0]) >= 0.01 - 1e-15


def test_in_the_middle_of_a_ball_lens_it_is_deep():
    heights = height_above(BALL_LENS, MIDDLE[None])
    assert heights[0] == pytest.approx(-0.495, abs=1e-15)  # its rim is nearest


def test_what_encloses_nothing_has_no_height():
    point = np.zeros((1, 3))
    assert height_above(Plane(position=(0, 0, 0), normal=(0, 1, 0)), point) is None
    assert height_above(Rectangle(position=(0, 0, 0), size=(1, 1)), point) is None
