"""Solids that touch, nest and overlap: doublets, immersion, bubbles, tumblers, flush blocks."""

import math

import numpy as np
import pytest

import scenes
from scenes.frames import rotation_matrix
from sim import analytic, trace_ray
from spectra import glass

EPS = float(np.finfo(np.float64).eps)
D_NM, F_NM, C_NM = 587.5618, 486.1327, 656.2725


def constant(eta):
    return scenes.ConstantMedium(eta=eta)


def solid(name, shape, medium, priority=0):
    material = scenes.Dielectric(medium=medium, priority=priority)
    return scenes.SceneObject(name=name, shape=shape, material=material)


def block(name, low, high, medium, priority=0):
    """A box by two of its corners."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    middle, size = (0.5 * (low + high)).tolist(), (high - low).tolist()
    return solid(name, scenes.Box(position=middle, size=size), medium, priority)


def lens(name, z, radii, thickness, medium, priority=0, aperture=0.03):
    """On the z axis, its first vertex at z."""
    first, second = (
        scenes.LensSurface(curvature=0.0) if r == math.inf else scenes.LensSurface(radius=r)
        for r in radii
    )
    shape = scenes.Lens(
        position=(0.0, 0.0, z + 0.5 * thickness), axis=(0.0, 0.0, 1.0), thickness=thickness,
        aperture=aperture, first=first, second=second,
    )  # fmt: skip
    return solid(name, shape, medium, priority)


def paraxial_focus(surfaces, gaps, indices):
    """Distance from the last vertex to the focus of axial light (Welford 1986, §3.5).

    n' u' = n u − y (n' − n) c and y' = y + u' d, from surface to surface.
    """
    height, slope = 1.0, 0.0
    for k, radius in enumerate(surfaces):
        power = (indices[k + 1] - indices[k]) / radius
        slope = (indices[k] * slope - height * power) / indices[k + 1]
        if k < len(gaps):
            height += slope * gaps[k]
    return -height / slope


def crossing(path, z_vertex):
    """How far behind a vertex on the z axis the last segment crosses the axis."""
    point, way = path.points[-2], path.directions[-1]
    return float(point[2] - point[0] * way[2] / way[0]) - z_vertex


# A cemented doublet of crown (N-BK7) and flint (SF11): powers φ₁/φ₂ = −V₁/V₂ of thin lenses make it
# achromatic, the closed form of its focus is the paraxial one above.
R1, R2, R3 = 0.0606, -0.0635, -0.1378
T1, T2 = 0.006, 0.002
HEIGHT = 1e-5
"""Of the rays off the axis [m]: spherical aberration is some 10 (h/f)² = 1e-7 of the focus."""


def doublet(crown_priority=0, flint_priority=0, *, flint_first=False, sunk=0.0):
    """`sunk`: the flint's front lies so deep in the crown [m], which then must be preferred."""
    crown = lens("crown", 0.0, (R1, R2), T1, "N-BK7", crown_priority)
    flint = lens("flint", T1 - sunk, (R2, R3), T2 + sunk, "SF11", flint_priority)
    return scenes.Scene(objects=(flint, crown) if flint_first else (crown, flint))


def axial(scene, wavelength_nm, height=HEIGHT):
    return trace_ray(scene, (height, 0.0, -0.02), (0.0, 0.0, 1.0), wavelength_nm)


def doublet_focus(wavelength_nm):
    crown, flint = (float(glass(name).eta(wavelength_nm)) for name in ("N-BK7", "SF11"))
    return paraxial_focus((R1, R2, R3), (T1, T2), (1.0, crown, flint, 1.0))


@pytest.mark.parametrize("wavelength_nm", [F_NM, D_NM, C_NM])
def test_a_cemented_doublet_focuses_where_gauss_says(wavelength_nm):
    path = axial(doublet(), wavelength_nm)
    assert path.events == ("refract",) * 3 + ("escape",)
    expected = doublet_focus(wavelength_nm)
    assert crossing(path, T1 + T2) == pytest.approx(expected, rel=1e-6)


def test_the_doublet_is_an_achromat_beside_its_crown():
    foci = [crossing(axial(doublet(), line), T1 + T2) for line in (F_NM, C_NM)]
    alone = scenes.Scene(objects=(lens("crown", 0.0, (R1, R2), T1, "N-BK7"),))
    single = [crossing(axial(alone, line), T1) for line in (F_NM, C_NM)]
    eta = [float(glass("N-BK7").eta(line)) for line in (F_NM, C_NM)]
    expected = [paraxial_focus((R1, R2), (T1,), (1.0, n, 1.0)) for n in eta]
    # Differences of foci that are known to 1e-7 of 0.1 m.
    assert single[0] - single[1] == pytest.approx(expected[0] - expected[1], abs=4e-8)
    shift = doublet_focus(F_NM) - doublet_focus(C_NM)
    assert foci[0] - foci[1] == pytest.approx(shift, abs=4e-8)
    assert abs(foci[0] - foci[1]) < 0.1 * abs(single[0] - single[1])


@pytest.mark.parametrize("flint_first", [False, True])
@pytest.mark.parametrize("priorities", [(0, 0), (1, 0), (0, 1), (-7, 900)])
def test_cemented_faces_do_not_mind_priority_or_order(priorities, flint_first):
    expected = axial(doublet(), D_NM, height=0.012)
    path = axial(doublet(*priorities, flint_first=flint_first), D_NM, height=0.012)
    assert path.events == expected.events
    # Whichever of the two faces is found first, its point is rounded its own way.
    np.testing.assert_allclose(path.points[:-1], expected.points[:-1], rtol=0, atol=64 * EPS)
    np.testing.assert_allclose(path.directions, expected.directions, rtol=0, atol=64 * EPS)
    assert path.transmittance == pytest.approx(expected.transmittance, rel=1e-12)


def test_light_goes_back_the_way_it_came_through_a_doublet():
    path = axial(doublet(), D_NM, height=0.012)
    back = trace_ray(doublet(0, 1), path.points[-1], -path.directions[-1], D_NM)
    vertices = slice(1, 4)
    np.testing.assert_allclose(back.points[vertices][::-1], path.points[vertices], atol=1e-14)
    assert back.transmittance == pytest.approx(path.transmittance, rel=1e-12)


def test_what_a_lens_of_higher_priority_hides_does_nothing():
    expected = axial(doublet(), D_NM, height=0.008)
    path = axial(doublet(1, 0, sunk=0.001), D_NM, height=0.008)
    assert path.events == ("refract", "pass", "refract", "refract", "escape")
    assert path.objects[:4] == ("crown", "flint", "crown", "flint")
    np.testing.assert_allclose(path.directions[-1], expected.directions[-1], atol=64 * EPS)
    np.testing.assert_allclose(path.points[-2], expected.points[-2], atol=64 * EPS)
    assert path.transmittance == pytest.approx(expected.transmittance, rel=1e-12)


@pytest.mark.parametrize("hair", [1e-17, 1e-14, 1e-12, 4e-12, -1e-17, -1e-14])
def test_a_hair_of_overlap_or_air_is_contact(hair):
    # What is less than 1e-9 of the lenses counts as contact when the scene is read; whatever
    # faces are then met, light goes from crown to flint once. A gap of air would have to be wider
    # than 2⁻⁴⁰ of the bench to be one.
    expected = axial(doublet(), D_NM, height=0.008)
    crown = lens("crown", 0.0, (R1, R2), T1, "N-BK7")
    flint = lens("flint", T1 - hair, (R2, R3), T2 + hair, "SF11")
    for objects in ((crown, flint), (flint, crown)):
        path = axial(scenes.Scene(objects=objects), D_NM, height=0.008)
        assert [one for one in path.events if one != "pass"] == list(expected.events)
        np.testing.assert_allclose(path.directions[-1], expected.directions[-1], atol=1e-9)


WATER, GLASS = 4.0 / 3.0, 1.52


@pytest.fixture(scope="module")
def thick_lens():
    return lens("lens", 0.0, (0.05, -0.08), 0.01, constant(GLASS))


def test_a_lens_under_water_obeys_the_lensmaker(thick_lens):
    scene = scenes.Scene(ambient=constant(WATER), objects=(thick_lens,))
    expected = analytic.lensmaker_back_focal_length(GLASS / WATER, 0.05, -0.08, 0.01)
    assert crossing(axial(scene, D_NM), 0.01) == pytest.approx(expected, rel=1e-6)


def test_a_lens_in_a_tank_is_a_lens_under_water(thick_lens):
    water = constant(WATER)
    tank = block("tank", (-1, -1, -1), (1, 1, 1), water, -1)
    inside = trace_ray(scenes.Scene(objects=(tank, thick_lens)), (0.01, 0.0, -0.1),
                       (0.02, 0.01, 1.0), D_NM)  # fmt: skip
    immersed = trace_ray(scenes.Scene(ambient=water, objects=(thick_lens,)), (0.01, 0.0, -0.1),
                         (0.02, 0.01, 1.0), D_NM)  # fmt: skip
    assert inside.events == ("refract", "refract", "refract", "escape")
    np.testing.assert_allclose(inside.points[:3], immersed.points[:3], rtol=0, atol=1e-14)
    np.testing.assert_array_equal(inside.reflectances[:2], immersed.reflectances[:2])


def test_apparent_depth():
    # A mirror flush on the bottom of a tank of depth d is seen at d/n (Hecht 2017, §5.2.2, for
    # rays near the vertical): light from a height h comes back from h + 2 d/n below the water.
    depth, height, slope = 0.3, 0.5, 1e-4
    tank = block("tank", (-1, -depth, -1), (1, 0, 1), constant(WATER))
    floor = scenes.Rectangle(position=(0.0, -depth, 0.0), size=(3.0, 3.0))
    mirror = scenes.SceneObject(name="mirror", shape=floor, material=scenes.Mirror())
    for objects in ((tank, mirror), (mirror, tank)):
        path = trace_ray(scenes.Scene(objects=objects), (0, height, 0), (slope, -1, 0), D_NM)
        assert path.events == ("refract", "mirror", "refract", "escape")
        assert path.objects[:3] == ("tank", "mirror", "tank")
        point, way = path.points[3], path.directions[-1]
        image = point[1] - point[0] * way[1] / way[0]
        assert -image == pytest.approx(height + 2.0 * depth / WATER, rel=4.0 * slope**2)


def test_total_reflection_makes_a_ring_of_a_bubble():
    # Into air, light is reflected whole where b/R = sin θ > 1/n, and is then turned by π − 2θ.
    radius, eta = 0.1, 1.5
    glass_block = block("glass", (-1, -1, -1), (1, 1, 1), constant(eta))
    bubble = solid("bubble", scenes.Sphere(position=(0, 0, 0), radius=radius), "air", 1)
    scene = scenes.Scene(objects=(glass_block, bubble))
    for sine in np.linspace(0.02, 0.98, 25):
        path = trace_ray(scene, (radius * sine, 0.0, -0.5), (0, 0, 1), D_NM)
        theta = math.asin(sine)
        if sine > 1.0 / eta:
            assert path.events[0] == "total internal reflection"
            turned, after = math.pi - 2.0 * theta, 1
        else:
            # Twice by the difference of the angles.
            assert path.events[:2] == ("refract", "refract")
            turned, after = 2.0 * (math.asin(eta * sine) - theta), 2
        angle = analytic.angle_between(path.directions[0], path.directions[after])
        assert float(angle) == pytest.approx(turned, abs=1e-13 / math.cos(theta))
    assert path.objects[0] == "bubble"


def tumbler(*, overlap):
    """Walls 0.1 thick and a bottom 0.2 thick about a room of 0.8 width, half filled.

    With `overlap` it is a block of glass, with a room cut out by air, and a liquid that reaches
    into walls and bottom; else it is pieces side by side that only touch.
    """
    wet, dry = constant(WATER), constant(GLASS)
    if overlap:
        return scenes.Scene(objects=(
            block("liquid", (-0.45, 0.1, -0.45), (0.45, 0.6, 0.45), wet, 1),
            block("glass", (-0.5, 0.0, -0.5), (0.5, 1.0, 0.5), dry, 0),
            block("wall", (-0.5, 0.0, -0.5), (-0.4, 1.0, 0.5), dry, 2),
            block("other wall", (0.4, 0.0, -0.5), (0.5, 1.0, 0.5), dry, 2),
            block("bottom", (-0.5, 0.0, -0.5), (0.5, 0.2, 0.5), dry, 2),
            block("room", (-0.4, 0.6, -0.6), (0.4, 1.0, 0.6), "air", 3),
        ))  # fmt: skip
    return scenes.Scene(objects=(
        block("wall", (-0.5, 0.2, -0.5), (-0.4, 1.0, 0.5), dry),
        block("other wall", (0.4, 0.2, -0.5), (0.5, 1.0, 0.5), dry),
        block("bottom", (-0.5, 0.0, -0.5), (0.5, 0.2, 0.5), dry),
        block("liquid", (-0.4, 0.2, -0.45), (0.4, 0.6, 0.45), wet),
    ))  # fmt: skip


@pytest.mark.parametrize(
    ("start", "way"),
    [
        ((0.0, 2.0, 0.0), (0.1, -1.0, 0.02)),  # from above, through surface and bottom
        ((-2.0, 0.45, 0.0), (1.0, -0.05, 0.01)),  # from the side, through both walls
        ((0.3, 1.5, 0.0), (0.25, -1.0, 0.05)),  # into the liquid, and out of its wall
        ((2.0, 0.8, 0.0), (-1.0, 0.01, 0.01)),  # above the liquid
    ],
)
def test_a_filled_tumbler_is_its_pieces(start, way):
    expected = trace_ray(tumbler(overlap=False), start, way, D_NM)
    path = trace_ray(tumbler(overlap=True), start, way, D_NM)
    seen = [k for k, event in enumerate(path.events) if event != "pass"]
    wanted = [k for k, event in enumerate(expected.events) if event != "pass"]
    # Between air that is a medium and the one all around there is nothing to be seen.
    seen = [k for k in seen if path.reflectances[k] > 0.0]
    wanted = [k for k in wanted if expected.reflectances[k] > 0.0]
    assert len(wanted) >= 3
    assert [path.events[k] for k in seen] == [expected.events[k] for k in wanted]
    points = path.points[np.array(seen) + 1], expected.points[np.array(wanted) + 1]
    np.testing.assert_allclose(*points, rtol=0, atol=1e-11)
    np.testing.assert_allclose(path.directions[-1], expected.directions[-1], atol=64 * EPS)
    assert path.transmittance == pytest.approx(expected.transmittance, rel=1e-12)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (10.0, 20.0, 30.0)])
