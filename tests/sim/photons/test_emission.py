"""Lamps shine as their closed forms say, wherever their photons are aimed."""

from dataclasses import replace

import numpy as np
import pytest

import scenes
from sim.photons.aiming import Guide, cells_to_distribution
from sim.photons.lamp_structs import AIM_BASE, AIM_CELLS, AIM_CONE

CELLS = 4
HALF = 1.0
HEIGHT = 0.8
LAMP = (0.3, HEIGHT, -0.2)
FLUX = 3.0
ARCHES = np.linspace(-HALF, HALF, CELLS + 1)
"""The floor, 2 m wide at y = 0, is counted in CELLS² cells."""

EMPTY = scenes.Dielectric(
    medium=scenes.SellmeierMedium(b=(0.0,), c_um2=(0.0,), range_nm=(300.0, 900.0))
)
"""Glass of index 1: lamps aim at it, and light passes it straight and whole."""

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0 * HALF, 2.0 * HALF)),
    material=scenes.Lambertian(reflectance=0.5),
)
OTHERS = (
    scenes.SceneObject(
        name="ghost",
        shape=scenes.Box(position=(0.1, 0.3, 0.1), size=(0.5, 0.2, 0.4), rotation_deg=(0, 30, 20)),
        material=EMPTY,
    ),
    scenes.SceneObject(
        name="ghost that overlaps it, as the lamp sees it",
        shape=scenes.Box(position=(-0.3, 0.15, 0.2), size=(0.6, 0.2, 0.6)),
        material=EMPTY,
    ),
    scenes.SceneObject(
        name="block beside the floor",
        shape=scenes.Box(position=(2.0, -0.5, 0.0), size=(0.5, 0.5, 0.5)),
        material=scenes.Lambertian(reflectance=0.5),
    ),
)
LAMPS = {
    "point": scenes.Point(position=LAMP, flux=FLUX, spectrum="D65"),
    "spot": scenes.Spot(
        position=LAMP, direction=(0.1, -1.0, 0.0), half_angle_deg=75.0, flux=FLUX, spectrum="E"
    ),
    "sphere": scenes.SphereLamp(position=LAMP, radius=0.15, flux=FLUX, spectrum="A"),
    "rectangle": scenes.RectangleLamp(
        position=LAMP, size=(0.4, 0.3), normal=(0.0, -1.0, 0.0), flux=FLUX, spectrum="D65"
    ),
}


CAMERA = scenes.Camera(position=(-0.8, 1.0, 1.5), look_at=(-0.3, 0.0, 0.4), fov_deg=25.0)
"""It sees a corner of the floor, and that in part through a ghost."""


def make_scene(lamp, *, others):
    objects = (FLOOR, *OTHERS) if others else (FLOOR, OTHERS[-1])
    return scenes.Scene(objects=objects, emitters=(lamp,), camera=CAMERA)


def flux_of_cells(photons):
    """Flux that met the floor's cells, (x, z)."""
    on = (photons["object"] == 0) & (photons["side"] == 0)
    x, _, z = photons["position"][on].T
    return np.histogram2d(x, z, [ARCHES, ARCHES], weights=photons["flux"][on])[0]


def over_cells(corner_function):
    """∫ over each cell of f = ∂²F/∂x∂z, from F at the corners."""
    corners = corner_function(ARCHES[:, None] - LAMP[0], ARCHES[None, :] - LAMP[2])
    return np.diff(np.diff(corners, axis=0), axis=1)


def solid_angles():
    """Ω of each cell, seen from the lamp's centre.

    A rectangle (a, b) with a corner below the eye, at distance d, fills
    Ω = atan(a b / (d √(a² + b² + d²))) (Khadjavi 1968, J. Opt. Soc. Am. 58, 1417).
    """
    d = HEIGHT
    return over_cells(lambda a, b: np.arctan(a * b / (d * np.sqrt(a * a + b * b + d * d))))


