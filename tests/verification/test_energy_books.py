"""Every emitted watt is deposited, absorbed, escaped or culled."""

import numpy as np
import pytest

import scenes

ETA = 2.0
"""Index of the glass that traps light."""

TOLERANCE = {"float64": 1e-12, "float32": 2e-6}
"""Rounding: the books of N = 20,000 photons are summed in float64, at worst N ε/2 = 2e-12, in truth
√N; each photon's own are summed in its precision, over some ten terms of ε/2 = 6e-8."""


def make_trap():
    """A lamp in the middle of a block of glass in a room: a white floor, the rest black."""
    block = scenes.SceneObject(
        name="block",
        shape=scenes.Box(position=(0.0, 0.0, 0.0), size=(1.0, 1.2, 0.9)),
        material=scenes.Dielectric(
            medium=scenes.SellmeierMedium(
                b=(ETA**2 - 1.0,), c_um2=(0.0,), range_nm=(300.0, 900.0)
            )
        ),
    )
    floor = scenes.SceneObject(
        name="floor",
        shape=scenes.Rectangle(position=(0.0, -2.0, 0.0), size=(8.0, 8.0)),
        material=scenes.Lambertian(reflectance=0.5),
    )
    room = scenes.SceneObject(
        name="room",
        shape=scenes.Box(position=(0.0, 0.0, 0.0), size=(8.0, 8.0, 8.0)),
        material=scenes.Absorber(),
    )
    lamp = scenes.Point(position=(0.0, 0.0, 0.0), flux=7.0, spectrum="E")
    return scenes.Scene(objects=(block, floor, room), emitters=(lamp,))


def make_absorbing():
    """The gallery's prism on an absorbing table, in front of an absorbing screen."""
    scene = scenes.load("prism")
    black = [
        one if isinstance(one.material, scenes.Dielectric) or one.name == "screen"
        else one.model_copy(update={"material": scenes.Absorber()})
        for one in scene.objects
    ]
    return scene.model_copy(update={"objects": tuple(black)})


SCENES = {
    "prism": lambda: scenes.load("prism"),
    "ball": lambda: scenes.load("ball"),
    "lens": lambda: scenes.load("lens"),
    "absorbing": make_absorbing,
    "trap": make_trap,
}


def _assert_bands_close(books, tolerance):
    """In each band, too, and the bands add up to the whole."""
    for band in books.bands:
        assert abs(band.residual) < tolerance
        assert band.emitted > 0.0
        assert min(band.deposited, band.absorbed, band.escaped) >= 0.0
    sums = np.sum(books.by_band, axis=0)
    np.testing.assert_allclose(sums, books.totals, rtol=0, atol=tolerance * books.emitted)


@pytest.mark.parametrize(
    ("name", "precision"),
    [(name, "float64") for name in SCENES] + [(n, "float32") for n in ("prism", "trap")],
)
def test_the_books_close(trace_passes, name, precision):
    count = 2000 if name == "trap" else 20_000
    passes = trace_passes(SCENES[name](), photons=count, passes=2, precision=precision)
    tolerance = TOLERANCE[precision]
    for books, photons in zip(passes.books, passes.photons, strict=True):
        # Emitted = deposited + absorbed + escaped + culled.
        assert abs(books.residual) < tolerance
        _assert_bands_close(books, tolerance)
        # What was deposited is what was stored.
        assert photons["flux"].sum() == pytest.approx(books.deposited, rel=tolerance)
        assert books.deposited > 0.0
        assert books.absorbed >= 0.0
        assert books.escaped >= 0.0
    assert (passes.books[0].absorbed > 0.0) == (name in {"absorbing", "trap"})
    assert (passes.books[0].escaped > 0.0) == (name != "trap")


@pytest.mark.parametrize("name", ["prism", "ball", "lens"])
def test_what_is_emitted_is_what_the_lamps_give(trace_passes, assert_mean, name):
    scene = SCENES[name]()
    passes = trace_passes(scene, photons=10_000, passes=16)
    edges_nm = scene.film.edges_nm
    expected = sum(
        lamp.flux * lamp.emission().band_flux(edges_nm).sum() / lamp.emission().total
        for lamp in scene.emitters
    )
    assert passes.flux == pytest.approx(expected, rel=1e-12)
    emitted = [books.emitted for books in passes.books]
    assert_mean(emitted, expected)
    assert np.std(emitted) < 0.02 * expected


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_what_total_reflection_traps_is_culled(trace_passes, assert_mean, precision):
    # Reflections in a block change the signs of a direction's cosines, never their size: light
    # leaves if one of them exceeds cos θc = √(1 − 1/η²), and else never. With η = 2 the six cones
    # of escape, 30° wide, are apart, so that the fraction 1 − 3 (1 − cos θc) stays for ever.
    passes = trace_passes(make_trap(), photons=4000, passes=16, precision=precision)
    trapped = 1.0 - 3.0 * (1.0 - np.sqrt(1.0 - 1.0 / ETA**2))
    # Next to the critical angle light leaves slowly too: R ≈ 1 − 4 η cosθₜ/cosθᵢ, so that after
    # some 256/6 meetings with each pair of faces a sliver of cosθₜ < 0.01 is left, which is
    # cosθₜ²/(2 η² cosθᵢ) = 1.5e-5 of all directions for each of 6 cones.
    culled = [books.culled for books in passes.books]
    assert_mean(culled, trapped * passes.flux, slack=1e-4 * passes.flux)
    assert np.std(culled) < 0.02 * passes.flux
    # All the rest arrives in the room, once.
    left = [books.absorbed + books.deposited for books in passes.books]
    assert_mean(left, (1.0 - trapped) * passes.flux, slack=1e-4 * passes.flux)