def test_two_flush_blocks_of_a_glass_are_one(turn):
    frame = rotation_matrix(turn)
    halves = [
        solid(name, scenes.Box(position=(frame @ (x, 0.0, 0.0)).tolist(), size=(1.0, 1.0, 1.0),
                               rotation_deg=turn), "N-BK7")
        for name, x in (("left", -0.5), ("right", 0.5))
    ]  # fmt: skip
    whole = solid("whole", scenes.Box(position=(0, 0, 0), size=(2.0, 1.0, 1.0), rotation_deg=turn),
                  "N-BK7")  # fmt: skip
    start, way = frame @ (-2.0, 0.2, 0.1), frame @ (1.0, -0.1, 0.05)
    one = trace_ray(scenes.Scene(objects=(whole,)), start, way, D_NM)
    two = trace_ray(scenes.Scene(objects=halves), start, way, D_NM)
    assert two.events == ("refract", "pass", "refract", "escape")
    np.testing.assert_allclose(two.points[[1, 3]], one.points[[1, 2]], rtol=0, atol=8 * EPS)
    np.testing.assert_allclose(two.directions[[0, 1, 3]], one.directions, rtol=0, atol=8 * EPS)
    assert two.transmittance == pytest.approx(one.transmittance, rel=16 * EPS)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (10.0, 20.0, 30.0)])
