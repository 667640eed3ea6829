"""Rendering: the same picture however it is run, and one clear error where there is none."""

import dataclasses
import sys

import numpy as np
import pytest

import scenes
import sim
from sim.image.gather_radius import gather_radius, radius_shrinkage
from sim.image.survey import Survey

render_module = sys.modules[sim.render.__module__]


def render(scene, **settings):
    return sim.render(scene, sim.RenderSettings(**settings))


@pytest.fixture(scope="module")
def picture(small_scene):
    return render(small_scene, threads=2)


def test_the_picture_is_whole(small_scene, picture):
    film = small_scene.film
    shape = (film.height, film.width, film.bands)
    assert picture.spectral_radiance.shape == picture.standard_error.shape == shape
    assert picture.spectral_radiance.dtype == picture.standard_error.dtype == np.float64
    assert np.isfinite(picture.spectral_radiance).all()
    assert np.isfinite(picture.standard_error).all()
    assert picture.spectral_radiance.min() >= 0.0
    assert picture.spectral_radiance.max() > 0.0
    np.testing.assert_array_equal(picture.edges_nm, film.edges_nm)
    assert picture.scene is small_scene
    assert (picture.settings.photons, picture.settings.passes) == (2000, 2)
    assert min(picture.timings.values()) >= 0.0
    assert picture.srgb.shape == (film.height, film.width, 3)
    # D65's part between 390 and 710 nm of 1 W, but for the noise of a learned profile: 4000
    # photons, evenly drawn; and every watt is found.
    spectrum = small_scene.emitters[0].emission()
    emitted = spectrum.band_flux(film.edges_nm).sum() / spectrum.total
    assert picture.energy.emitted == pytest.approx(emitted, rel=5e-3)
    assert abs(picture.energy.residual) < 1e-12


@pytest.mark.parametrize("threads", [1, 4])
def test_the_number_of_threads_changes_nothing(small_scene, picture, threads):
    other = render(small_scene, threads=threads)
    np.testing.assert_array_equal(other.spectral_radiance, picture.spectral_radiance)
    np.testing.assert_array_equal(other.standard_error, picture.standard_error)
    assert other.energy == picture.energy


@pytest.mark.parametrize("threads", [1, 4])
def test_nor_where_work_is_cut_into_many_ranges(small_scene, threads):
    # 30,000 photons and 5,000 pixels, a third of them behind glass, are several ranges each.
    film = small_scene.film.model_copy(update={"width": 80, "height": 64})
    scene = small_scene.model_copy(update={"film": film})
    some, two = (
        render(scene, photons=30_000, passes=3, threads=count) for count in (threads, 2)
    )
    np.testing.assert_array_equal(some.spectral_radiance, two.spectral_radiance)
    np.testing.assert_array_equal(some.standard_error, two.standard_error)
    assert some.energy == two.energy


def test_seeds_decide(small_scene, picture):
    again, other = render(small_scene), render(small_scene, seed=1)
    np.testing.assert_array_equal(again.spectral_radiance, picture.spectral_radiance)
    assert not np.array_equal(other.spectral_radiance, picture.spectral_radiance)
    # Yet it is the same scene: sums of light agree within their errors.
    total, error = (
        np.array([one.spectral_radiance.sum() for one in (picture, other)]),
        np.array([np.sqrt((one.standard_error**2).sum()) for one in (picture, other)]),
    )
    assert abs(total[0] - total[1]) < 5.0 * np.hypot(*error) + 0.1 * total[0]


def test_one_pass_is_a_picture_without_errors(small_scene):
    single = render(small_scene, passes=1)
    assert np.isnan(single.standard_error).all()
    assert single.spectral_radiance.max() > 0.0


def test_single_precision_gives_the_same_picture(small_scene):
    # The photons are the same to rounding; those near an edge may fall on its other side.
    double, single = (
        render(small_scene, photons=20_000, precision=name) for name in ("float64", "float32")
    )
    assert single.settings.precision == "float32"
    assert abs(single.energy.residual) < 2e-6
    assert single.energy.emitted == pytest.approx(double.energy.emitted, rel=1e-6)
    assert single.energy.deposited == pytest.approx(double.energy.deposited, rel=1e-3)
    scale = double.spectral_radiance.max()
    off = np.abs(single.spectral_radiance - double.spectral_radiance)
    assert np.median(off) < 1e-3 * scale
    assert np.mean(off) < 2e-2 * scale


def test_progress_is_told(small_scene):
    events = []
    sim.render(small_scene, sim.RenderSettings(threads=2), progress=events.append)
    assert events[0].photons_done == 0
    assert events[-1].photons_done == events[-1].photons_total == 4000
    assert [event.photons_done for event in events] == sorted(
        event.photons_done for event in events
    )
    assert {event.passes for event in events} == {2}
    assert {event.pass_index for event in events} <= {0, 1}
    assert all(event.stage for event in events)


LACKING = {
    "camera": {"camera": None},
    "emitters": {"emitters": ()},
    "objects": {"objects": ()},
}


