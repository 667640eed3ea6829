"""Direct light by shadow rays: closed forms, what is in the way, and the photons it stands for."""

import math

import numpy as np
import pytest

import scenes

RHO = 0.6
FLUX = 5.0
"""Of every lamp [W], spread evenly over 300 nm."""
SPECTRUM = scenes.SpectrumTable(wavelength_nm=(400.0, 700.0), values=(1.0, 1.0))
FILM = scenes.Film(first_nm=425, last_nm=675, bands=6)
DOWN = (0.0, -1.0, 0.0)
PASSES = 16

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0)),
    material=scenes.Lambertian(reflectance=RHO),
)
BALL = scenes.SceneObject(
    name="ball",
    shape=scenes.Sphere(position=(0.15, 0.35, 0.0), radius=0.15),
    material=scenes.Dielectric(medium="N-BK7"),
)
FAR_BALL = BALL.model_copy(
    update={
        "name": "far ball", "shape": scenes.Sphere(position=(9.0, 9.0, 9.0), radius=0.2)
    }
)
"""In the way of nothing: with it every scene here compiles to the same kernels."""
COMMON = {"flux": FLUX, "spectrum": SPECTRUM}
POINT = scenes.Point(position=(0.3, 1.2, -0.2), **COMMON)
SPOT = scenes.Spot(
    position=(0.2, 1.5, 0.1), direction=(-0.1, -1.0, 0.0), half_angle_deg=15.0, **COMMON
)
SPHERE = scenes.SphereLamp(position=(-0.2, 1.0, 0.3), radius=0.2, **COMMON)
RECTANGLE = scenes.RectangleLamp(
    position=(0.0, 0.8, 0.0), size=(0.5, 0.3), normal=DOWN, **COMMON
)
SLIT = scenes.Beam(
    position=(0.0, 1.0, 0.0), direction=(0.3, -1.0, 0.0),
    profile=scenes.SlitProfile(width=0.4, height=0.6), **COMMON,
)
ROUND = scenes.Beam(
    position=(0.0, 1.0, 0.0), direction=DOWN, profile=scenes.RoundProfile(radius=0.3), **COMMON
)
WIDE_CONE = ROUND.model_copy(update={"divergence_deg": 35.0})
NARROW_CONE = ROUND.model_copy(update={"divergence_deg": 3.0})


def irradiances(darkroom, emitter, point, obstacles=(), **options):
    """E of each pass at a point of the floor [W m⁻²], from the radiance of the middle bands."""
    scene = scenes.Scene(objects=(FLOOR, FAR_BALL, *obstacles), emitters=(emitter,), film=FILM)
    room = darkroom(
        scene, photons=2, radius=1e-6, passes=PASSES, direct_light="lamps", **options
    )
    # Slightly from the side; a glass or screen above the floor is above this, too.
    start = np.add(point, (0.02, 0.05, 0.01))
    looks = np.array([room.look(start, point - start, i) for i in range(PASSES)])
    assert np.ptp(looks, axis=1).max() < 1e-5 * max(looks.max(), 1e-30)
    return looks[:, 3] * np.pi / RHO * 300.0


def test_a_point_lamp(darkroom):
    # E = Φ cosθ / (4π d²), the same in every pass: no noise at all.
    point = np.array((-0.4, 0.0, 0.5))
    offset = np.array(POINT.position) - point
    distance = np.linalg.norm(offset)
    expected = FLUX * offset[1] / distance / (4.0 * np.pi * distance**2)
    # The pixel is 1e-7 rad wide.
    np.testing.assert_allclose(irradiances(darkroom, POINT, point), expected, rtol=1e-6)
    single = irradiances(darkroom, POINT, point, precision="float32")
    np.testing.assert_allclose(single, expected, rtol=2e-5)


@pytest.mark.parametrize(("x", "shines"), [(0.2, True), (0.42, True), (0.5, False)])
def test_a_spot(darkroom, x, shines):
    # E = Φ cosθ / (Ω d²) with Ω = 2π (1 − cos 15°), and nothing outside of the cone.
    point = np.array((x, 0.0, 0.1))
    offset = np.array(SPOT.position) - point
    distance = np.linalg.norm(offset)
    solid_angle = 2.0 * np.pi * (1.0 - math.cos(math.radians(15.0)))
    expected = shines * FLUX * offset[1] / distance**3 / solid_angle
    np.testing.assert_allclose(irradiances(darkroom, SPOT, point), expected, rtol=1e-6)


def test_a_spherical_lamp_is_as_good_as_a_point(darkroom, assert_mean):
    # By symmetry E = Φ cosθ/(4π d²) of the centre, wherever the whole sphere is above the horizon.
    point = np.array((0.5, 0.0, -0.3))
    offset = np.array(SPHERE.position) - point
    expected = FLUX * offset[1] / (4.0 * np.pi * np.linalg.norm(offset) ** 3)
    found = irradiances(darkroom, SPHERE, point)
    assert_mean(found, expected, slack=1e-6 * expected)
    assert found.std(ddof=1) < 0.05 * expected


def test_a_rectangular_lamp(darkroom, assert_mean):
    # Below the middle of a × b at height h, each quarter has the configuration factor
    # F = [X/√(1+X²) atan(Y/√(1+X²)) + Y/√(1+Y²) atan(X/√(1+Y²))]/2π, X = a/2h, Y = b/2h
    # (Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", C-11); E = F Φ/A.
    x, y = 0.25 / 0.8, 0.15 / 0.8
    p, q = math.hypot(1.0, x), math.hypot(1.0, y)
    quarter = (x / p * math.atan(y / p) + y / q * math.atan(x / q)) / (2.0 * math.pi)
    expected = 4.0 * quarter * FLUX / (0.5 * 0.3)
    found = irradiances(darkroom, RECTANGLE, np.array((0.0, 0.0, 0.0)))
    assert_mean(found, expected, slack=1e-6 * expected)
    assert found.std(ddof=1) < 0.05 * expected


