import numpy as np
import pytest

from sim.study.quadrature import band_nodes, disk_nodes, unit_nodes
from spectra import EmissionSpectrum, spectrum


@pytest.mark.parametrize("count", [1, 2, 5])
def test_unit_nodes_integrate_polynomials(count):
    # ∫₀¹ x^k dx = 1/(k + 1), exact up to degree 2n − 1.
    nodes, weights = unit_nodes(count)
    for k in range(2 * count):
        assert weights @ nodes**k == pytest.approx(1.0 / (k + 1), rel=1e-13)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_disk_nodes_integrate_over_the_disk(count):
    # Means over the unit disk: ⟨1⟩ = 1, ⟨x⟩ = ⟨xy⟩ = 0, ⟨x²⟩ = ⟨y²⟩ = 1/4, ⟨r⁴⟩ = 1/3.
    square, angle, weight = np.array(disk_nodes(count)).T
    x, y = np.sqrt(square) * np.cos(angle), np.sqrt(square) * np.sin(angle)
    means = [np.sum(weight * value) for value in (np.ones_like(x), x, x * y, x * x, y * y)]
    np.testing.assert_allclose(means, [1.0, 0.0, 0.0, 0.25, 0.25], atol=1e-14)
    if count > 1:
        assert np.sum(weight * square**2) == pytest.approx(1 / 3, rel=1e-13)


def test_band_nodes_carry_each_bands_flux_and_mean_wavelength():
    # D65 between knots, cut by the edges; ∫ E dλ from the spectrum, ∫ λ E dλ by a fine sum.
    light = spectrum("D65")
    edges = np.array([401.0, 478.0, 603.0, 699.0])
    nodes = band_nodes(light, edges, 4)
    fine = np.linspace(401.0, 699.0, 298_001)
    density = light.density_at(fine)
    for band in range(3):
        at = np.array([(nm, share) for row, nm, share in nodes if row == band])
        assert len(at) == 4
        assert np.all((at[:, 0] > edges[band]) & (at[:, 0] < edges[band + 1]))
        flux = light.band_flux(edges)[band]
        assert at[:, 1].sum() * light.total == pytest.approx(flux, rel=1e-12)
        inside = (fine >= edges[band]) & (fine <= edges[band + 1])
        mean = np.average(fine[inside], weights=density[inside])
        # λ over the share of the flux below it is smooth but for D65's knots: 5 nm, 4 nodes.
        assert at[:, 0] @ at[:, 1] / at[:, 1].sum() == pytest.approx(mean, abs=0.3)


def test_a_linear_density_is_inverted_exactly():
    # E ∝ λ − 400: share below λ is ((λ − 400)/100)², so λ = 400 + 100 √u.
    light = EmissionSpectrum("ramp", np.array([400.0, 500.0]), np.array([0.0, 2.0]))
    nodes = band_nodes(light, np.array([400.0, 500.0]), 3)
    expected = 400.0 + 100.0 * np.sqrt(unit_nodes(3)[0])
    np.testing.assert_allclose([nm for _, nm, _ in nodes], expected, rtol=1e-13)


def test_lines_are_nodes_of_their_own_in_the_bands_that_band_flux_says():
    light = EmissionSpectrum(
        "lines and a band",
        np.array([500.0, 520.0]),
        np.array([1.0, 1.0]),
        np.array([450.0, 500.0, 560.0, 600.0]),
        np.array([3.0, 4.0, 5.0, 6.0]),
    )
    edges = np.array([440.0, 500.0, 560.0])  # 500 on an inner edge, 560 on the last
    nodes = band_nodes(light, edges, 2)
    assert [(band, nm) for band, nm, _ in nodes[:3]] == [(0, 450.0), (1, 500.0), (1, 560.0)]
    shares = [sum(share for row, _, share in nodes if row == band) for band in (0, 1)]
    np.testing.assert_allclose(shares, light.band_flux(edges) / light.total, rtol=1e-12)


def test_a_dark_band_has_no_nodes():
    light = EmissionSpectrum("gap", np.array([400.0, 450.0, 550.0, 600.0]), np.array([1, 0, 0, 1]))
    nodes = band_nodes(light, np.array([300.0, 350.0, 440.0, 460.0, 540.0, 600.0]), 2)
    assert sorted({band for band, _, _ in nodes}) == [1, 2, 4]
