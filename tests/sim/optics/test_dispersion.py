"""Indices on the device against `spectra`, glass by glass."""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from sim.device import start_device
from sim.optics.dispersion import (
    DISPERSION_COEFFICIENTS,
    air_index,
    cauchy_index,
    sellmeier_index,
    tabulated_index,
)
from sim.precision import precision_types
from spectra import Cauchy, Sellmeier, Tabulated, glass, glasses
from spectra import air_index as reference_air_index


@functools.cache
def make_probes(precision):
    """One module a precision, so that it is compiled once."""
    types = precision_types(precision)
    real = types.real
    options = {"module": f"tests_dispersion_{precision}", "enable_backward": False}

    @wp.kernel(**options)
    def formulas(
        coefficients: wp.array2d(dtype=real),
        row: int,
        wavelengths_um: wp.array(dtype=real),
        out_sellmeier: wp.array(dtype=real),
        out_cauchy: wp.array(dtype=real),
        out_air: wp.array(dtype=real),
    ):
        i = wp.tid()
        out_sellmeier[i] = sellmeier_index(coefficients, row, wavelengths_um[i])
        out_cauchy[i] = cauchy_index(coefficients, row, wavelengths_um[i])
        out_air[i] = air_index(wavelengths_um[i])

    @wp.kernel(**options)
    def table(
        knots_nm: wp.array(dtype=real),
        cubics: wp.array2d(dtype=real),
        first: int,
        count: int,
        wavelengths_nm: wp.array(dtype=real),
        out_index: wp.array(dtype=real),
    ):
        i = wp.tid()
        out_index[i] = tabulated_index(knots_nm, cubics, first, count, wavelengths_nm[i])

    return SimpleNamespace(formulas=formulas, table=table, types=types)


@pytest.fixture(params=["float64", "float32"])
def precision(request):
    start_device("cpu")
    return request.param


def device_array(values, types):
    return wp.array(np.asarray(values, dtype=types.dtype), dtype=types.real, device="cpu")


def formula_indices(precision, coefficients, wavelength_nm):
    """Sellmeier's, Cauchy's and air's index with one row of coefficients, as float64."""
    probes = make_probes(precision)
    # The row in question stands between two of nonsense.
    rows = np.full((3, DISPERSION_COEFFICIENTS), 7.0)
    rows[1] = 0.0
    rows[1, : len(coefficients)] = coefficients
    wavelength_um = np.asarray(wavelength_nm) * 1e-3
    inputs = [device_array(rows, probes.types), 1, device_array(wavelength_um, probes.types)]
    outs = [wp.zeros(len(wavelength_nm), dtype=probes.types.real, device="cpu") for _ in range(3)]
    wp.launch(probes.formulas, dim=len(wavelength_nm), inputs=inputs, outputs=outs, device="cpu")
    return [out.numpy().astype(np.float64) for out in outs]


def interleaved(formula):
    return np.stack([formula.b, formula.c_um2], axis=1).ravel()


def sellmeier_bound(formula, wavelength_nm, eps):
    """Rounding of n by the formula: of each term, and of its denominator, which magnifies it.

    n² = 1 + Σ t with t = Bλ²/(λ² - C); λ, B and C are rounded to ε/2 themselves, so that
    δt/t is at most some ε + ε (λ² + C)/|λ² - C|, and δn = δ(n²)/(2n).
    """
    lambda2 = (wavelength_nm * 1e-3) ** 2
    total = np.ones_like(lambda2)
    for b, c in zip(formula.b, formula.c_um2, strict=True):
        term = np.abs(b * lambda2 / (lambda2 - c))
        total += term * (2.0 + 1.5 * (lambda2 + c) / np.abs(lambda2 - c))
    n = formula.eta(wavelength_nm)
    return eps * (total / (2.0 * n) + n)


