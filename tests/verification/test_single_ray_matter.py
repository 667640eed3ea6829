"""Single rays in media that absorb, at mirrors and at metals: against closed forms."""

import math

import numpy as np
import pytest

import scenes
from sim import analytic, trace_ray
from sim.analytic_conductor import conductor_reflectance
from sim.device import start_device
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays
from spectra import WavelengthOutOfRange, conductor, conductors, glass, published_absorption

EPS = float(np.finfo(np.float64).eps)

THICKNESS_M = 0.010
AT_NM = np.array([395.0, 405.0, 436.0, 500.0, 589.3, 650.0, 700.0])


def scene_of(shape, material):
    return scenes.Scene(objects=[scenes.SceneObject(name="it", shape=shape, material=material)])


def slab(material):
    """10 mm thick, between y = −5 mm and 5 mm; wide enough for every angle here."""
    return scene_of(scenes.Box(position=(0.0, 0.0, 0.0), size=(4.0, THICKNESS_M, 4.0)), material)


def disk(material):
    shape = scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=100.0)
    return scene_of(shape, material)


def onto(scene, thetas, wavelengths_nm, **options):
    """A path for each angle of incidence, from above to the origin's vertical."""
    compiled = compile_scene(scene, device=start_device("cpu"))
    ways = np.stack([np.sin(thetas), -np.cos(thetas), np.zeros(len(thetas))], axis=-1)
    starts = np.array([0.0, 0.5 * THICKNESS_M, 0.0]) - 0.01 * ways
    return trace_compiled_rays(compiled, starts, ways, np.asarray(wavelengths_nm), **options)


@pytest.mark.parametrize("theta_deg", [0.0, 60.0])
def test_flint_absorbs_what_its_catalogue_says_along_the_slanted_way(theta_deg):
    theta = math.radians(theta_deg)
    scene = slab(scenes.Dielectric(medium="SF11", absorption="published"))
    paths = onto(scene, np.full(len(AT_NM), theta), AT_NM)
    inside = analytic.snell_angle(theta, 1.0, glass("SF11").eta(AT_NM)).theta_t
    length_m = THICKNESS_M / np.cos(inside)
    # Beer and Lambert: 1 - exp(-α d / cos θₜ).
    expected = -np.expm1(-published_absorption("SF11").coefficient(AT_NM) * length_m)
    found = np.array([path.absorptances for path in paths])
    # α to some ulps; the way inside differs by that of positions, 1e-2 of which is 4 ulps of 4 m.
    np.testing.assert_allclose(found[:, 1], expected, rtol=1e-11)
    np.testing.assert_array_equal(found[:, [0, 2]], 0.0)


@pytest.mark.parametrize(
    "absorption",
    [
        scenes.NapierianAbsorption(coefficient=math.log(2.0) / THICKNESS_M),
        scenes.DecadicAbsorption(coefficient=math.log10(2.0) / THICKNESS_M),
        scenes.InternalTransmittance(thickness=2.0 * THICKNESS_M, transmittance=0.25),
        scenes.ExtinctionAbsorption(k=math.log(2.0) / THICKNESS_M * 550e-9 / (4.0 * math.pi)),
    ],
    ids=lambda absorption: absorption.type,
)
def test_every_way_to_say_it_leaves_one_half(absorption):
    path = onto(slab(scenes.Dielectric(medium="N-BK7", absorption=absorption)), [0.0], [550.0])[0]
    # The straight lines between a constant k's knots leave 4e-6 of α, α d 2^-α d = 0.35 of that.
    abs_tolerance = 1.4e-6 if absorption.type == "extinction" else 1e-14
    assert path.absorptances[1] == pytest.approx(0.5, abs=abs_tolerance)


@pytest.mark.parametrize("optical_depth", [0.0, 0.2, 1.0])
def test_a_slab_with_all_internal_reflections(optical_depth):
    """The paths that leave above and below, order by order, sum to the geometric series."""
    absorption = scenes.NapierianAbsorption(coefficient=optical_depth / THICKNESS_M)
    medium = scenes.ConstantMedium(eta=1.5, absorption=absorption)
    scene = slab(scenes.Dielectric(medium=medium))
    orders = 20

    def share(branches):
        return onto(scene, [0.0], [550.0], branches=branches)[0].transmittance

    below = sum(share(["refract"] + ["reflect"] * (2 * k)) for k in range(orders))
    above = share(["reflect"])
    above += sum(share(["refract"] + ["reflect"] * (2 * k + 1)) for k in range(orders))
    expected = analytic.slab_split(0.0, 1.5, optical_depth=optical_depth)
    # What is left out is 0.04^40; each path's product has some 40 roundings.
    assert below == pytest.approx(float(expected.transmitted), rel=100 * EPS)
    assert above == pytest.approx(float(expected.reflected), rel=100 * EPS)
    assert 1.0 - below - above == pytest.approx(float(expected.absorbed), abs=100 * EPS)


