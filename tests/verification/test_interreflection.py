"""Light between diffuse surfaces, in the integrating sphere.

A sphere that is diffuse inside, of reflectance ρ, is lit evenly from everywhere: a lamp of flux Φ
at its centre gives E₀ = Φ/(4πR²), and every bounce ρ times the one before, so that after n bounces

    E = E₀ (1 + ρ + … + ρⁿ) → E₀/(1 − ρ),    L = ρ E/π

(Goebel 1967, "Generalized integrating-sphere theory", Appl. Opt. 6, 125, eq. (1) without ports).
"""

import numpy as np
import pytest

import scenes
import sim

RADIUS, FLUX = 0.5, 10.0
GREY = 0.7
COLOURED = scenes.ReflectanceTable(wavelength_nm=(500.0, 600.0), values=(0.2, 0.8))
FILM = scenes.Film(width=24, height=24, first_nm=500.0, last_nm=600.0, bands=3)


def integrating_sphere(reflectance):
    return scenes.Scene(
        objects=(
            scenes.SceneObject(
                shape=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=RADIUS),
                material=scenes.Lambertian(reflectance=reflectance),
            ),
        ),
        emitters=(scenes.Point(position=(0.0, 0.0, 0.0), flux=FLUX, spectrum="E"),),
        camera=scenes.Camera(position=(0.0, 0.1, 0.3), look_at=(0.0, 0.0, -0.5), fov_deg=70.0),
        film=FILM,
    )


def rendered(reflectance, bounces, **options):
    settings = sim.RenderSettings(
        photons=40_000, passes=4, bounces=bounces, radius=0.02, seed=3, **options
    )
    return sim.render(integrating_sphere(reflectance), settings)


def spectral_irradiance(scene):
    """E₀ per nm in each band [W m⁻² nm⁻¹]: "E" is flat over 360 to 830 nm."""
    return FLUX / (4.0 * np.pi * RADIUS**2) / (830.0 - 360.0)


@pytest.mark.parametrize("bounces", [0, 1, 1000])
def test_each_bounce_adds_its_share_of_the_light(bounces):
    picture = rendered(GREY, bounces)
    series = sum(GREY**k for k in range(min(bounces, 400) + 1))
    expected = GREY / np.pi * spectral_irradiance(picture.scene) * series
    mean = picture.spectral_radiance.mean()
    # Of the 4 passes' 160,000 photons each bounce keeps one in 4: the camera sees a third of the
    # sphere, so the mean over it has a relative σ of less than 1/√(160,000/12) = 0.9 %, and a
    # third of that where direct light, without noise, is most of it. The discs of a curved
    # receiver take in 1 + (r/R)²/4 too much: 0.2 % at 4 × 0.02 / 0.5.
    assert mean == pytest.approx(expected, rel=4 * 0.009 if bounces else 1e-3)


def test_colours_bleed_by_the_spectral_reflectance():
    picture = rendered(COLOURED, 1000)
    edges = picture.edges_nm
    wavelengths = np.linspace(edges[0], edges[-1], 1501)[:-1]
    rho = COLOURED.values[0] + (COLOURED.values[1] - COLOURED.values[0]) * np.clip(
        (wavelengths - 500.0) / 100.0, 0.0, 1.0
    )
    radiance = rho / np.pi * spectral_irradiance(picture.scene) / (1.0 - rho)
    for band in range(3):
        inside = (wavelengths >= edges[band]) & (wavelengths < edges[band + 1])
        mean = picture.spectral_radiance[..., band].mean()
        # A third of the photons in each band: √3 times the σ of the test above.
        assert mean == pytest.approx(radiance[inside].mean(), rel=4 * 0.016)


@pytest.mark.parametrize("bounces", [0, 5])
def test_the_books_balance(bounces):
    books = rendered(GREY, bounces).energy
    gone = books.deposited + books.absorbed + books.escaped + books.culled
    assert gone == pytest.approx(books.emitted, rel=1e-12)
    assert books.escaped == 0.0


def test_direct_light_by_photons_and_by_shadow_rays_is_the_same():
    by_lamps, by_photons = (
        rendered(GREY, 3, direct_light=choice).spectral_radiance.mean()
        for choice in ("lamps", "photons")
    )
    assert by_photons == pytest.approx(by_lamps, rel=4 * 0.009)


def test_threads_do_not_change_the_picture():
    one, two = (rendered(GREY, 3, threads=n).spectral_radiance for n in (1, 2))
    np.testing.assert_array_equal(one, two)
