"""Pictures at their extremes: flux, radius, place of the camera, number and place of photons."""

import math

import numpy as np
import pytest

import scenes
import sim
from sim.settings import RenderSettings

FLOOR = scenes.SceneObject(
    name="floor",
    shape=scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=3.0),
    material=scenes.Lambertian(reflectance=0.8),
)
ETA = 1.5
BALL_AT, BALL_RADIUS = np.array([0.1, 0.7, -0.2]), 0.5
LAMP_AT = np.array([0.5, 2.5, 0.3])


def look(position, at, up=(0.0, 1.0, 0.0), fov_deg=40.0):
    as_tuple = [tuple(np.asarray(one, dtype=float).tolist()) for one in (position, at, up)]
    return scenes.Camera(
        position=as_tuple[0], look_at=as_tuple[1], up=as_tuple[2], fov_deg=fov_deg
    )


def bench(place=lambda x: x, turn=lambda x: x, scale=1.0, lamps=(1.0,), camera=None, floor=None):
    """A ball over a disk, lit by point lamps in one place; placed, turned and scaled as a whole."""

    def at(point):
        return tuple(np.asarray(place(scale * np.asarray(point, dtype=float))).tolist())

    def along(way):
        return tuple(np.asarray(turn(np.asarray(way, dtype=float))).tolist())

    floor = floor or FLOOR.model_copy(
        update={"shape": scenes.Disk(position=at((0, 0, 0)), normal=along((0, 1, 0)),
                                     radius=3.0 * scale)}
    )  # fmt: skip
    ball = scenes.SceneObject(
        name="ball",
        shape=scenes.Sphere(position=at(BALL_AT), radius=BALL_RADIUS * scale),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA)),
    )
    emitters = [
        scenes.Point(name=f"lamp {k}", position=at(LAMP_AT), flux=flux, spectrum="E")
        for k, flux in enumerate(lamps)
    ]
    if camera is None:
        camera = scenes.Camera(
            position=at((0.3, 4.0, 3.0)), look_at=at((0.1, 0.1, 0.0)), up=along((0, 1, 0)),
            fov_deg=22.0,
        )  # fmt: skip
    film = scenes.Film(width=12, height=8, bands=2, first_nm=450, last_nm=650)
    return scenes.Scene(objects=(floor, ball), emitters=emitters, camera=camera, film=film)


def render(scene, **settings):
    chosen = {"photons": 2000, "passes": 2, "seed": 1, **settings}
    return sim.render(scene, RenderSettings(**chosen))


def assert_finite(picture):
    errors = (picture.standard_error, *vars(picture.accuracy).values())
    for values in (picture.spectral_radiance, *errors):
        assert np.all(np.isfinite(values))
    assert np.all(picture.spectral_radiance >= 0.0)
    assert np.all(np.isfinite(picture.energy.totals))


@pytest.fixture(scope="module")
def usual():
    return {name: render(bench(), precision=name) for name in ("float64", "float32")}


def test_the_usual_picture_is_worth_comparing_with(usual, precision):
    assert_finite(usual[precision])
    assert usual[precision].spectral_radiance.min() > 0.0


# --- flux --------------------------------------------------------------------------------------


@pytest.mark.parametrize("flux", [1e-30, 2.0**-99, 2.0**99, 1e30])
def test_light_is_linear_over_sixty_orders_of_magnitude(usual, precision, eps, flux, tmp_path):
    picture = render(bench(lamps=(flux,)), precision=precision)
    assert_finite(picture)
    ratio = picture.spectral_radiance / flux / usual[precision].spectral_radiance
    # A power of two changes no digit, but that float32 has fewer for what is below 1e-38; else
    # every product is rounded its own way, some dozens.
    is_power = math.frexp(flux)[0] == 0.5 and precision == "float64"
    tolerance = 0.0 if is_power else 64 * eps[precision]
    np.testing.assert_allclose(ratio, 1.0, rtol=0, atol=tolerance)
    assert abs(picture.energy.residual) <= 64 * eps[precision]
    # Automatic exposure sees the same picture.
    levels = picture.srgb.astype(int) - usual[precision].srgb
    assert np.abs(levels).max() <= (0 if is_power else 1)
    path = tmp_path / "picture.exr"
    picture.save_exr(path)
    read = sim.read_exr(path)
    np.testing.assert_allclose(read.spectral_radiance, picture.spectral_radiance, rtol=1e-7)