@pytest.mark.parametrize(
    ("x", "y", "inside"), [(0.99, -0.98, True), (1.01, 0.5, False), (0.5, -1.01, False)]
)
def test_a_collimated_slit(darkroom, x, y, inside):
    # E = Φ cosθ/A where the axis through (x, y), in halves of the profile, meets the floor.
    width_axis, height_axis, axis = SLIT.frame()
    start = np.array(SLIT.position) + 0.2 * x * width_axis + 0.3 * y * height_axis
    found = irradiances(darkroom, SLIT, start - axis * start[1] / axis[1])
    np.testing.assert_allclose(found, -inside * FLUX / 0.24 * axis[1], rtol=1e-6)


@pytest.mark.parametrize(("z", "inside"), [(0.29, True), (0.31, False)])
def test_a_collimated_round_beam(darkroom, z, inside):
    found = irradiances(darkroom, ROUND, np.array((0.0, 0.0, z)))
    np.testing.assert_allclose(found, inside * FLUX / (math.pi * 0.09), rtol=1e-6)


@pytest.mark.parametrize("beam", [WIDE_CONE, NARROW_CONE], ids=["wide", "narrow"])
def test_on_the_axis_of_a_diverging_beam(darkroom, assert_mean, beam):
    # Each point of the profile sends Φ/(A Ω) per area and solid angle into its cone: over the part
    # of the disk that has the point in its cone, of radius ρ' = min(ρ, h tanθ),
    # E = Φ/(A Ω) ∫ cosα/d² dA = Φ/(A Ω) 2π [1 − h/√(h² + ρ'²)], with cosα = h/d at the floor.
    half = math.radians(beam.divergence_deg)
    solid_angle = 2.0 * math.pi * (1.0 - math.cos(half))
    rho = min(0.3, math.tan(half))
    expected = FLUX / (math.pi * 0.09 * solid_angle)
    expected *= 2.0 * math.pi * (1.0 - 1.0 / math.hypot(1.0, rho))
    assert_mean(
        irradiances(darkroom, beam, np.array((0.0, 0.0, 0.0))), expected, slack=1e-6 * expected
    )


SCREEN = scenes.SceneObject(
    name="screen",
    shape=scenes.Disk(position=(0.0, 0.3, 0.0), radius=0.2, normal=DOWN),
    material=scenes.Absorber(),
)
GLASS = SCREEN.model_copy(
    update={
        "shape": scenes.Sphere(position=(0.0, 0.3, 0.0), radius=0.2),
        "material": scenes.Dielectric(medium="N-BK7"),
    }
)


@pytest.mark.parametrize("obstacle", [SCREEN, GLASS], ids=["screen", "glass"])
@pytest.mark.parametrize("emitter", [POINT, SPHERE, RECTANGLE, ROUND, WIDE_CONE])
def test_whatever_is_in_the_way_stops_it(darkroom, emitter, obstacle):
    # The line from the lamp's middle through the obstacle's, (0, 0.3, 0), ends here. What meets
    # glass is left to the photons, of which this room gathers none.
    share = 0.3 / emitter.position[1]
    point = np.array(emitter.position) * (1.0, 0.0, 1.0) * -share / (1.0 - share)
    assert irradiances(darkroom, emitter, point, (obstacle,)).max() == 0.0
    assert irradiances(darkroom, emitter, point).max() > 0.01


def test_no_light_behind_the_receiver(darkroom):
    # The camera looks at the floor's underside.
    scene = scenes.Scene(objects=(FLOOR, FAR_BALL), emitters=(POINT,), film=FILM)
    room = darkroom(scene, photons=2, radius=0.01, direct_light="lamps")
    assert room.look((0.0, -1.0, 0.1), (0.0, 1.0, 0.0)).max() == 0.0


LAMPS = {
    "point": POINT, "spot": SPOT, "sphere": SPHERE, "rectangle": RECTANGLE, "slit": SLIT,
    "round": ROUND, "wide cone": WIDE_CONE, "narrow cone": NARROW_CONE,
}


@pytest.mark.parametrize("name", LAMPS)
def test_it_is_the_light_of_the_photons_it_stands_for(darkroom, assert_mean, name):
    # The same picture, of a floor with a glass ball above it, from photons alone and with shadow
    # rays: no light is missing, and none counted twice. Blocks of it agree within their errors.
    camera = scenes.Camera(
        position=(0.0, 2.5, 0.9), look_at=(0.05, 0.0, 0.0), up=(0.0, 0.0, -1.0), fov_deg=30.0
    )
    scene = scenes.Scene(objects=(FLOOR, BALL), emitters=(LAMPS[name],), film=FILM)
    means = {}
    for direct_light in ("photons", "lamps"):
        room = darkroom(
            scene, photons=40_000, radius=0.03, passes=PASSES, direct_light=direct_light
        )
        blocks = []
        for index in range(PASSES):
            film = room.create_film(width=32, height=32)
            room.expose(film, camera, index)
            blocks.append(film.radiance().sum(axis=2).reshape(4, 8, 4, 8).mean(axis=(1, 3)))
        means[direct_light] = np.array(blocks)
    # The photons' kernel blurs the edge of a beam by its radius, across blocks ten times as wide.
    slack = 0.02 * means["photons"].mean(axis=0).max()
    assert_mean(means["lamps"] - means["photons"], 0.0, slack=slack)
    assert means["lamps"].max() > 0.0
