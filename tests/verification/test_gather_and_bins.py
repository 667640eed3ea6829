"""A picture of a flat receiver agrees with exact binning of the very same photons."""

import numpy as np
import pytest

import scenes
import sim

PASSES = 8
PHOTONS = 40_000
BLOCKS = 8
PIXELS = 16
"""The picture is BLOCKS² blocks of PIXELS² pixels."""
SIDE = 1.0
"""Width of what the camera sees of the floor [m]."""
HEIGHT = 3.0
RHO = 0.6
FILM = scenes.Film(
    width=BLOCKS * PIXELS, height=BLOCKS * PIXELS, first_nm=425, last_nm=675, bands=6
)
CAMERA = scenes.Camera(
    position=(0.0, HEIGHT, 0.0), look_at=(0.0, 0.0, 0.0), up=(0.0, 0.0, -1.0),
    fov_deg=float(np.degrees(2.0 * np.arctan(0.5 * SIDE / HEIGHT))),
)
"""It looks straight down: pixels are equal squares of the floor, columns along x, rows along z."""

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(3.0, 3.0)),
    material=scenes.Lambertian(reflectance=RHO),
)
LAMP = scenes.Point(position=(0.7, 0.9, -0.3), flux=10.0, spectrum="A")


def make_scene(glass_x):
    """A point lamp beside the picture, and an upright pane of glass before it or far aside."""
    pane = scenes.SceneObject(
        name="pane",
        shape=scenes.Box(position=(glass_x, 0.45, -0.3), size=(0.02, 0.86, 3.0)),
        material=scenes.Dielectric(medium="N-BK7"),
    )
    return scenes.Scene(objects=(FLOOR, pane), emitters=(LAMP,), film=FILM, camera=CAMERA)


def bin_photons(photons):
    """Flux per area, wavelength and block of the floor's front, (rows, columns, bands)."""
    on = (photons["object"] == 0) & (photons["side"] == 0)
    edges = np.linspace(-0.5 * SIDE, 0.5 * SIDE, BLOCKS + 1)
    place, flux = photons["position"][on], photons["flux"][on]
    bins = np.histogramdd(
        np.column_stack([place[:, 2], place[:, 0], photons["wavelength_nm"][on]]),
        [edges, edges, FILM.edges_nm], weights=flux,
    )[0]
    return bins / (SIDE / BLOCKS) ** 2 / np.diff(FILM.edges_nm)


@pytest.fixture(scope="module", params=["straight", "through glass"])
def pair(request, trace_passes):
    """The picture's irradiance in blocks, and the bins of each pass."""
    scene = make_scene(-5.0 if request.param == "straight" else 0.57)
    settings = sim.RenderSettings(
        photons=PHOTONS, passes=PASSES, radius=0.02, alpha=1.0, direct_light="photons"
    )
    picture = sim.render(scene, settings)
    blocks = picture.spectral_radiance.reshape(BLOCKS, PIXELS, BLOCKS, PIXELS, FILM.bands)
    passes = trace_passes(scene, photons=PHOTONS, passes=PASSES, aimed=True)
    assert picture.energy.deposited == pytest.approx(
        np.mean([books.deposited for books in passes.books]), rel=1e-12
    )
    dispersed = np.mean([photons["dispersed"].mean() for photons in passes.photons])
    assert (dispersed > 0.3) == (request.param != "straight")
    # L = ρ E / π.
    return blocks.mean(axis=(1, 3)) * np.pi / RHO, passes.sums(bin_photons)


def standard_error(bins):
    """Of the mean over passes. Relative errors are pooled over the blocks, which are alike."""
    mean = bins.mean(axis=0)
    relative = bins.std(axis=0, ddof=1) / np.sqrt(PASSES) / mean
    return mean, np.sqrt(np.mean(relative**2, axis=(0, 1))) * mean


def test_blocks_agree(pair):
    # The kernel moves photons over the blocks' borders, by 20 mm of 125, and a picture samples it
    # at points: both are noise smaller than that of the bins. Its bias is r²∇²E/12: for E ∝ d⁻³ at
    # d = 1 m some 3e-4 of E.
    picture, bins = pair
    mean, error = standard_error(bins.sum(axis=3))
    off = np.abs(picture.sum(axis=2) - mean)
    assert np.all(off < 3.0 * error + 3e-4 * mean)
    assert np.all(error < 0.01 * mean)


