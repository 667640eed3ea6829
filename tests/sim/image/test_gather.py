"""The gather is Epanechnikov's estimate over the photons of one side, with its edges mended."""

import numpy as np
import pytest

import scenes

RADIUS = 0.15
UP = np.array([0.0, 1.0, 0.0])
FLOOR, TRAY, BOX, WEDGE = range(4)

REFLECTANCE = scenes.ReflectanceTable(
    wavelength_nm=(400.0, 500.0, 520.0, 700.0), values=(0.9, 0.2, 0.6, 0.4)
)
OBJECTS = (
    scenes.SceneObject(
        name="floor",
        shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 1.6)),
        material=scenes.Lambertian(reflectance=REFLECTANCE),
    ),
    scenes.SceneObject(
        name="tray",
        shape=scenes.Disk(position=(2.0, 0.5, 0.0), normal=(0.3, 1.0, 0.0), radius=0.4),
        material=scenes.Lambertian(reflectance=0.7),
    ),
    scenes.SceneObject(
        name="box",
        shape=scenes.Box(position=(-2.0, 0.2, 0.0), size=(0.8, 0.4, 0.6), rotation_deg=(0, 30, 0)),
        material=scenes.Lambertian(reflectance=0.7),
    ),
    scenes.SceneObject(
        name="wedge",
        shape=scenes.Prism(
            position=(0.4, 0.8, 0.2), rotation_deg=(0, 20, 10), apex_deg=50.0, base=0.4, length=0.6
        ),
        material=scenes.Dielectric(medium="SF11"),
    ),
)
LAMPS = (
    scenes.Point(position=(-0.3, 2.0, 0.2), flux=5.0, spectrum="D65"),
    scenes.Point(position=(0.5, 2.0, 0.0), flux=2.0, spectrum="sodium"),
    scenes.Beam(  # from below
        position=(0.0, -1.0, 0.0), direction=(0.0, 1.0, 0.0), flux=1.0, spectrum="E",
        profile=scenes.RoundProfile(radius=0.6),
    ),
)


@pytest.fixture(scope="module")
def room(darkroom):
    scene = scenes.Scene(
        objects=OBJECTS, emitters=LAMPS, film=scenes.Film(first_nm=430, last_nm=670, bands=7)
    )
    return darkroom(scene, photons=30_000, radius=RADIUS)


def expected_radiance(room, point, surface, inside):
    """L_b = Σ K(d) ρ Φ_b / (π Δλ), K = 2/(π r²) (1 − d²/r²) / ∫K over the receiver.

    `surface` is (object, face, side); `inside` the kernel's integral. A photon that dispersion
    has touched counts in the band of its wavelength, any other in all, as its lamp shines.
    """
    photons, edges_nm = room.photons[0], room.edges_nm
    d2 = np.sum((photons["position"] - point) ** 2, axis=1)
    one_side = np.array(
        [photons[name] == value for name, value in zip(("object", "face", "side"), surface,
                                                       strict=True)]
    ).all(axis=0)
    near = (d2 < RADIUS**2) & one_side
    kernel = 2.0 / (np.pi * RADIUS**2) * (1.0 - d2[near] / RADIUS**2) / inside
    weight = kernel * photons["flux"][near]
    material = OBJECTS[surface[0]].material
    fine_nm = np.linspace(edges_nm[0], edges_nm[-1], 7 * 2000 + 1)
    rho = material.reflectance_at(0.5 * (fine_nm[1:] + fine_nm[:-1]))
    total = np.zeros(7)
    dispersed = photons["dispersed"][near]
    wavelength_nm = photons["wavelength_nm"][near]
    own = weight * material.reflectance_at(wavelength_nm)
    total += np.histogram(wavelength_nm[dispersed], edges_nm, weights=own[dispersed])[0]
    for row, lamp in enumerate(LAMPS):
        spectrum = lamp.emission().restricted(edges_nm[0], edges_nm[-1])
        share = (spectrum.band_flux(fine_nm) * rho).reshape(7, 2000).sum(axis=1) / spectrum.total
        total += share * weight[(photons["emitter"][near] == row) & ~dispersed].sum()
    assert near.sum() > 20
    return total / (np.pi * np.diff(edges_nm))


