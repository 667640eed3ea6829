import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import scenes
from scenes import Lens, LensSurface, SceneError

curvatures = st.floats(-12.0, 12.0)
conics = st.floats(-3.0, 3.0)


def lens(first: LensSurface, second: LensSurface, **fields: Any) -> Lens:
    defaults = {"position": (0.0, 0.0, 0.0), "thickness": 0.01, "aperture": 0.05}
    return Lens(first=first, second=second, **{**defaults, **fields})


BICONVEX = lens(LensSurface(radius=0.1), LensSurface(radius=-0.1))
BICONCAVE = lens(LensSurface(radius=-0.1), LensSurface(radius=0.1))
PLANO_CONVEX = lens(LensSurface(curvature=0.0), LensSurface(radius=-0.1))
MENISCUS = lens(LensSurface(radius=0.1), LensSurface(radius=0.2))


def test_the_sag_of_a_sphere() -> None:
    # A sphere of radius R about the point R along the axis: z = R - √(R² - ρ²).
    surface = LensSurface(radius=0.1)
    assert surface.sag(0.06) == pytest.approx(0.02, rel=1e-14)
    assert LensSurface(radius=-0.1).sag(0.06) == pytest.approx(-0.02, rel=1e-14)


def test_the_sag_of_a_paraboloid_and_of_a_plane() -> None:
    # κ = -1: z = cρ²/2.
    assert LensSurface(radius=0.1, conic=-1.0).sag(0.06) == pytest.approx(0.018, rel=1e-14)
    assert LensSurface(curvature=0.0).sag(0.06) == 0.0


def test_the_sag_of_an_ellipsoid() -> None:
    # Semi-axes a along the axis and b across: R = b²/a, 1 + κ = b²/a²; z = a (1 - √(1 - ρ²/b²)).
    a, b = 0.2, 0.1
    surface = LensSurface(radius=b**2 / a, conic=b**2 / a**2 - 1.0)
    expected = a * (1.0 - math.sqrt(1.0 - 0.06**2 / b**2))
    assert surface.sag(0.06) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("shape", "sign"), [(BICONVEX, -1), (BICONCAVE, 1), (PLANO_CONVEX, -1), (MENISCUS, -1)]
)
def test_every_kind_of_lens_is_thinner_or_thicker_at_the_rim(shape: Lens, sign: int) -> None:
    assert math.copysign(1, shape.edge_thickness - shape.thickness) == sign
    assert shape.edge_thickness > 0.0


def test_the_edge_of_a_biconvex_lens() -> None:
    # Twice the sag of R = 100 at ρ = 25: 2 (100 - √(100² - 25²)) = 6.3508.
    expected = 0.01 - 2.0 * (0.1 - math.sqrt(0.1**2 - 0.025**2))
    assert BICONVEX.edge_thickness == pytest.approx(expected, rel=1e-13)


def test_the_vertices_lie_on_the_axis_about_the_position() -> None:
    shape = lens(
        LensSurface(radius=0.1),
        LensSurface(radius=-0.1),
        position=(1.0, 2.0, 3.0),
        axis=(0.0, -2.0, 0.0),
    )
    first, second = shape.vertices()
    np.testing.assert_allclose(first, [1.0, 2.005, 3.0], rtol=1e-15)
    np.testing.assert_allclose(second, [1.0, 1.995, 3.0], rtol=1e-15)


@given(c1=curvatures, c2=curvatures, conic1=conics, conic2=conics)
@settings(deadline=None)
def test_the_thinnest_place_is_found_exactly(
    c1: float, c2: float, conic1: float, conic2: float
) -> None:
    first = LensSurface(curvature=c1, conic=conic1)
    second = LensSurface(curvature=c2, conic=conic2)
    assume(first.reaches(0.04) and second.reaches(0.04))
    shape = lens(first, second, thickness=1.0, aperture=0.08)
    rho, thinnest = shape.thinnest()
    assert 0.0 <= rho <= 0.04
    sampled = min(shape.thickness_at(0.04 * k / 2000) for k in range(2001))
    # The samples can only miss the minimum, by rounding of sags below 0.1 apart.
    assert thinnest <= sampled + 1e-15
    # Slopes below 10 and steps of 2e-5: the nearest sample is no further off than this.
    assert sampled - thinnest < 1e-3


