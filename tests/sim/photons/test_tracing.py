"""Photons arrive where, and as what, geometry and Fresnel's formulas say."""

import numpy as np
import pytest

import scenes
from sim.photons import tracing

WHITE = scenes.Lambertian(reflectance=1.0)
FLUX = 2.0


def make_glass(eta):
    """Glass without dispersion, by Sellmeier's formula without a resonance."""
    return scenes.Dielectric(
        medium=scenes.SellmeierMedium(b=(eta**2 - 1.0,), c_um2=(0.0,), range_nm=(300.0, 900.0))
    )


def make_plate_scene(material, *, ceiling=True, divergence_deg=0.0):
    """A beam straight down through a plate onto a floor, under a ceiling for what comes back."""
    objects = [
        scenes.SceneObject(
            name="floor",
            shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(9.0, 9.0)),
            material=WHITE,
        ),
        scenes.SceneObject(
            name="plate",
            shape=scenes.Box(position=(0.0, 0.5, 0.0), size=(3.0, 0.1, 3.0)),
            material=material,
        ),
    ]
    if ceiling:
        shape = scenes.Rectangle(position=(0.0, 2.0, 0.0), size=(9.0, 9.0))  # it shows its back
        objects.append(scenes.SceneObject(name="ceiling", shape=shape, material=WHITE))
    beam = scenes.Beam(
        position=(0.0, 1.0, 0.0),
        direction=(0.0, -1.0, 0.0),
        profile=scenes.RoundProfile(radius=0.3),
        divergence_deg=divergence_deg,
        flux=FLUX,
        spectrum="E",
    )
    return scenes.Scene(objects=tuple(objects), emitters=(beam,))