@pytest.mark.parametrize("flux", [0.0, 1e-31, 1.1e30, 1e300, math.inf, math.nan])
def test_fluxes_beyond_are_refused(flux):
    with pytest.raises(scenes.SceneError, match=r"flux: must be"):
        scenes.Point(position=(0, 0, 0), flux=flux, spectrum="E")


def test_what_no_file_and_no_float32_can_hold_is_said(tmp_path):
    # 1e30 W on a hundredth of a micrometre: radiances of 1e40, where float32 ends at 3.4e38.
    scene = bench(scale=1e-8, lamps=(1e30,))
    with pytest.raises(sim.SettingsError, match="beyond the numbers of float32"):
        render(scene, precision="float32")
    picture = render(scene)
    assert_finite(picture)
    with pytest.raises(sim.CapacityError, match="does not fit into an EXR file"):
        picture.save_exr(tmp_path / "picture.exr")
    assert list(tmp_path.iterdir()) == []


# --- lamps -------------------------------------------------------------------------------------


@pytest.mark.parametrize("radius", [1e-9, 1e-6, 1e-3])
def test_the_smallest_ball_of_light_is_a_point(precision, eps, radius):
    # The same light from points R away from the middle. No pixel sees the lamp, as the camera looks
    # down from above it.
    at = tuple(LAMP_AT.tolist())
    lamp = scenes.SphereLamp(position=at, radius=radius, flux=1.0, spectrum="E")
    scene = bench().model_copy(update={"emitters": (lamp,)})
    picture = render(scene, precision=precision, photons=8000)
    assert_finite(picture)
    expected = render(bench(), photons=8000).spectral_radiance
    # Most pixels have direct light alone, E ∝ h/d³ from a height h: moved by R, it changes by
    # 3 R/d + R/h at most, and h = 2.5 ≤ d. Some dozens of roundings.
    off = np.abs(picture.spectral_radiance / expected - 1.0)
    rounding = 64 * eps[precision]
    assert np.median(off) <= 4.0 * radius / 2.5 + rounding
    # Of the picture's 3 m² the penumbra takes 4 m of the shadow's rim times 2 R, and of the light
    # on the ball, 0.5 m wide, a rim of R is 4 R. Of 8000 photons one may pass it otherwise.
    mean = picture.spectral_radiance.mean() / expected.mean()
    most = (1.6 + 8.0 / 3.0 + 4.0) * radius + 1.0 / 8000 + rounding
    assert mean == pytest.approx(1.0, rel=0, abs=most)


# --- size --------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [2.0**-28, 1e-8, 1e6, 2.0**27])
def test_pictures_of_any_size_are_alike(usual, precision, eps, scale):
    # Radiance goes as 1/scale². In powers of two not a digit changes.
    picture = render(bench(scale=scale), precision=precision)
    assert_finite(picture)
    ratio = picture.spectral_radiance * scale**2 / usual[precision].spectral_radiance
    if math.frexp(scale)[0] == 0.5:
        np.testing.assert_array_equal(ratio, 1.0)
    # Else a photon may fall on the other side of a kernel's edge, where it counts next to nothing,
    # or be lost to roulette: one of hundreds in a pixel. So the mean is held.
    assert np.mean(ratio) == pytest.approx(1.0, abs=64 * eps[precision] + 1e-5)


# --- gather radius -----------------------------------------------------------------------------

TINY = scenes.SceneObject(
    name="floor",
    shape=scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=0.01),
    material=scenes.Lambertian(reflectance=0.8),
)
ABOVE = look((0.0, 0.05, 0.0), (0.0, 0.0, 0.0), up=(0.0, 0.0, 1.0), fov_deg=8.0)