def test_bands_of_blocks_agree(pair):
    # Undispersed photons count in all bands by the lamp's spectrum, where bins go by the wavelength
    # that each happens to carry: the same in the mean.
    picture, bins = pair
    mean, error = standard_error(bins)
    z = (picture - mean) / error
    assert np.sqrt(np.mean(z**2)) < 1.2
    assert np.mean(np.abs(z) < 3.0) > 0.99
    # And in the sum over the blocks, where errors average out.
    total = bins.sum(axis=(1, 2))
    error = total.std(axis=0, ddof=1) / np.sqrt(PASSES)
    off = np.abs(picture.sum(axis=(0, 1)) - total.mean(axis=0))
    assert np.all(off < 4.0 * error + 1e-3 * total.mean(axis=0))
    assert np.all(error < 0.01 * total.mean(axis=0))


RECEIVERS = {
    "rectangle": scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(0.8, 0.8)),
    "disk": scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=0.4),
    "box": scenes.Box(position=(0.0, -0.1, 0.0), size=(0.8, 0.2, 0.8)),
}


@pytest.mark.parametrize("kind", list(RECEIVERS))
def test_uniform_light_reads_uniform_to_the_edge(kind):
    # Without a correction it would read 1/2 at an edge and 1/4 at a corner. A beam wider than the
    # receiver has E = Φ/A = 1 W/m² over the film; the gather's radius is an eighth of the width.
    receiver = scenes.SceneObject(
        name="receiver", shape=RECEIVERS[kind], material=scenes.Lambertian(reflectance=RHO)
    )
    # What every other scene here has too, so that one kernel serves all: a pane and a rectangle.
    pane = make_scene(-5.0).objects[1]
    shelf = FLOOR.model_copy(
        update={"name": "shelf", "shape": scenes.Rectangle(position=(5, 0, 0), size=(1, 1))}
    )
    side = 0.9
    spectrum = scenes.SpectrumTable(wavelength_nm=(400.0, 700.0), values=(1.0, 1.0))
    beam = scenes.Beam(
        position=(0.0, 2.0, 0.0), direction=(0.0, -1.0, 0.0), flux=side**2, spectrum=spectrum,
        profile=scenes.SlitProfile(width=side, height=side),
    )
    objects = (receiver, pane, shelf)
    scene = scenes.Scene(objects=objects, emitters=(beam,), film=FILM, camera=CAMERA)
    settings = sim.RenderSettings(photons=PHOTONS, passes=PASSES, radius=0.1)
    picture = sim.render(scene, settings)
    irradiance = picture.spectral_radiance.sum(axis=2) * FILM.spacing_nm * np.pi / RHO
    error = picture.standard_error.sum(axis=2) * FILM.spacing_nm * np.pi / RHO
    steps = (np.arange(FILM.width) + 0.5) / FILM.width * SIDE - 0.5 * SIDE
    x, z = np.abs(np.meshgrid(steps, steps))
    out = np.hypot(x, z) if kind == "disk" else np.maximum(x, z)
    pixel = SIDE / FILM.width
    inside, outside = out < 0.4 - 0.75 * pixel, out > 0.4 + 0.75 * pixel
    np.testing.assert_array_equal(irradiance[outside], 0.0)
    # The overhang is measured in 64 directions: at a corner to 1%. With 8 replicates t is below 6
    # with 99.95%; of 2,600 pixels one or two are not.
    off = np.abs(irradiance - 1.0)
    assert np.mean((off < 6.0 * error + 0.005)[inside]) > 0.998
    assert off[inside].max() < 0.05
    assert np.median(error[inside]) < 0.01
    # Where it matters: along the edge, and in the corners.
    edge = inside & (out > 0.4 - 3.0 * pixel)
    corners = edge & (np.minimum(x, z) > 0.4 - 3.0 * pixel)
    assert irradiance[edge].mean() == pytest.approx(1.0, abs=0.004)
    if kind != "disk":
        assert corners.sum() >= 4
        assert irradiance[corners].mean() == pytest.approx(1.0, abs=0.02)