def test_fluxes_and_histories_of_a_plate_are_those_of_its_series(trace_passes, assert_mean):
    # At normal incidence R = ((η−1)/(η+1))². Behind the plate arrive T², T²R², T²R⁴ … after 0, 2,
    # 4 reflections, before it R, and T²R, T²R³ … after 1, 3 … (Hecht 2017, §9.6, summed
    # incoherently).
    eta = 2.0
    r = ((eta - 1.0) / (eta + 1.0)) ** 2
    t = 1.0 - r
    passes = trace_passes(make_plate_scene(make_glass(eta)), photons=4000, passes=16)

    def split(photons):
        table = np.zeros((2, 6))
        kind = np.minimum(photons["reflections"], 5)
        np.add.at(table, (photons["object"] // 2, kind), photons["flux"])
        return table

    expected = np.zeros((2, 6))
    expected[0, 0:5:2] = t * t * r ** np.arange(0, 5, 2)
    expected[1, 1] = r + t * t * r
    expected[1, 3] = t * t * r**3
    expected[1, 5] = t * t * r**5 / (1.0 - r * r)
    expected[0, 5] = t * t * r**6 / (1.0 - r * r)
    assert_mean(passes.sums(split), passes.flux * expected)
    for photons in passes.photons:
        reflections, behind = photons["reflections"], photons["object"] == 0
        assert np.all(reflections[behind] % 2 == 0)
        assert np.all(reflections[~behind] % 2 == 1)
        assert np.all(photons["refractions"][behind] == 2)
        # Reflected off the top, or inside: in, out, and once less inside than there are turns.
        first = ~behind & (photons["refractions"] == 0)
        assert np.all(reflections[first] == 1)
        np.testing.assert_allclose(photons["flux"][first].sum(), passes.flux * r, rtol=1e-12)
        assert np.all(photons["refractions"][~behind & ~first] == 2)
        assert np.all(photons["bounces"] == 0)
        # The floor is met from above, its front; the ceiling, turned up too, from below.
        assert np.all(photons["side"] == np.where(behind, 0, 1))
        assert np.all(photons["face"] == 0)
        assert np.all(photons["emitter"] == 0)
        np.testing.assert_array_equal(photons["position"][:, 1], np.where(behind, 0.0, 2.0))
        np.testing.assert_array_equal(photons["direction"][:, 1], np.where(behind, -1.0, 1.0))


def test_dispersion_is_remembered_where_it_was_met(trace_passes):
    # Half of the beam, x < 0, misses a plate that is moved aside.
    scene = make_plate_scene(scenes.Dielectric(medium="N-BK7"))
    plate = scene.objects[1]
    aside = plate.shape.model_copy(update={"position": (1.5, 0.5, 0.0)})
    moved = scene.model_copy(
        update={
            "objects": (
                scene.objects[0], plate.model_copy(update={"shape": aside}), scene.objects[2]
            )
        }
    )
    photons = trace_passes(moved, photons=2000).photons[0]
    met = photons["position"][:, 0] > 0.0
    assert 900 < (~met).sum() < 1100
    np.testing.assert_array_equal(photons["refractions"] + photons["reflections"] > 0, met)
    np.testing.assert_array_equal(photons["dispersed"], met)
    plain = trace_passes(make_plate_scene(make_glass(1.5)), photons=2000).photons[0]
    assert np.all(plain["refractions"][plain["object"] == 0] == 2)
    assert not plain["dispersed"].any()


def test_ambient_air_disperses_what_it_is_not_converted_for(trace_passes):
    # Under water a box without dispersion is a boundary with it.
    scene = make_plate_scene(make_glass(1.5)).model_copy(update={"ambient": "water"})
    photons = trace_passes(scene, photons=500).photons[0]
    assert photons["dispersed"].all()


def test_the_solids_inside_is_a_side_of_its_own(trace_passes):
    # A lamp inside a white box lights it from within, one outside from without.
    box = scenes.SceneObject(
        shape=scenes.Box(position=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0)), material=WHITE
    )
    floor = scenes.SceneObject(
        shape=scenes.Rectangle(position=(0.0, -9.0, 0.0), size=(1.0, 1.0)), material=WHITE
    )
    for height, side in ((0.0, 1), (2.0, 0)):
        lamp = scenes.Point(position=(0.0, height, 0.0), flux=FLUX, spectrum="E")
        scene = scenes.Scene(objects=(box, floor), emitters=(lamp,))
        photons = trace_passes(scene, photons=1000).photons[0]
        on_box = photons["object"] == 0
        assert on_box.sum() > 100
        assert np.all(photons["side"][on_box] == side)
        if height:
            # Only the upper face (+y) is lit from straight above.
            assert len(set(photons["face"][on_box])) == 1


def assert_same_photons(left, right):
    assert left.keys() == right.keys()
    for name, values in left.items():
        np.testing.assert_array_equal(values, right[name], err_msg=name)


@pytest.fixture(scope="module")
def crowded():
    """A plate that sends every photon to both floor and ceiling, several times over."""
    return make_plate_scene(make_glass(2.4), divergence_deg=30.0)


def test_photons_beyond_the_first_guess_of_room_are_kept(trace_passes, crowded, monkeypatch):
    roomy = trace_passes(crowded, photons=20_000, passes=2)
    assert len(roomy.photons[0]["flux"]) > 1.5 * 20_000
    monkeypatch.setattr(tracing, "_SLOTS_PER_PHOTON", 1)
    tight = trace_passes(crowded, photons=20_000, passes=2)
    for one, other in zip(roomy.photons, tight.photons, strict=True):
        assert_same_photons(one, other)
    assert roomy.books == tight.books


def test_photons_are_the_same_for_any_number_of_threads(trace_passes, crowded):
    # 30,000 photons are several ranges, unevenly cut.
    alone, two, four = (
        trace_passes(crowded, photons=30_000, threads=threads) for threads in (1, 2, 4)
    )
    assert_same_photons(alone.photons[0], two.photons[0])
    assert_same_photons(alone.photons[0], four.photons[0])
    assert alone.books == two.books == four.books


def test_a_pass_is_the_same_whatever_ran_before(trace_passes, crowded):
    series = trace_passes(crowded, photons=3000, passes=3)
    alone = trace_passes(crowded, photons=3000, first_pass=2)
    assert_same_photons(series.photons[2], alone.photons[0])
    assert series.books[2] == alone.books[0]
    # And others are others.
    assert not np.array_equal(series.photons[0]["position"], series.photons[1]["position"])
    reseeded = trace_passes(crowded, photons=3000, seed=1)
    assert not np.array_equal(series.photons[0]["position"], reseeded.photons[0]["position"])


def test_paths_end_at_the_limit_of_interactions(trace_passes):
    # Three surfaces are the plate's two and the floor; two do not reach it.
    scene = make_plate_scene(make_glass(1.5))
    assert len(trace_passes(scene, photons=500, max_interactions=2).photons[0]["flux"]) == 0
    short = trace_passes(scene, photons=500, max_interactions=3)
    assert np.all(short.photons[0]["object"] == 0)
    assert len(short.photons[0]["flux"]) == 500
    for limit in (1, 2, 3, 4, 7):
        books = trace_passes(scene, photons=500, max_interactions=limit).books[0]
        assert abs(books.residual) < 1e-12
    assert short.books[0].culled > 0.0
