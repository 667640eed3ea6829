"""The camera sees the lamps themselves: their radiance, wherever nothing opaque is in front."""

import numpy as np
import pytest

import scenes

FLUX, BANDS, WIDTH_NM = 3.0, 2, 50.0
SPREAD = {"first_nm": 500.0, "last_nm": 550.0, "bands": BANDS}
BACK = scenes.SceneObject(
    name="back",
    shape=scenes.Rectangle(position=(0.0, 0.0, -5.0), size=(1.0, 1.0), normal=(0.0, 0.0, 1.0)),
    material=scenes.Lambertian(reflectance=0.0),
)
CONSTANT, FLINT = scenes.ConstantMedium(eta=1.5), "SF11"


def sphere(**fields):
    return scenes.SphereLamp(
        position=(0.0, 0.0, 0.0), radius=0.2, flux=FLUX, spectrum="E", **fields
    )


def rectangle(position=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0), **fields):
    return scenes.RectangleLamp(
        position=position, size=(0.5, 0.4), normal=normal, flux=FLUX, spectrum="E", **fields
    )


def plate(material, *, at=0.5):
    return scenes.SceneObject(
        name="plate",
        shape=scenes.Box(position=(0.0, 0.0, at), size=(1.0, 1.0, 0.1)),
        material=material,
    )


def spectral_radiance(lamp):
    """A Lambertian surface of area A has Φ = π A L, and "E" spreads it evenly over 360–830 nm."""
    area = 0.2 if isinstance(lamp, scenes.RectangleLamp) else 4.0 * np.pi * 0.2**2
    return FLUX / (np.pi * area) / (830.0 - 360.0)


def seen(
    darkroom, lamp, *objects, position=(0.0, 0.0, 2.0), direction=(0.0, 0.0, -1.0), samples=1,
    **fields
):
    """(samples, bands) radiance along one ray: pixels, a ten-millionth of a radian wide."""
    scene = scenes.Scene(
        objects=(BACK, *objects), emitters=(lamp,), film=scenes.Film(**SPREAD), **fields
    )
    room = darkroom(scene, photons=10, radius=0.1, direct_light="lamps")
    ahead = tuple(np.add(position, direction))
    camera = scenes.Camera(position=position, look_at=ahead, up=(0.3, 1.0, 0.1), fov_deg=6e-6)
    film = room.create_film(width=samples)
    room.expose(film, camera)
    return film.radiance()[0]


def normal_reflectance(eta):
    """((η − 1)/(η + 1))², Born & Wolf (1999), §1.5.3."""
    return ((eta - 1.0) / (eta + 1.0)) ** 2


@pytest.mark.parametrize("lamp", [sphere(), rectangle()], ids=["sphere", "rectangle"])
def test_a_lamp_is_as_bright_as_its_flux_and_area_say(darkroom, lamp):
    expected = spectral_radiance(lamp)
    np.testing.assert_allclose(seen(darkroom, lamp), expected, rtol=1e-6)
    # Lambertian: equally bright from aside.
    aside = np.array([1.0, 0.7, 1.5])
    found = seen(darkroom, lamp, position=tuple(aside), direction=tuple(-aside))
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.parametrize(
    ("lamp", "position", "direction"),
    [
        (sphere(), (0.0, 0.21, 2.0), (0.0, 0.0, -1.0)),  # beside it
        (sphere(), (0.0, 0.0, 2.0), (0.0, 0.0, 1.0)),  # away from it
        (sphere(), (0.0, 0.05, 0.0), (0.0, 0.0, -1.0)),  # inside it, where it does not shine
        (rectangle(), (0.0, 0.21, 2.0), (0.0, 0.0, -1.0)),
        (rectangle(), (0.26, 0.0, 2.0), (0.0, 0.0, -1.0)),
        (rectangle(), (0.0, 0.0, 2.0), (0.0, 0.0, 1.0)),
        (rectangle(), (0.0, 0.0, -2.0), (0.0, 0.0, 1.0)),  # its back
        (sphere(visible=False), (0.0, 0.0, 2.0), (0.0, 0.0, -1.0)),
        (rectangle(visible=False), (0.0, 0.0, 2.0), (0.0, 0.0, -1.0)),
    ],
)
def test_where_a_lamp_is_not_there_is_nothing(darkroom, lamp, position, direction):
    assert not seen(darkroom, lamp, position=position, direction=direction).any()