def test_three_faces_in_one_place_are_one(order, turn):
    # A cube of glass stands in water on a slab: cube, water and slab share a plane. Light goes
    # from the cube into the slab once, by Snell's law, and on.
    frame = rotation_matrix(turn)

    def piece(name, middle, size, eta, priority=0):
        place = (frame @ middle).tolist()
        shape = scenes.Box(position=place, size=size, rotation_deg=turn)
        return solid(name, shape, constant(eta), priority)

    pieces = (
        piece("slab", (0.0, -0.5, 0.0), (2.0, 1.0, 2.0), 1.5),
        piece("water", (0.0, 0.5, 0.0), (2.0, 1.0, 2.0), WATER),
        piece("cube", (0.0, 0.25, 0.0), (1.0, 0.5, 1.0), 1.8, 2),
    )
    scene = scenes.Scene(objects=tuple(pieces[k] for k in order))
    sine = 0.3
    start = frame @ (-0.4, 2.0, 0.0)
    way = frame @ (sine, -math.sqrt(1.0 - sine**2), 0.0)
    path = trace_ray(scene, start, way, D_NM)
    etas = (WATER, 1.8, 1.5, 1.0)
    directions = [path.directions[0]]
    for before, after in zip(path.directions, path.directions[1:], strict=False):
        if not np.array_equal(before, after):
            directions.append(after)
    assert len(directions) == 1 + len(etas)
    for eta, direction in zip(etas, directions[1:], strict=True):
        assert float((frame.T @ direction)[0]) == pytest.approx(sine / eta, abs=32 * EPS)
    assert path.events[-1] == "escape"