def test_the_published_split_of_a_slab_of_optical_depth_one():
    # n = 1.5, α d = 1 at normal incidence: T = 0.339111123, R = 0.044990080, A = 0.615898797.
    found = analytic.slab_split(0.0, 1.5, optical_depth=1.0)
    assert [round(float(one), 9) for one in found] == [0.044990080, 0.339111123, 0.615898797]


@pytest.mark.parametrize("name", conductors())
def test_metals_reflect_what_fresnel_says_of_their_complex_index(name):
    thetas = np.radians([0.0, 30.0, 60.0, 80.0, 89.0])
    thetas, wavelengths = (grid.ravel() for grid in np.meshgrid(thetas, AT_NM))
    paths = onto(disk(scenes.Metal(metal=name)), thetas, wavelengths)
    metal = conductor(name)
    eta, k = metal.eta(wavelengths), metal.k(wavelengths)
    reflectances = conductor_reflectance(np.cos(thetas), 1.0, eta, k)
    found = np.array([1.0 - path.absorptances[0] for path in paths])
    # The device has a by a difference that loses k²/η² ulps, 1e4 for silver.
    np.testing.assert_allclose(found, 0.5 * sum(reflectances), rtol=0.0, atol=2e4 * EPS)
    assert {path.events for path in paths} == {("mirror", "escape")}
    mirrored = np.stack([np.sin(thetas), np.cos(thetas), np.zeros(len(thetas))], axis=-1)
    np.testing.assert_allclose(
        [path.directions[1] for path in paths], mirrored, atol=8 * EPS
    )


def test_a_metal_under_glass_has_the_glasss_index_in_front():
    # A metal seen from inside a medium reflects by (η + ik)/n: less, for gold in the blue.
    ambient = scenes.ConstantMedium(eta=1.5)
    scene = disk(scenes.Metal(metal="gold")).model_copy(update={"ambient": ambient})
    path = onto(scene, [0.6], [450.0])[0]
    metal = conductor("gold")
    expected = conductor_reflectance(math.cos(0.6), 1.5, metal.eta(450.0), metal.k(450.0))
    assert 1.0 - path.absorptances[0] == pytest.approx(0.5 * sum(expected), abs=1e-13)


@pytest.mark.parametrize(
    ("scene", "wavelength_nm", "message"),
    [
        (
            slab(scenes.Dielectric(medium="F2", absorption="published")),
            330.0,
            "F2 has no absorption coefficient at 330 nm; allowed: 334 to 2500 nm",
        ),
        (disk(scenes.Metal(metal="aluminium")), 200.0, "aluminium has no refractive index at 200"),
    ],
)
def test_wavelengths_at_which_matter_is_not_known(scene, wavelength_nm, message):
    with pytest.raises(WavelengthOutOfRange, match=message):
        trace_ray(scene, (0.0, 0.1, 0.0), (0.0, -1.0, 0.0), wavelength_nm)


def test_an_ideal_mirror_loses_nothing_and_another_the_same_at_any_angle():
    thetas = np.radians([0.0, 45.0, 85.0])
    for mirror, lost in ((scenes.Mirror(), 0.0), (scenes.Mirror(reflectance=0.7), 0.3)):
        paths = onto(disk(mirror), thetas, np.full(3, 550.0))
        found = [path.absorptances[0] for path in paths]
        np.testing.assert_allclose(found, lost, rtol=2 * EPS, atol=0.0)


def test_a_coloured_mirror_is_linear_between_its_entries():
    table = scenes.ReflectanceTable(wavelength_nm=(450.0, 650.0), values=(0.2, 1.0))
    wavelengths = np.array([400.0, 450.0, 500.0, 600.0, 650.0, 700.0])
    paths = onto(disk(scenes.Mirror(reflectance=table)), np.zeros(6), wavelengths)
    found = [1.0 - path.absorptances[0] for path in paths]
    np.testing.assert_allclose(found, [0.2, 0.2, 0.4, 0.8, 1.0, 1.0], atol=4 * EPS)


def test_a_bubble_is_left_as_if_nothing_were_in_it():
    # A ball of air in glass, a lens that spreads light: a ray through its middle goes straight on.
    block = scenes.SceneObject(
        name="block",
        shape=scenes.Box(position=(0.0, 0.0, 0.0), size=(0.1, 0.1, 0.1)),
        material=scenes.Dielectric(medium="N-BK7"),
    )
    bubble = scenes.SceneObject(
        name="bubble",
        shape=scenes.Sphere(position=(0.0, 0.0, 0.0), radius=0.01),
        material=scenes.Dielectric(medium="air", priority=1),
    )
    scene = scenes.Scene(objects=[block, bubble])
    path = trace_ray(scene, (0.0, 0.2, 0.0), (0.0, -1.0, 0.0), 550.0)
    assert path.events == ("refract",) * 4 + ("escape",)
    assert path.objects == ("block", "bubble", "bubble", "block", "")
    eta = glass("N-BK7").eta(550.0)
    # ((n - 1)/(n + 1))² at each of the four.
    np.testing.assert_allclose(
        path.reflectances[:4], ((eta - 1.0) / (eta + 1.0)) ** 2, rtol=64 * EPS
    )