def test_surfaces_that_cross_at_the_rim() -> None:
    with pytest.raises(SceneError, match=r"thickness: makes the surfaces cross: 0\.025 m off"):
        lens(LensSurface(radius=0.1), LensSurface(radius=-0.1), thickness=0.006)


def test_surfaces_that_cross_on_the_axis_cannot_be_described() -> None:
    with pytest.raises(SceneError, match="thickness: must be greater than 0"):
        lens(LensSurface(radius=-0.1), LensSurface(radius=0.1), thickness=0.0)


def test_surfaces_that_cross_between_axis_and_rim_only() -> None:
    # The meniscus has equal sags at the rim, but its first, elliptical surface is the flatter one
    # near the axis, so that the second dips through it halfway out.
    rim = 0.025
    first = LensSurface(radius=0.04, conic=-4.0)
    second = LensSurface(curvature=0.8 / 0.04, conic=2.0)
    gap = first.sag(0.0) - second.sag(0.0)
    assert gap == 0.0
    thickest_overlap = max(first.sag(rim * k / 100) - second.sag(rim * k / 100) for k in range(101))
    at_the_rim = first.sag(rim) - second.sag(rim)
    assert at_the_rim < 0.5 * thickest_overlap
    with pytest.raises(SceneError, match="makes the surfaces cross"):
        lens(first, second, thickness=0.9 * thickest_overlap, aperture=2.0 * rim)
    lens(first, second, thickness=1.1 * thickest_overlap, aperture=2.0 * rim)


def test_an_aperture_wider_than_a_surface() -> None:
    with pytest.raises(SceneError, match=r"at most 0\.08 m, where the first ends"):
        lens(LensSurface(radius=0.04), LensSurface(curvature=0.0), thickness=0.05, aperture=0.09)


def test_a_hemisphere_given_in_millimetres_is_a_lens() -> None:
    scene = scenes.loads("""
        length_unit = "mm"
        [[objects]]
        material = { type = "dielectric", medium = "N-BK7" }
        [objects.shape]
        type = "lens"
        position = [0, 0, 0]
        thickness = 30
        aperture = 50
        first = { radius = 25 }
        second = { curvature = 0 }
    """)
    shape = scene.objects[0].shape
    assert isinstance(shape, Lens)
    assert shape.edge_thickness == pytest.approx(0.005, rel=1e-12)


def test_messages_are_in_the_unit_of_the_file() -> None:
    with pytest.raises(SceneError, match=r"25 mm off the axis the lens is -0\.350833 mm thick"):
        scenes.loads("""
            length_unit = "mm"
            [[objects]]
            material = { type = "absorber" }
            [objects.shape]
            type = "lens"
            position = [0, 0, 0]
            thickness = 6
            aperture = 50
            first = { radius = 100 }
            second = { curvature = -0.01 }
        """)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({}, "curvature: must be given as either radius or curvature, not neither"),
        ({"radius": 1.0, "curvature": 1.0}, "must be given as either .* not both"),
        ({"radius": 0.0}, "radius: must not be 0; .* a flat surface is written curvature = 0"),
        ({"radius": float("inf")}, "radius: must be a finite number"),
        ({"curvature": float("nan")}, "curvature: must be a finite number"),
        ({"curvature": 2e9}, "curvature: must mean a radius of at least"),
        ({"radius": 1.0, "conic": float("nan")}, "conic: must be a finite number"),
    ],
)
def test_surfaces_that_are_none(fields: dict[str, float], message: str) -> None:
    with pytest.raises(SceneError, match=message) as caught:
        LensSurface(**fields)
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("shape", [BICONVEX, BICONCAVE, PLANO_CONVEX, MENISCUS])
def test_the_bounding_sphere_holds_the_outline(shape: Lens) -> None:
    centre, radius = shape.bounding_sphere()
    assert centre[0] == centre[1] == 0.0
    for rho in np.linspace(0.0, 0.5 * shape.aperture, 50):
        for z in (
            -0.5 * shape.thickness + shape.first.sag(rho),
            0.5 * shape.thickness + shape.second.sag(rho),
        ):
            assert math.hypot(rho, z - centre[2]) <= radius * (1.0 + 1e-12)