def form_factors(lamp):
    """Fraction of a parallel rectangle's light that reaches each cell.

    F₁₂ = ΣΣΣΣ (−1)^(i+j+k+l) G(xᵢ, yⱼ, ηₖ, ξₗ) / A₁ (Howell, A Catalog of Radiation Heat
    Transfer Configuration Factors, C-13).
    """
    z = HEIGHT
    half_u, half_v = 0.5 * np.array(lamp.size)

    def corner(x, y, xi, eta):
        dx, dy = x - xi, y - eta
        across, along = np.hypot(dx, z), np.hypot(dy, z)
        log = 0.5 * z * z * np.log(dx * dx + dy * dy + z * z)
        return (
            dy * across * np.arctan(dy / across) + dx * along * np.arctan(dx / along) - log
        ) / (2.0 * np.pi)

    total = 0.0
    for sign_x, xi in ((1, half_u), (-1, -half_u)):
        for sign_y, eta in ((1, half_v), (-1, -half_v)):
            part = over_cells(lambda a, b, xi=xi, eta=eta: corner(a, b, xi, eta))
            total = total + sign_x * sign_y * part
    return total / (4.0 * half_u * half_v)


def expected_flux(kind, in_film):
    """Flux on each cell [W].

    Point: E = Φ cosθ / (4π d²), that is Φ Ω / 4π on a cell. Spot: Φ Ω / Ω(cone). A Lambertian
    sphere that is above the horizon everywhere gives the irradiance of a point (Lambert 1760,
    Photometria, §§ 86-92), a rectangle its form factor.
    """
    if kind == "rectangle":
        return in_film * form_factors(LAMPS[kind])
    cone = 2.0 * np.pi * (1.0 - np.cos(np.radians(75.0))) if kind == "spot" else 4.0 * np.pi
    return in_film * solid_angles() / cone


def test_the_form_factor_is_that_of_a_patch_far_away():
    # F ≈ A₂ cosθ₁ cosθ₂ / (π d²): the reference formula itself, where it must be plain.
    small = scenes.RectangleLamp(
        position=LAMP, size=(1e-3, 1e-3), normal=(0.0, -1.0, 0.0), flux=1.0, spectrum="E"
    )
    x, z = (0.5 * (ARCHES[:-1] + ARCHES[1:]) - LAMP[axis] for axis in (0, 2))
    d2 = x[:, None] ** 2 + z[None, :] ** 2 + HEIGHT**2
    patch = (2.0 * HALF / CELLS) ** 2 * HEIGHT**2 / (np.pi * d2**2)
    np.testing.assert_allclose(form_factors(small), patch, rtol=0.25)
    assert abs(form_factors(small).sum() / patch.sum() - 1.0) < 0.02


def any_guide(lamps):
    """A guide that has learned nonsense: cones and beams of uneven density, in uneven shares."""
    random = np.random.default_rng(5)
    cells = int(AIM_CELLS)

    def teach(aim, share, *, learns):
        # Smooth and steep, from 0.1 to 2, and another one for each.
        i, j = np.indices((cells, cells)) * random.uniform(2.0, 5.0) / cells
        density = 1.05 + 0.95 * np.sin(i + random.uniform(0, 6)) * np.cos(2 * j)
        distribution = cells_to_distribution(density / density.sum()) if learns else np.zeros(0)
        return replace(aim, share=share, distribution=distribution)

    # No areas: what they did is left to cones.
    kept = [[aim for aim in aims if aim.kind in {AIM_BASE, AIM_CONE}] for aims in lamps.aims]
    beams = lamps.data.emitters.numpy()["kind"] == 0
    aims = [
        tuple(teach(aim, 1 + k, learns=beam or aim.kind == AIM_CONE) for k, aim in enumerate(one))
        for one, beam in zip(kept, beams, strict=False)
    ]
    return Guide(tuple(1.0 for _ in aims), tuple(aims))


