"""Media at the ends of their ranges, and absorption from nothing to everything."""

import math

import mpmath
import numpy as np
import pytest

import scenes
from sim.errors import SettingsError
from spectra import WavelengthOutOfRange, glass, glasses

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
    low, high = glass(name).wavelength_range_nm
    ends = np.array([low, math.nextafter(low, math.inf), math.nextafter(high, 0.0), high])
    for precision in ("float64", "float32"):
        paths = follow([plate(name)], -WAY, WAY, ends, precision=precision)
        for wavelength_nm, path in zip(ends, paths, strict=True):
            eta = float(glass(name).eta(float(wavelength_nm)))
            # sinθ_t = sinθ/η; what float32 makes of the wavelength, ε of it, moves η by
            # λ |dη/dλ| ε, and its formula's poles are nearer at the ends than anywhere.
            inside = path.directions[1]
            slack = 16 * eps[precision] + 8.0 * eps[precision] * steepness(name, wavelength_nm)
            assert inside[0] == pytest.approx(SINE / eta, rel=0, abs=slack)
    for wavelength_nm in (math.nextafter(low, 0.0), math.nextafter(high, math.inf)):
        with pytest.raises(WavelengthOutOfRange):
            follow([plate(name)], -WAY, WAY, wavelength_nm)


def steepness(name, wavelength_nm):
    """λ |dη/dλ| toward the inside of the range."""
    medium = glass(name)
    low, high = medium.wavelength_range_nm
    other = min(max(wavelength_nm * (1.0 + 1e-4), low), high)
    if other == wavelength_nm:
        other = wavelength_nm * (1.0 - 1e-4)
    rise = float(medium.eta(other)) - float(medium.eta(float(wavelength_nm)))
    return abs(rise / (other / wavelength_nm - 1.0))


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
