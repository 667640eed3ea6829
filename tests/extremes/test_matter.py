"""Media at the ends of their ranges, and absorption from nothing to everything."""

import math

import mpmath
import numpy as np
import pytest

import scenes
from sim.analytic_conductor import conductor_reflectance
from sim.errors import SettingsError
from spectra import (
    WavelengthOutOfRange,
    absorbing_media,
    conductor,
    conductors,
    glass,
    glasses,
    published_absorption,
)

mpmath.mp.dps = 40

def plate(medium, thickness=0.5, absorption=None):
    return scenes.SceneObject(
        name="plate",
        shape=scenes.Box(position=(0.0, 0.0, 0.0), size=(1.0, thickness, 1.0)),
        material=scenes.Dielectric(medium=medium, absorption=absorption),
    )


SINE = 0.5
WAY = np.array([SINE, -math.sqrt(1.0 - SINE**2), 0.0])


@pytest.mark.parametrize("name", sorted(glasses()))
def test_every_medium_to_the_ends_of_its_range_and_no_further(follow, eps, name):
    ends, beyond = ends_of(*glass(name).wavelength_range_nm)
    for precision in ("float64", "float32"):
        paths = follow([plate(name)], -WAY, WAY, ends, precision=precision)
        for wavelength_nm, path in zip(ends, paths, strict=True):
            eta = float(glass(name).eta(float(wavelength_nm)))
            # sinθ_t = sinθ/η; what float32 makes of the wavelength, ε of it, moves η by
            # λ |dη/dλ| ε, and its formula's poles are nearer at the ends than anywhere.
            inside = path.directions[1]
            slack = 16 * eps[precision] + 8.0 * eps[precision] * steepness(name, wavelength_nm)
            assert inside[0] == pytest.approx(SINE / eta, rel=0, abs=slack)
    for wavelength_nm in beyond:
        with pytest.raises(WavelengthOutOfRange):
            follow([plate(name)], -WAY, WAY, wavelength_nm)


def steepness(name, wavelength_nm):
    """λ |dη/dλ| toward the inside of the range."""
    return slope(glass(name).eta, glass(name).wavelength_range_nm, wavelength_nm)


def slope(of, range_nm, wavelength_nm):
    """λ |df/dλ| of a function of the wavelength [nm], toward the inside of its range."""
    low, high = range_nm
    other = min(max(wavelength_nm * (1.0 + 1e-4), low), high)
    if other <= wavelength_nm * (1.0 + 1e-8):
        other = wavelength_nm * (1.0 - 1e-4)
    rise = float(of(other)) - float(of(float(wavelength_nm)))
    return abs(rise / (other / wavelength_nm - 1.0))


def ends_of(low, high):
    """Both ends of a range, one ulp inside them, and one ulp beyond."""
    inside = [low, math.nextafter(low, math.inf), math.nextafter(high, 0.0), high]
    return np.array(inside), (math.nextafter(low, 0.0), math.nextafter(high, math.inf))


@pytest.mark.parametrize("name", conductors())
def test_every_metal_to_the_ends_of_its_range_and_no_further(follow, eps, name):
    metal = conductor(name)
    sheet = scenes.SceneObject(
        name="sheet", material=scenes.Metal(metal=name),
        shape=scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=1.0),
    )  # fmt: skip

    def reflectance(wavelength_nm):
        # Natural light: R = (R_s + R_p)/2, Born & Wolf 1999, §14.2.
        cosine = math.sqrt(1.0 - SINE**2)
        eta, k = float(metal.eta(wavelength_nm)), float(metal.k(wavelength_nm))
        return 0.5 * sum(map(float, conductor_reflectance(cosine, 1.0, eta, k)))

    ends, beyond = ends_of(*metal.wavelength_range_nm)
    # Glass below, which no light reaches, so that there is a medium as elsewhere here.
    glass_below = scenes.SceneObject(
        shape=scenes.Sphere(position=(0.0, -2.0, 0.0), radius=0.5),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5)),
    )
    objects = [sheet, glass_below]
    for precision in ("float64", "float32"):
        paths = follow(objects, -WAY, WAY, ends, precision=precision)
        for wavelength_nm, path in zip(ends, paths, strict=True):
            assert path.events == ("mirror", "escape")
            # As above: some dozens of roundings, and the wavelength's own by R's slope.
            steep = slope(reflectance, metal.wavelength_range_nm, wavelength_nm)
            slack = (16.0 + 8.0 * steep) * eps[precision]
            assert path.transmittance == pytest.approx(
                reflectance(float(wavelength_nm)), rel=0, abs=slack
            )
    for wavelength_nm in beyond:
        with pytest.raises(WavelengthOutOfRange):
            follow(objects, -WAY, WAY, wavelength_nm)