@pytest.mark.parametrize("lamp", [sphere(), rectangle()], ids=["sphere", "rectangle"])
def test_a_lamp_is_hidden_by_what_is_in_front_of_it_alone(darkroom, lamp):
    assert not seen(darkroom, lamp, plate(scenes.Absorber())).any()
    found = seen(darkroom, lamp, plate(scenes.Absorber(), at=-0.5))
    np.testing.assert_allclose(found, spectral_radiance(lamp), rtol=1e-6)


def test_a_lamp_on_a_wall_is_in_front_of_it(darkroom):
    lamp = rectangle(position=BACK.shape.position)
    np.testing.assert_allclose(seen(darkroom, lamp), spectral_radiance(lamp), rtol=1e-6)


@pytest.mark.parametrize("medium", [CONSTANT, FLINT], ids=["constant", "dispersive"])
@pytest.mark.parametrize("lamp", [sphere(), rectangle()], ids=["sphere", "rectangle"])
def test_a_lamp_behind_a_plate_has_its_transmittance(darkroom, assert_mean, lamp, medium):
    glass = scenes.Dielectric(medium=medium)
    found = seen(darkroom, lamp, plate(glass), samples=2000)
    # All internal reflections: T = (1 − R)/(1 + R) (Duffie & Beckman 2013, §5.3). In a band of
    # SF11 the index varies by 0.02, and T, nearly linear over it, is that of the band's middle.
    wavelengths_nm = np.array([500.0, 550.0])
    r = normal_reflectance(glass.resolved().eta(wavelengths_nm))
    assert_mean(found / spectral_radiance(lamp), (1.0 - r) / (1.0 + r), slack=1e-4)


def test_a_lamp_is_seen_by_reflection_once(darkroom, assert_mean):
    # The lamp is behind the camera, and the plate before it: both faces together reflect
    # 2R/(1 + R), the rest of T above.
    lamp = rectangle(position=(0.0, 0.0, 3.0), normal=(0.0, 0.0, -1.0))
    found = seen(
        darkroom, lamp, plate(scenes.Dielectric(medium=CONSTANT)), samples=2000
    )
    r = normal_reflectance(1.5)
    expected = 2.0 * r / (1.0 + r)
    assert_mean(found / spectral_radiance(lamp), expected)
    # Without grain: the reflections of both faces, R and (1 − R)² R, are worth more outside than
    # w = 0.03, below which a branch plays roulette. Only what the front sends back in, (1 − R) R²,
    # goes on as w with a chance of (1 − R) R²/w = 0.051, what the back reflects of that, R w, as w
    # with one of R, and of that one sees (1 − R) w: σ = 0.0013, 0.017 of all that is reflected. In
    # 2000 pixels 4 ± 2 are so bright; 0.05 would take 35. Roulette for all that the back reflects,
    # by its radiance in the glass, which is less by η², would leave 0.4.
    assert np.std(found[:, 0]) < 0.05 * expected * spectral_radiance(lamp)


@pytest.mark.parametrize("tinted", [False, True])
@pytest.mark.parametrize("lamp", [sphere(), rectangle()], ids=["sphere", "rectangle"])
def test_a_lamp_is_dimmed_by_the_way_to_it_alone(darkroom, assert_mean, lamp, tinted):
    # Beer–Lambert in the ambient medium, over 2 m to the rectangle and 1.8 m to the sphere; what
    # is behind the lamp does not matter.
    alpha = np.array([0.4, 0.9]) if tinted else np.array([0.4, 0.4])
    table = scenes.CoefficientTable(wavelength_nm=(475.0, 575.0), values=tuple(alpha))
    ink = scenes.CauchyMedium(
        a=(1.3,), range_nm=(300.0, 900.0), absorption=scenes.NapierianAbsorption(coefficient=table)
    )
    found = seen(darkroom, lamp, ambient=ink, samples=400)
    # Of exp(−α d) over a band from 475 to 525 nm and one from 525 to 575, α linear in between.
    distance = 2.0 if isinstance(lamp, scenes.RectangleLamp) else 1.8
    edges = np.interp([0.0, 0.5, 1.0], [0.0, 1.0], alpha * distance)
    low, high = edges[:-1], edges[1:]
    expected = (np.exp(-low) - np.exp(-high)) / (high - low) if tinted else np.exp(-low)
    assert_mean(found / spectral_radiance(lamp), expected, slack=1e-9)