@pytest.mark.parametrize("what", list(LACKING))
def test_a_scene_that_lacks_something_is_refused_before_anything_starts(
    small_scene, monkeypatch, what
):
    def never(*_args, **_keywords):
        raise AssertionError("nothing must start")

    for name in ("start_device", "choose_kernels"):
        monkeypatch.setattr(render_module, name, never)
    with pytest.raises(scenes.SceneError) as caught:
        sim.render(small_scene.model_copy(update=LACKING[what]))
    assert {problem.path for problem in caught.value.problems} == {what}


def test_light_that_the_film_does_not_record_is_none(small_scene):
    infrared = small_scene.emitters[0].model_copy(
        update={"spectrum": scenes.Laser(wavelength_nm=1064.0)}
    )
    with pytest.raises(scenes.SceneError, match="390 and 710 nm"):
        sim.render(small_scene.model_copy(update={"emitters": (infrared,)}))


@pytest.fixture(scope="module")
def looking_away(small_scene):
    up = scenes.Camera(position=(0.0, 2.0, 4.0), look_at=(0.0, 9.0, 4.1), fov_deg=20.0)
    return small_scene.model_copy(update={"camera": up})


def test_a_camera_that_sees_no_receiver_needs_a_radius(looking_away):
    with pytest.raises(sim.SettingsError) as caught:
        sim.render(looking_away)
    assert caught.value.field == "radius"
    black = render(looking_away, radius=0.1)
    np.testing.assert_array_equal(black.spectral_radiance, 0.0)
    np.testing.assert_array_equal(black.standard_error, 0.0)


def test_a_receiver_that_no_light_reaches_is_black(small_scene):
    away = small_scene.emitters[0].model_copy(update={"direction": (0.0, 1.0, 0.0)})
    dark = render(small_scene.model_copy(update={"emitters": (away,)}))
    np.testing.assert_array_equal(dark.spectral_radiance, 0.0)
    assert dark.energy.escaped == pytest.approx(dark.energy.emitted, rel=1e-12)


def test_the_radius_is_a_few_pixels_of_the_median_width():
    survey = Survey(
        widths=np.array([1.0, 2.0, 50.0]), points=np.zeros((3, 3)), objects=np.zeros(3, dtype=int)
    )
    radius = gather_radius(survey)
    assert 1.0 * 2.0 <= radius <= 5.0 * 2.0
    wider = dataclasses.replace(survey, widths=3.0 * survey.widths)
    assert gather_radius(wider) == pytest.approx(3.0 * radius)


@pytest.mark.parametrize("alpha", [2 / 3, 0.5, 1.0])
def test_the_radius_shrinks_as_knaus_and_zwicker_say(alpha):
    # r²ᵢ₊₁ / r²ᵢ = (i + α)/(i + 1), i = 1, 2, … (Knaus & Zwicker 2011, eq. 15).
    radii = np.array([radius_shrinkage(index, alpha) for index in range(20)])
    i = np.arange(1.0, 20.0)
    assert radii[0] == 1.0
    shrinkage = radii[1:] ** 2 / radii[:-1] ** 2
    np.testing.assert_allclose(shrinkage, (i + alpha) / (i + 1.0), rtol=1e-12)


def test_reflectances_and_spectra_meet_band_by_band(small_scene):
    # The floor under a wide beam, no glass in the way: L_b = Φ/A ∫_b s ρ dλ / (π Δλ ∫s).
    table = scenes.ReflectanceTable(wavelength_nm=(450.0, 550.0, 650.0), values=(0.1, 0.9, 0.3))
    ball, floor = small_scene.objects
    coloured = floor.model_copy(update={"material": scenes.Lambertian(reflectance=table)})
    aside = ball.model_copy(
        update={"shape": ball.shape.model_copy(update={"position": (9.0, 1.0, 0.0)})}
    )
    beam = scenes.Beam(
        position=(0.0, 3.0, 0.0), direction=(0.0, -1.0, 0.0), flux=16.0, spectrum="A",
        profile=scenes.SlitProfile(width=4.0, height=4.0),
    )
    camera = scenes.Camera(position=(0.0, 2.0, 1.0), look_at=(0.0, 0.0, 0.0), fov_deg=30.0)
    scene = small_scene.model_copy(
        update={"objects": (aside, coloured), "emitters": (beam,), "camera": camera}
    )
    seen = render(scene, photons=50_000).spectral_radiance
    edges_nm = scene.film.edges_nm
    fine_nm = np.linspace(edges_nm[0], edges_nm[-1], 4 * 800 + 1)
    spectrum = beam.emission()
    rho = coloured.material.reflectance_at(0.5 * (fine_nm[1:] + fine_nm[:-1]))
    bands = (spectrum.band_flux(fine_nm) * rho).reshape(4, 800).sum(axis=1)
    expected = bands / spectrum.total / (np.pi * np.diff(edges_nm))
    # No photon has met glass: all bands share one noise, and their ratios are exact, but for the
    # host's sums over parts of a band, 2 nm here. By the midpoint rule each of ρ's kinks, at most
    # 0.014/nm, costs 0.014 (2 nm)²/8 of ∫ρ dλ ≥ 10 nm.
    ratios = seen / seen[..., :1]
    np.testing.assert_allclose(
        ratios, np.broadcast_to(expected / expected[0], ratios.shape), rtol=7e-4
    )
    assert seen[..., 0].mean() == pytest.approx(expected[0], rel=0.01)