@pytest.mark.parametrize("name", glasses())
def test_every_glass_has_the_index_of_its_formula(precision, name):
    medium = glass(name)
    low, high = medium.wavelength_range_nm
    wavelength_nm = np.concatenate([np.linspace(400.0, 700.0, 301), np.geomspace(low, high, 400)])
    wavelength_nm = wavelength_nm[(wavelength_nm >= low) & (wavelength_nm <= high)]
    n, _, _ = formula_indices(precision, interleaved(medium.dispersion), wavelength_nm)
    error = np.abs(n - medium.eta(wavelength_nm))
    eps = float(np.finfo(precision).eps)
    assert np.all(error <= sellmeier_bound(medium.dispersion, wavelength_nm, eps))
    visible = (wavelength_nm >= 400.0) & (wavelength_nm <= 700.0)
    assert np.max(error[visible]) <= 4.0 * eps


def test_fewer_terms_than_four(precision):
    formula = Sellmeier(b=(1.2,), c_um2=(0.01,))
    wavelength_nm = np.linspace(400.0, 700.0, 11)
    n, _, _ = formula_indices(precision, interleaved(formula), wavelength_nm)
    np.testing.assert_allclose(
        n, formula.eta(wavelength_nm), rtol=4 * float(np.finfo(precision).eps)
    )


@pytest.mark.parametrize("a", [(1.5,), (1.5, 0.004), (1.5, 0.004, -1e-5), (1.6, 0.01, 1e-3, 5e-5)])
def test_cauchy(precision, a):
    formula = Cauchy(a)
    wavelength_nm = np.linspace(400.0, 700.0, 101)
    _, n, _ = formula_indices(precision, a, wavelength_nm)
    # Horner's rule adds small terms to a₀: a rounding of each sum, and λ⁻² in the small ones.
    np.testing.assert_allclose(
        n, formula.eta(wavelength_nm), rtol=3 * float(np.finfo(precision).eps)
    )


def test_air(precision):
    wavelength_nm = np.linspace(230.0, 1690.0, 200)
    _, _, n = formula_indices(precision, (), wavelength_nm)
    # 1 plus 3e-4: whatever rounding the refractivity has is lost beside that of the sum.
    np.testing.assert_allclose(
        n, reference_air_index(wavelength_nm), rtol=1.5 * float(np.finfo(precision).eps)
    )


def test_tables(precision):
    # Two tables in one array, so that the second starts behind the first; its knots are uneven.
    rng = np.random.default_rng(11)
    first = Tabulated((400.0, 700.0), (1.52, 1.50))
    knots = np.sort(rng.uniform(380.0, 720.0, 17))
    second = Tabulated(tuple(knots), tuple(1.6 + 3e3 / knots**2 + 1e-3 * rng.normal(size=17)))
    probes = make_probes(precision)
    # Behind the cubics of a table stands a row of zeros, so that rows count as knots do.
    cubics = np.vstack([first.coefficients, np.zeros(4), second.coefficients, np.zeros(4)])
    all_knots = np.concatenate([first.knots_nm, second.knots_nm])
    eps = float(np.finfo(precision).eps)
    for table, start in ((first, 0), (second, 2)):
        low, high = table.wavelength_range_nm
        inside = np.linspace(low, high, 501)
        wavelength_nm = np.concatenate([inside, table.knots_nm]).astype(precision)
        out = wp.zeros(len(wavelength_nm), dtype=probes.types.real, device="cpu")
        inputs = [
            device_array(all_knots, probes.types), device_array(cubics, probes.types), start,
            len(table.knots_nm), device_array(wavelength_nm, probes.types),
        ]  # fmt: skip
        wp.launch(probes.table, dim=len(wavelength_nm), inputs=inputs, outputs=[out], device="cpu")
        at = np.clip(wavelength_nm.astype(np.float64), low, high)
        # A knot rounded to ε/2 shifts its cubic along the wavelength by its slope.
        slope = np.max(np.abs(np.diff(table.index) / np.diff(table.knots_nm)))
        np.testing.assert_allclose(
            out.numpy(), table.eta(at), rtol=0, atol=4 * eps * (1.7 + 3.0 * slope * 700.0)
        )