def test_a_disc_as_wide_as_the_scene_gathers_all_that_a_speck_gets(precision, assert_mean):
    # The speck is 1/60 of the scene's width, and evenly lit, by E = Φ cosθ/(4π d²), so that the
    # kernel's width changes nothing: L = ρ E/π, of which each band has its share. E changes by some
    # 3 r/d = 2 % from rim to rim, but its mean over the speck only by as much squared, and so does
    # the kernel of 1.2 m, by (0.01/1.2)².
    slack = 0.02**2 + (0.01 / 1.2) ** 2
    lamp = scenes.Point(position=(-0.5, 1.0, 1.5), flux=1.0, spectrum="E")
    scene = bench(floor=TINY, camera=ABOVE).model_copy(update={"emitters": (lamp,)})
    distance2 = 0.5**2 + 1.0**2 + 1.5**2
    for radius in (1.2, 0.01):
        seen = []
        for seed in range(8):
            picture = render(
                scene, precision=precision, direct_light="photons", radius=radius, photons=5000,
                seed=seed,
            )  # fmt: skip
            assert_finite(picture)
            widths = np.diff(picture.edges_nm)
            irradiance = picture.energy.emitted / (4.0 * math.pi * distance2) / distance2**0.5
            radiance = np.sum(picture.spectral_radiance * widths, axis=-1).mean()
            seen.append(radiance / (0.8 * irradiance / math.pi))
        # t₇ exceeds 6 by chance once in 2,000; σ of the mean is 0.14 % and 0.08 %.
        assert_mean(seen, 1.0, k=6.0, slack=slack)
        assert np.std(seen, ddof=1) / math.sqrt(8) < 0.002


@pytest.mark.parametrize("ulps", [1.0, 1e3])
def test_radii_of_an_ulp_give_finite_pictures(usual, precision, eps, ulps):
    # Of the scene, 6 m across: photons are hardly ever found, direct light is there all the same.
    radius = 6.5 * ulps * eps[precision]
    picture = render(bench(), precision=precision, radius=radius, photons=200)
    assert_finite(picture)
    assert picture.spectral_radiance.mean() > 0.2 * usual[precision].spectral_radiance.mean()


@pytest.mark.parametrize("radius", [5e-324, 1e-160, 1e-17, 1e3, 1e200])
def test_radii_that_nothing_could_resolve_are_refused(precision, radius):
    with pytest.raises(sim.SettingsError, match=r"radius: .* allowed: at least") as told:
        render(bench(), precision=precision, radius=radius)
    assert "the scene's size" in str(told.value)


# --- the camera --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("position", "at"),
    [
        (BALL_AT, (0.1, 0.0, -0.2001)),  # in the middle of the glass
        ((0.1, 0.7 + BALL_RADIUS, -0.2), (0.3, 0.0, 0.4)),  # on it, looking in
        ((0.1, 0.7, -0.2 + BALL_RADIUS), (0.3, 0.0, 1.5)),  # on it, looking out
        (LAMP_AT, (0.3, 0.0, 0.4)),  # where the lamp is
        ((0.3, 1e-9, 0.9), (0.1, 0.0, 0.0)),  # a nanometre above the floor
    ],
)
def test_the_camera_may_be_anywhere(precision, position, at):
    picture = render(bench(camera=look(position, at, up=(0.2, 1.0, 0.1))), precision=precision)
    assert_finite(picture)
    assert picture.spectral_radiance.max() > 0.0


def test_a_camera_on_what_it_sees_asks_for_a_radius(precision):
    scene = bench(camera=look((0.3, 0.0, 0.9), (0.1, -1.0, 0.0)))
    with pytest.raises(sim.SettingsError, match="the camera stands on all that it sees"):
        render(scene, precision=precision)
    assert_finite(render(scene, precision=precision, radius=0.05))


def test_a_camera_that_looks_at_nothing_asks_for_a_radius_and_sees_nothing(precision):
    scene = bench(camera=look((0.3, 2.0, 3.5), (0.3, 9.0, 4.5)))
    with pytest.raises(sim.SettingsError, match="the camera sees no diffuse surface"):
        render(scene, precision=precision)
    picture = render(scene, precision=precision, radius=0.05)
    assert not picture.spectral_radiance.any()
    assert_finite(picture)


# --- photons -----------------------------------------------------------------------------------


def test_no_photons_are_refused_and_one_is_enough(precision):
    with pytest.raises(sim.SettingsError, match="photons: 0 is not allowed"):
        render(bench(), photons=0)
    picture = render(bench(), photons=1, passes=1, precision=precision)
    assert np.all(np.isfinite(picture.spectral_radiance))
    assert abs(picture.energy.residual) <= 64 * np.finfo(precision).eps


