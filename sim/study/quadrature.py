"""Quadrature over what a mesh does not span: points of a lamp, directions, wavelengths.

References:
    Press et al. (2007), *Numerical Recipes*, §4.6: Gauss–Legendre quadrature.
    Stroud (1971), *Approximate Calculation of Multiple Integrals*: the disk as a product of
    a Gauss rule in r² and equally spaced angles.
"""

import math

import numpy as np
import numpy.typing as npt

from spectra import EmissionSpectrum
from spectra.piecewise import band_edges

__all__ = ["BandNode", "band_nodes", "disk_nodes", "unit_nodes"]

FloatArray = npt.NDArray[np.float64]

BandNode = tuple[int, float, float]
"""(band, wavelength [nm], share of the lamp's whole flux)."""


def unit_nodes(count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss–Legendre nodes in 0 to 1 and their weights, which add up to 1; each (count,)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (nodes + 1.0), 0.5 * weights


def disk_nodes(count: int) -> list[tuple[float, float, float]]:
    """Nodes (squared radius, angle [rad], weight) of the unit disk; weights add up to 1.

    Args:
        count: nodes along a radius; three times as many, but at least four, go round.
    """
    around = max(4, 3 * count)
    angles = 2.0 * math.pi * (np.arange(around) + 0.5) / around
    return [
        (float(square), float(angle), float(weight) / around)
        for square, weight in zip(*unit_nodes(count), strict=True)
        for angle in angles
    ]


def band_nodes(spectrum: EmissionSpectrum, edges_nm: npt.ArrayLike, count: int) -> list[BandNode]:
    """Wavelengths that stand for the light of each band.

    The continuous part of a band has `count` nodes, Gauss–Legendre over the share of its flux
    below a wavelength, so that they lie where the light is; each line is a node of its own.

    Args:
        spectrum: of the lamp.
        edges_nm: (bands + 1,) band edges [nm]. A line on one belongs to the band above it; on
            the last, to the last band.
        count: nodes a band.

    Raises:
        SpectraError: the edges do not increase strictly.
    """
    edges = band_edges(edges_nm)
    nodes: list[BandNode] = []
    for line, flux in zip(spectrum.line_wavelength_nm, spectrum.line_flux, strict=True):
        if edges[0] <= line <= edges[-1]:
            band = min(int(np.searchsorted(edges, line, side="right")), len(edges) - 1) - 1
            nodes.append((band, float(line), float(flux) / spectrum.total))
    if len(spectrum.wavelength_nm):
        for band in range(len(edges) - 1):
            nodes += _continuous_nodes(spectrum, band, edges, count)
    return nodes


def _continuous_nodes(
    spectrum: EmissionSpectrum, band: int, edges: FloatArray, count: int
) -> list[BandNode]:
    """Nodes of the continuous part of one band."""
    knots = spectrum.wavelength_nm
    low, high = max(edges[band], knots[0]), min(edges[band + 1], knots[-1])
    if low >= high:
        return []
    points = np.concatenate([[low], knots[(knots > low) & (knots < high)], [high]])
    density = np.asarray(spectrum.density_at(points))
    below = np.cumsum(0.5 * np.diff(points) * (density[1:] + density[:-1]))
    if below[-1] <= 0.0:
        return []
    shares, weights = unit_nodes(count)
    cell = np.searchsorted(below, shares * below[-1], side="right")
    wanted = shares * below[-1] - np.concatenate([[0.0], below])[cell]
    d0, d1, width = density[cell], density[cell + 1], np.diff(points)[cell]
    # Root x of d0 x + (d1 − d0) x²/(2 width) = wanted, in a form that survives d0 = d1.
    root = np.sqrt(d0 * d0 + 2.0 * wanted * (d1 - d0) / width)
    wavelength_nm = points[cell] + 2.0 * wanted / (d0 + root)
    flux = weights * below[-1] / spectrum.total
    return [(band, float(at), float(share)) for at, share in zip(wavelength_nm, flux, strict=True)]