@pytest.mark.parametrize("name", absorbing_media())
def test_every_published_absorption_to_the_ends_of_its_range_and_no_further(follow, eps, name):
    absorption, depth = published_absorption(name), 0.5
    ranges = np.array([absorption.wavelength_range_nm, glass(name).wavelength_range_nm])
    low, high = float(ranges[:, 0].max()), float(ranges[:, 1].min())
    ends, beyond = ends_of(low, high)
    objects = [plate(name, depth, "published")]
    down = ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
    for precision in ("float64", "float32"):
        for wavelength_nm, path in zip(
            ends, follow(objects, *down, ends, precision=precision), strict=True
        ):
            # A = 1 − exp(−α d), off by d δα at most; δα as above.
            alpha = float(absorption.coefficient(float(wavelength_nm)))
            steep = slope(absorption.coefficient, (low, high), wavelength_nm)
            slack = 8.0 * eps[precision] * (1.0 + depth * (alpha + steep))
            assert path.absorptances[1] == pytest.approx(
                -math.expm1(-alpha * depth), rel=0, abs=slack
            )
    for wavelength_nm in beyond:
        with pytest.raises(WavelengthOutOfRange):
            follow(objects, *down, wavelength_nm)


@pytest.mark.parametrize("wavelength_nm", [0.0, -550.0, math.nan, math.inf, 5e-324, 1e308])
def test_wavelengths_that_are_none(follow, wavelength_nm):
    with pytest.raises((WavelengthOutOfRange, SettingsError)):
        follow([plate("N-BK7")], -WAY, WAY, wavelength_nm)


DEPTHS = [0.0, 1e-300, 1e-200, 1e-100, 1e-30, 1e-16, 1e-8, 1e-3, 0.1, 1.0, 10.0, 100.0, 700.0,
          1e3, 1e6, 1e20, 1e29]  # fmt: skip


@pytest.mark.parametrize("depth", DEPTHS)
def test_depths_from_nothing_to_everything(follow, precision, eps, depth):
    # A = 1 − exp(−α d), relative to A itself, however thin the medium is; a coefficient may be up
    # to 1e30 per metre.
    medium = scenes.ConstantMedium(eta=1.5)
    absorption = scenes.NapierianAbsorption(coefficient=2.0 * depth) if depth else None
    (path,) = follow([plate(medium, 0.5, absorption)], (0, 1, 0), (0, -1, 0), precision=precision)
    assert path.events == ("refract", "refract", "escape")
    lost = path.absorptances
    assert lost[0] == lost[2] == 0.0
    expected = float(-mpmath.expm1(-mpmath.mpf(depth)))
    # Half a dozen roundings; what is below float32's numbers is nothing to it. Between the series
    # and the exponential it is ε over the depth there, 1e-3.
    relative = 8 * eps[precision] + (2 * eps[precision] / depth if 1e-3 <= depth < 0.1 else 0.0)
    smallest = float(np.finfo(precision).tiny)
    assert lost[1] == pytest.approx(expected, rel=relative, abs=smallest)
    assert 0.0 <= lost[1] <= 1.0
    assert 0.0 <= path.transmittance <= 1.0


@pytest.mark.parametrize(
    ("alpha", "lost"), [(0.0, 0.0), (1e-300, 1.0), (1e-30, 1.0), (1.0, 1.0), (1e30, 1.0)]
)
def test_an_endless_way_through_what_absorbs_anything_leaves_nothing(
    follow, precision, alpha, lost
):
    # The medium all around, and a ray that escapes: α d = ∞, and with α = 0 it is 0, not NaN.
    if precision == "float32" and alpha == 1e-300:
        lost = 0.0  # float32 knows no such number but 0
    absorption = scenes.NapierianAbsorption(coefficient=alpha)
    ball = scenes.SceneObject(
        name="ball", shape=scenes.Sphere(position=(0, 0, 0), radius=0.5),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5)),
    )  # fmt: skip
    (path,) = follow(
        [ball], (0, 2, 0), (0, 1, 0), precision=precision,
        ambient=scenes.ConstantMedium(eta=1.2, absorption=absorption),
    )  # fmt: skip
    assert path.events == ("escape",)
    assert path.absorptances[0] == lost
