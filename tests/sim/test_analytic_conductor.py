"""The reflectance of metals: against complex amplitudes, limits, and published reflectances."""

import numpy as np
import pytest

from sim.analytic import fresnel_reflectance
from sim.analytic_conductor import conductor_reflectance
from spectra import conductor, conductors

EPS = np.finfo(np.float64).eps

COS = np.linspace(0.0, 1.0, 101)

# Reflectance [%] of freshly evaporated, opaque films at normal incidence and 400, 450 … 800 nm:
# Hass, G. and Hadley, L. (1972), "Optical properties of metals", in American Institute of Physics
# Handbook, 3rd edition, §6g.
HASS_NM = np.arange(400.0, 801.0, 50.0)
HASS = {
    "aluminium": (92.4, 92.2, 91.8, 91.5, 91.1, 90.5, 89.7, 88.0, 86.7),
    "silver": (95.6, 97.1, 97.9, 98.3, 98.6, 98.8, 98.9, 99.1, 99.2),
    "gold": (38.7, 38.7, 47.7, 81.7, 91.9, 95.5, 97.0, 97.4, 98.0),
    "copper": (47.5, 55.2, 60.0, 66.9, 93.3, 96.6, 97.5, 97.9, 98.1),
}
# Two laboratories' films, in percentage points: what the tables' own uncertainties make of R
# (Johnson and Christy, §III: ±0.02 of n and k, or dR = 1.2 for silver and gold), and shift of the
# absorption edge by a few nm where dR/dλ is 0.3 to 0.7 a nm (gold around 550 nm; copper from 550
# to 600 nm, where Johnson and Christy's is 15 nm redder).
POINTS = {"aluminium": 0.6, "silver": 1.2, "gold": 2.6, "copper": 11.5}


def complex_reflectance(cos_i, index):
    # Born & Wolf 1999, §1.5.2, eq. 21 with a complex index N, g = √(N² - sin²):
    # r_s = (c - g)/(c + g), r_p = (N² c - g)/(N² c + g).
    g = np.sqrt(index**2 - (1.0 - cos_i**2) + 0j)
    r_s = (cos_i - g) / (cos_i + g)
    r_p = (index**2 * cos_i - g) / (index**2 * cos_i + g)
    return np.abs(r_s) ** 2, np.abs(r_p) ** 2


@pytest.mark.parametrize("eta_i", [1.0, 1.5])
@pytest.mark.parametrize("name", conductors())
def test_it_is_what_complex_amplitudes_give(name, eta_i):
    metal = conductor(name)
    wavelength_nm = metal.knots_nm[:, np.newaxis]
    eta, k = metal.eta(wavelength_nm), metal.k(wavelength_nm)
    expected = complex_reflectance(COS, (eta + 1j * k) / eta_i)
    found = conductor_reflectance(COS, eta_i, eta, k)
    # The subtractions in r's numerators lose up to 1/(1 - R) <= 1/(4 a c/(a² + b² + …)) ulps, which
    # for k <= 18 and η >= 0.03 stays below 1000 but near grazing, where R is 1 less rounding.
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1000 * EPS)


def test_without_absorption_it_is_a_dielectrics_total_reflection_included():
    for eta_i, eta_t in ((1.0, 1.5), (1.5, 1.0), (1.0, 2.4)):
        expected = fresnel_reflectance(COS, eta_i, eta_t)
        found = conductor_reflectance(COS, eta_i, eta_t, 0.0)
        # Beside the critical angle a is the root of a difference: √eps of it. None of COS is there.
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=64 * EPS)


@pytest.mark.parametrize("name", conductors())
def test_normal_and_grazing_incidence(name):
    metal = conductor(name)
    eta, k = metal.eta_knots, metal.k_knots
    r_s, r_p = conductor_reflectance(1.0, 1.0, eta, k)
    # R = ((η - 1)² + k²)/((η + 1)² + k²) (Born & Wolf 1999, §14.2).
    expected = ((eta - 1.0) ** 2 + k**2) / ((eta + 1.0) ** 2 + k**2)
    np.testing.assert_allclose(r_s, expected, rtol=32 * EPS)
    np.testing.assert_array_equal(r_s, r_p)
    np.testing.assert_array_equal(conductor_reflectance(0.0, 1.0, eta, k), 1.0)


@pytest.mark.parametrize("name", conductors())
def test_p_is_reflected_less_than_s_and_least_at_a_steep_angle(name):
    metal = conductor(name)
    eta, k = metal.eta(600.0), metal.k(600.0)
    r_s, r_p = conductor_reflectance(COS, 1.0, eta, k)
    assert np.all(r_p[1:-1] < r_s[1:-1])
    # Where |N| >> 1, p is reflected least near cos θ = 1/|N|, as tan θ sin θ = |N| has it.
    least = COS[np.argmin(r_p)]
    assert 0.5 / abs(complex(eta, k)) < least < 2.0 / abs(complex(eta, k))


@pytest.mark.parametrize("name", HASS)
def test_published_reflectances(name):
    metal = conductor(name)
    found = 100.0 * conductor_reflectance(1.0, 1.0, metal.eta(HASS_NM), metal.k(HASS_NM))[0]
    np.testing.assert_allclose(found, HASS[name], atol=POINTS[name])


def test_the_metals_colours_are_told_apart():
    # Gold and copper have their edges in the visible, silver and aluminium have none: between 450
    # and 650 nm R rises by more than half, or varies by less than a tenth.
    for name in conductors():
        metal = conductor(name)
        ends = np.array([450.0, 650.0])
        blue, red = conductor_reflectance(1.0, 1.0, metal.eta(ends), metal.k(ends))[0]
        if name in ("gold", "copper"):
            assert red > 1.5 * blue
        else:
            assert red == pytest.approx(blue, rel=0.1)
