"""Refractive index on the device: the formulas of `spectra.dispersion`, one medium a row.

A row of `DISPERSION_COEFFICIENTS` numbers holds B₁C₁…B₄C₄ (Sellmeier, C in µm²) or a₀…a₃
(Cauchy). A table is the piecewise cubic that `spectra.Tabulated` made, evaluated as it is there.

References:
    Sellmeier (1871), n² − 1 = Σ Bλ²/(λ² − C); Cauchy (1836), n = Σ aₖ λ^(−2k).
    Ciddor (1996), Appl. Opt. 35, 1566, eq. (1): the phase index of standard air.
"""

from typing import Any

import warp as wp

__all__ = [
    "DISPERSION_COEFFICIENTS",
    "air_index",
    "cauchy_index",
    "sellmeier_index",
    "tabulated_index",
]

DISPERSION_COEFFICIENTS = 8
"""Numbers a medium's row holds: four Sellmeier terms of two."""


@wp.func
def sellmeier_index(coefficients: Any, row: int, wavelength_um: Any):
    """Index of the Sellmeier medium in `row` at `wavelength_um`; unused terms have B = 0, C = 0."""
    lambda2 = wavelength_um * wavelength_um
    n2 = type(wavelength_um)(1.0)
    for term in range(4):
        b = coefficients[row, 2 * term]
        if b != type(wavelength_um)(0.0):
            n2 += b * lambda2 / (lambda2 - coefficients[row, 2 * term + 1])
    return wp.sqrt(n2)


@wp.func
def cauchy_index(coefficients: Any, row: int, wavelength_um: Any):
    """Index of the Cauchy medium in `row` at `wavelength_um`, by Horner's rule in λ⁻²."""
    x = type(wavelength_um)(1.0) / (wavelength_um * wavelength_um)
    a0 = coefficients[row, 0]
    a1 = coefficients[row, 1]
    a2 = coefficients[row, 2]
    a3 = coefficients[row, 3]
    return a0 + x * (a1 + x * (a2 + x * a3))


@wp.func
def tabulated_index(knots_nm: Any, cubics: Any, first: int, count: int, wavelength_nm: Any):
    """Index by the cubic between the two of `count` knots, from `first` on, around λ."""
    low = int(0)
    high = int(count - 1)
    while high - low > 1:
        middle = (low + high) // 2
        if knots_nm[first + middle] <= wavelength_nm:
            low = middle
        else:
            high = middle
    interval = first + low
    x = wavelength_nm - knots_nm[interval]
    n = cubics[interval, 0]
    for power in range(1, 4):
        n = n * x + cubics[interval, power]
    return n


@wp.func
def air_index(wavelength_um: Any):
    """Index of standard air at 15 °C and 101 325 Pa (Ciddor 1996, eq. 1)."""
    sigma2 = type(wavelength_um)(1.0) / (wavelength_um * wavelength_um)
    refractivity = type(wavelength_um)(0.05792105) / (type(wavelength_um)(238.0185) - sigma2)
    refractivity += type(wavelength_um)(0.00167917) / (type(wavelength_um)(57.362) - sigma2)
    return type(wavelength_um)(1.0) + refractivity