def test_every_photon_in_one_place_makes_the_kernel_itself(precision, assert_mean):
    # A beam a nanometre wide. The kernel integrates to 1, so that ∫ L dA = ρ Φ/π per band's width,
    # and a camera from straight above has pixels of one area on the floor.
    beam = scenes.Beam(
        position=(0.01, 1.0, 0.02), direction=(0.0, -1.0, 0.0), flux=2.0, spectrum="E",
        profile=scenes.RoundProfile(radius=1e-9),
    )  # fmt: skip
    film = scenes.Film(width=12, height=12, bands=2, first_nm=450, last_nm=650)
    camera = look((0.0, 2.0, 0.0), (0.0, 0.0, 0.0), up=(0.0, 0.0, 1.0), fov_deg=10.0)
    scene = scenes.Scene(objects=(FLOOR,), emitters=(beam,), camera=camera, film=film)
    pixel = 2.0 * 2.0 * math.tan(math.radians(5.0)) / 12
    totals = []
    for seed in range(8):
        picture = render(
            scene, precision=precision, direct_light="photons", radius=0.1, alpha=1.0, seed=seed,
            photons=500,
        )  # fmt: skip
        widths = np.diff(picture.edges_nm)
        totals.append(np.sum(picture.spectral_radiance * widths) * pixel**2)
    assert picture.energy.deposited == pytest.approx(picture.energy.emitted, rel=1e-5)
    assert_mean(totals, 0.8 * picture.energy.emitted / math.pi, k=6.0)


# --- metamorphic -------------------------------------------------------------------------------

SEEDS = range(12)


@pytest.fixture(scope="module")
def plain():
    return np.array([render(bench(), seed=seed).spectral_radiance for seed in SEEDS])


def assert_same_pictures(assert_mean, plain, other):
    """Quarters of the picture, its bands, and the whole agree within their errors over the seeds.

    Two independent means of 12: the standard error of their difference is that of 12 differences.
    """

    def blocks(pictures):
        return pictures.reshape(len(SEEDS), 2, 4, 3, 4, 2).mean(axis=(2, 4))

    difference = (blocks(np.array(other)) - blocks(plain)) / blocks(plain).mean(axis=0)
    # Twelve blocks and bands in five tests; t₁₁ exceeds 6 by chance once in 10,000.
    assert_mean(difference, 0.0, k=6.0)
    # The whole picture is known better: σ is 0.5 to 1.1 % in the five tests.
    whole = np.array(other).mean(axis=(1, 2, 3)) / plain.mean()
    whole -= plain.mean(axis=(1, 2, 3)) / plain.mean()
    assert_mean(whole, 0.0, k=6.0)
    # And these are sharp comparisons.
    assert whole.std(ddof=1) / math.sqrt(len(SEEDS)) < 0.012
    assert difference.std(axis=0, ddof=1).max() / math.sqrt(len(SEEDS)) < 0.05


@pytest.mark.parametrize("axis", [0, 2])
def test_a_mirrored_scene_is_the_mirrored_picture(plain, assert_mean, axis):
    def mirror(x):
        return x * np.where(np.arange(3) == axis, -1.0, 1.0)

    scene = bench(mirror, mirror)
    other = [render(scene, seed=100 + seed).spectral_radiance[:, ::-1] for seed in SEEDS]
    assert_same_pictures(assert_mean, plain, other)


def test_a_turned_scene_is_the_same_picture(plain, assert_mean):
    q, _ = np.linalg.qr(np.random.default_rng(51).normal(size=(3, 3)))
    q *= np.linalg.det(q)
    scene = bench(lambda x: q @ x, lambda x: q @ x)
    other = [render(scene, seed=200 + seed).spectral_radiance for seed in SEEDS]
    assert_same_pictures(assert_mean, plain, other)


def test_a_scene_far_from_the_origin_is_the_same_picture(plain, assert_mean):
    # A million sizes away: coordinates are known to ε · 1e6 = 2e-10.
    shift = np.array([3e6, -4e6, 2e6])
    scene = bench(lambda x: x + shift)
    other = [render(scene, seed=300 + seed).spectral_radiance for seed in SEEDS]
    assert_same_pictures(assert_mean, plain, other)


def test_a_lamp_in_two_halves_is_the_lamp(plain, assert_mean):
    scene = bench(lamps=(0.3, 0.7))
    other = [render(scene, seed=400 + seed).spectral_radiance for seed in SEEDS]
    assert_same_pictures(assert_mean, plain, other)