@pytest.mark.parametrize("aim", ["plain", "glass", "glass and view", "guide"])
@pytest.mark.parametrize("kind", list(LAMPS))
def test_irradiance_is_the_closed_form_however_photons_are_aimed(
    trace_passes, assert_mean, kind, aim
):
    lamp, aimed = LAMPS[kind], aim == "glass and view"
    scene = make_scene(lamp, others=aim != "plain")
    # Aimed at what the camera sees, few photons are left for the other cells: more are needed.
    photons, sharp = (60_000, 0.02) if aimed else (12_000, 0.01)
    guide = None
    if aim == "guide":
        photons, sharp, guide = 100_000, 0.02, any_guide
    passes = trace_passes(scene, photons=photons, passes=16, aimed=aimed, guide=guide)
    spectrum, film = lamp.emission(), scene.film
    in_film = FLUX * spectrum.band_flux(film.edges_nm).sum() / spectrum.total
    assert passes.flux == pytest.approx(in_film, rel=1e-12)
    # The lamps' whole flux, over all streams.
    emitted = np.array([books.emitted for books in passes.books])
    assert_mean(emitted, in_film)
    assert emitted.std(ddof=1) < 0.02 * in_film
    # And what arrives, cell by cell; the replicates' spread shows that the test is sharp.
    cells = passes.sums(flux_of_cells)
    expected = expected_flux(kind, in_film)
    assert_mean(cells, expected)
    assert np.all(cells.std(axis=0, ddof=1) / 4.0 < sharp * expected)


def test_a_lamp_that_nothing_is_aimed_for_radiates_its_flux_exactly(trace_passes):
    # A plane has no end to aim at: photons go as the lamp radiates, each with Φ/N.
    ground = scenes.SceneObject(
        name="ground",
        shape=scenes.Plane(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0)),
        material=scenes.Lambertian(reflectance=0.5),
    )
    stone = OTHERS[-1].model_copy(update={"material": scenes.Absorber()})
    for lamp in LAMPS.values():
        passes = trace_passes(scenes.Scene(objects=(ground, stone), emitters=(lamp,)), photons=5000)
        assert passes.books[0].emitted == pytest.approx(passes.flux, rel=1e-12)


def test_a_rectangle_shines_to_one_side_only(trace_passes):
    lamp = LAMPS["rectangle"].model_copy(update={"normal": (0.0, 1.0, 0.0)})
    passes = trace_passes(make_scene(lamp, others=True), photons=2000)
    assert len(passes.photons[0]["flux"]) == 0


@pytest.mark.parametrize("guide", [None, any_guide], ids=["aimed", "guided"])
def test_lamps_inside_of_what_they_are_aimed_at(trace_passes, assert_mean, guide):
    # A point lamp in the middle of a ghost inside a white box: all of its light arrives, and as
    # much on each of the six equal faces.
    ghost = scenes.Box(position=(0.0, 5.0, 0.0), size=(1.0, 1.0, 1.0))
    cube = scenes.Box(position=(0.0, 5.0, 0.0), size=(2.0, 2.0, 2.0))
    objects = (
        scenes.SceneObject(shape=cube, material=scenes.Lambertian(reflectance=1.0)),
        scenes.SceneObject(shape=ghost, material=EMPTY),
        FLOOR,
    )
    lamp = scenes.Point(position=(0.0, 5.0, 0.0), flux=FLUX, spectrum="E")
    scene = scenes.Scene(objects=objects, emitters=(lamp,))
    photons = 6000 if guide is None else 20_000
    passes = trace_passes(scene, photons=photons, passes=16, guide=guide)
    faces = passes.sums(lambda p: np.bincount(p["face"], weights=p["flux"], minlength=6))
    assert_mean(faces, passes.flux / 6.0)
    assert all(np.all(photons["side"] == 1) for photons in passes.photons)


def make_beam(profile, divergence_deg=0.0):
    """A beam onto the floor, inclined by atan(1/2) in the x-y plane, through no ghost."""
    return scenes.Beam(
        position=(0.4, 1.0, -0.4), direction=(-0.5, -1.0, 0.0), profile=profile,
        divergence_deg=divergence_deg, flux=FLUX, spectrum="D65",
    )