def integral_over(holds, point, u, v):
    """∫K over the part of the disc where `holds(points)`, by midpoints on a fine grid."""
    side = (np.arange(1200) + 0.5) / 600.0 - 1.0
    x, y = np.meshgrid(side, side)
    kernel = np.maximum(1.0 - x * x - y * y, 0.0)
    points = point + RADIUS * (x[..., None] * u + y[..., None] * v)
    return float((kernel * holds(points)).sum() / kernel.sum())


def on_floor(points):
    return (np.abs(points[..., 0]) <= 1.0) & (np.abs(points[..., 2]) <= 0.8)


def on_tray(points):
    return np.linalg.norm(points - OBJECTS[TRAY].shape.position, axis=-1) <= 0.4


@pytest.mark.parametrize(
    "x, z",
    [(0.0, 0.0), (0.5, 0.2), (-0.3, 0.3), (0.99, 0.1), (0.2, -0.78), (0.95, 0.75), (1.0, 0.8)],
)
def test_the_floor_under_two_lamps_and_a_wedge(room, x, z):
    point = np.array([x, 0.0, z]) * (1.0 - 1e-6)
    inside = integral_over(on_floor, point, *np.eye(3)[[0, 2]])
    seen = room.look(point + 0.3 * UP, -UP)
    expected = expected_radiance(room, point, (FLOOR, 0, 0), inside)
    # The pixel is 3e-8 wide and K changes by 2/r a metre; ρ's sums over a band, here by 0.02 nm,
    # are good to 1e-5. The overhang is measured in 64 directions.
    rtol = 2e-5 if inside > 1.0 - 1e-9 else 3e-3
    np.testing.assert_allclose(seen, expected, rtol=rtol)
    if (x, z) == (1.0, 0.8):
        # A corner keeps a quarter of the disc.
        assert inside == pytest.approx(0.25, abs=1e-3)


def test_the_floors_back_is_lit_by_what_is_below(room):
    point = np.array([0.1, 0.0, -0.2])
    seen = room.look(point - 0.3 * UP, UP)
    expected = expected_radiance(room, point, (FLOOR, 0, 1), 1.0)
    np.testing.assert_allclose(seen, expected, rtol=2e-5)
    # "E" alone, so that bands differ as reflectances do: 0.66 at 430 nm, 0.42 at 670.
    rho = OBJECTS[FLOOR].material.reflectance_at([430.0, 670.0])
    assert seen[-1] / seen[0] == pytest.approx(rho[1] / rho[0], rel=2e-3)


@pytest.mark.parametrize("rho, phi", [(0.0, 0.0), (0.2, 1.0), (0.3, 2.0), (0.395, 4.0)])
def test_a_disk_to_its_rim(room, rho, phi):
    shape = OBJECTS[TRAY].shape
    normal = np.array(shape.normal)
    u = np.cross(normal, [0.0, 0.0, 1.0])
    u /= np.linalg.norm(u)
    v = np.cross(normal, u)
    point = shape.position + rho * (np.cos(phi) * u + np.sin(phi) * v)
    inside = integral_over(on_tray, point, u, v)
    seen = room.look(point + 0.3 * normal, -normal)
    expected = expected_radiance(room, point, (TRAY, 0, 0), inside)
    np.testing.assert_allclose(seen, expected, rtol=2e-5 if inside > 1.0 - 1e-9 else 3e-3)


@pytest.mark.parametrize("a, b", [(0.0, 0.0), (0.3, 0.1), (0.39, 0.0), (-0.39, -0.29)])
def test_a_boxs_face_to_its_edges(room, a, b):
    shape = OBJECTS[BOX].shape
    turn = scenes.rotation_matrix(shape.rotation_deg)
    normals, _ = shape.faces()
    top = int(np.argmax(normals[:, 1]))
    point = np.array(shape.position) + turn @ [a, 0.2, b]

    def on_top(points):
        local = (points - shape.position) @ turn
        return (np.abs(local[..., 0]) <= 0.4) & (np.abs(local[..., 2]) <= 0.3)

    inside = integral_over(on_top, point, turn[:, 0], turn[:, 2])
    seen = room.look(point + 0.3 * UP, -UP)
    expected = expected_radiance(room, point, (BOX, top, 0), inside)
    np.testing.assert_allclose(seen, expected, rtol=2e-5 if inside > 1.0 - 1e-9 else 3e-3)


def test_what_no_light_reaches_is_black(room):
    # The box from below, and empty space.
    np.testing.assert_array_equal(room.look([-2.0, -0.3, 0.0], UP), 0.0)
    np.testing.assert_array_equal(room.look([0.0, 3.0, 0.0], UP), 0.0)