@pytest.mark.parametrize(
    "profile",
    [
        scenes.RoundProfile(radius=0.2),
        scenes.SlitProfile(width=0.3, height=0.1, up=(0.0, 0.0, 1.0)),
    ],
    ids=["round", "slit"],
)
def test_beams_fill_their_profile_evenly_and_keep_their_flux_exactly(
    trace_passes, assert_mean, profile
):
    beam = make_beam(profile)
    passes = trace_passes(make_scene(beam, others=False), photons=10_000, passes=16)
    for photons, books in zip(passes.photons, passes.books, strict=True):
        assert books.emitted == pytest.approx(passes.flux, rel=1e-12)
        assert books.deposited == pytest.approx(passes.flux, rel=1e-12)
        np.testing.assert_allclose(photons["flux"], passes.flux / 10_000, rtol=1e-12)
        np.testing.assert_allclose(
            photons["direction"], np.tile(beam.direction, (10_000, 1)), atol=1e-7
        )
    # Back along the beam, onto the profile: (u, v) there, in units of its half sizes.
    u, v, axis = beam.frame()
    u_half = profile.radius if profile.type == "round" else 0.5 * profile.width
    v_half = profile.radius if profile.type == "round" else 0.5 * profile.height

    def across(photons):
        offset = photons["position"] - beam.position
        offset = offset - (offset @ axis)[:, None] * axis
        return offset @ u / u_half, offset @ v / v_half

    for photons in passes.photons:
        x, y = across(photons)
        edge = np.hypot(x, y) if profile.type == "round" else np.maximum(np.abs(x), np.abs(y))
        assert 0.99 < edge.max() < 1.0 + 1e-12
    # Even filling: moments of a uniform disk, ⟨x²⟩ = 1/4 and ⟨x²y²⟩ = 1/24, or square, 1/3 and 1/9.
    second, mixed = (1 / 4, 1 / 24) if profile.type == "round" else (1 / 3, 1 / 9)
    for moment, expected in (
        (lambda x, y: x, 0.0),
        (lambda x, y: y, 0.0),
        (lambda x, y: x * y, 0.0),
        (lambda x, y: x * x, second),
        (lambda x, y: y * y, second),
        (lambda x, y: x * x * y * y, mixed),
    ):
        means = passes.sums(lambda p, moment=moment: np.mean(moment(*across(p))))
        assert_mean(means, expected)
        assert means.std() < 2e-3


def test_divergence_fills_its_cone_evenly(trace_passes, assert_mean):
    half = np.radians(5.0)
    beam = make_beam(scenes.RoundProfile(radius=0.05), divergence_deg=5.0)
    passes = trace_passes(make_scene(beam, others=False), photons=10_000, passes=16)
    axis = np.array(beam.direction)

    def angles(photons):
        cross = np.linalg.norm(np.cross(photons["direction"], axis), axis=1)
        return np.arctan2(cross, photons["direction"] @ axis)

    # Directions are single precision: 1e-7. Uniform over the cone: ⟨1 − cosθ⟩ = (1 − cosθmax)/2.
    assert max(angles(photons).max() for photons in passes.photons) < half + 1e-6
    means = passes.sums(lambda p: np.mean(2.0 * np.sin(0.5 * angles(p)) ** 2))
    assert_mean(means, np.sin(0.5 * half) ** 2, slack=1e-9)
    assert means.std() < 1e-2 * means.mean()
    sideways = passes.sums(lambda p: np.mean(p["direction"] @ np.stack(beam.frame()[:2]).T, axis=0))
    assert_mean(sideways, 0.0)


@pytest.mark.parametrize(
    "profile", [scenes.RoundProfile(radius=0.2), scenes.SlitProfile(width=0.3, height=0.1)]
)
def test_a_beams_profile_is_even_however_it_is_drawn(trace_passes, assert_mean, profile):
    # As it is by itself: in flux, where its photons are not. ⟨x²⟩ = 1/4 on a disk, 1/3 on a square.
    beam = make_beam(profile)
    passes = trace_passes(
        make_scene(beam, others=False), photons=20_000, passes=16, guide=any_guide
    )
    assert_mean([books.emitted for books in passes.books], passes.flux)
    u, v, axis = beam.frame()
    u_half = profile.radius if profile.type == "round" else 0.5 * profile.width
    v_half = profile.radius if profile.type == "round" else 0.5 * profile.height

    def moments(photons):
        offset = photons["position"] - beam.position
        offset = offset - (offset @ axis)[:, None] * axis
        x, y, flux = offset @ u / u_half, offset @ v / v_half, photons["flux"]
        assert flux.max() > 2.0 * flux.min()  # it is drawn unevenly
        return [flux @ x, flux @ y, flux @ (x * y), flux @ (x * x), flux @ (y * y)]

    second = 1.0 / 4.0 if profile.type == "round" else 1.0 / 3.0
    found = passes.sums(moments)
    assert_mean(found, passes.flux * np.array([0.0, 0.0, 0.0, second, second]))
    assert np.all(found.std(axis=0) < 0.01 * passes.flux)
