"""What receivers do with a photon's wavelength: bands, groups and reflectances.

Photons fall into groups. One that has met a dispersive boundary is where it is because of its
wavelength: its group is the band of that wavelength. Any other would be where it is at every
wavelength: what it deposits is spread over the bands as the lamp's
spectrum and the receiver's reflectance say. That is the expectation over the wavelength it
happens to carry, so light that no prism has touched has no colour noise at all.

Undispersed photons are dealt out, in packs, over `DEALS` groups in turn. A camera path of one
band gathers one of them, times `DEALS`: the paths of a pixel's other bands see the others.
"""

import functools
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.photons.lamps import Lamps
from sim.precision import precision_types
from sim.scene_data import CompiledScene
from spectra import EmissionSpectrum
from spectra.observer import observer

__all__ = ["DEALS", "compile_receivers", "make_receiver_structs"]

FloatArray = npt.NDArray[np.float64]

DEALS = wp.constant(8)
"""Groups over which undispersed photons are dealt."""

_PARTS_A_BAND = 40
"""Parts of a band over which the product of spectrum and reflectance is summed."""


@functools.cache
def make_receiver_structs(precision: str) -> SimpleNamespace:
    """Struct Receivers, for bands of equal width.

    `reflectance[object, i]` holds at `first_nm + i` nm and is linear between; it is divided by
    π. `share[lamp, band]` is the share of the lamp's flux in the band, and
    `spread[lamp, object, band]` that times the reflectance there over π. `luminance[band]` is
    that of unit radiance in the band [cd/m²], and `spread_luminance[lamp, object]` that of
    `spread`. Groups: `bands` bands, then `DEALS`.
    """
    real = precision_types(precision).real

    @wp.struct
    class Receivers:
        bands: int
        lamps: int
        first_edge_nm: real
        band_width_nm: real
        first_nm: real
        reflectance: wp.array2d(dtype=real)
        spread: wp.array3d(dtype=real)
        share: wp.array2d(dtype=real)
        luminance: wp.array(dtype=real)
        spread_luminance: wp.array2d(dtype=real)

    return SimpleNamespace(Receivers=Receivers)


def compile_receivers(compiled: CompiledScene, lamps: Lamps, edges_nm: FloatArray) -> Any:
    """The device-side Receivers struct.

    Args:
        compiled: the scene.
        lamps: its lamps.
        edges_nm: (bands + 1,) edges of bands of equal width [nm].
    """
    types = precision_types(compiled.precision)
    first, last = np.floor(edges_nm[0]), np.ceil(edges_nm[-1])
    wavelength_nm = np.arange(first, last + 2.0)
    reflectance = _reflectances(compiled, wavelength_nm) / np.pi
    spread = np.stack([_spread(compiled, one, edges_nm) for one in lamps.spectra])
    data = make_receiver_structs(compiled.precision).Receivers()
    data.bands = len(edges_nm) - 1
    data.lamps = len(lamps.spectra)
    data.first_edge_nm = float(edges_nm[0])
    data.band_width_nm = float(edges_nm[-1] - edges_nm[0]) / data.bands
    data.first_nm = float(first)
    data.reflectance = wp.array(
        reflectance.astype(types.dtype), dtype=types.real, device=compiled.device
    )
    data.spread = wp.array(spread.astype(types.dtype), dtype=types.real, device=compiled.device)
    share = np.stack([one.band_flux(edges_nm) / one.total for one in lamps.spectra])
    data.share = wp.array(share.astype(types.dtype), dtype=types.real, device=compiled.device)
    luminance = _luminance_weights(compiled.scene.film.observer, edges_nm)
    data.luminance = wp.array(
        luminance.astype(types.dtype), dtype=types.real, device=compiled.device
    )
    data.spread_luminance = wp.array(
        (spread @ luminance).astype(types.dtype), dtype=types.real, device=compiled.device
    )
    return data


def _luminance_weights(observer_name: str, edges_nm: FloatArray) -> FloatArray:
    """(bands,) luminance of unit radiance in each band, 683 ∫ ȳ dλ [cd/m²]."""
    weights: FloatArray = observer(observer_name).xyz(np.eye(len(edges_nm) - 1), edges_nm)[:, 1]
    return weights


def _reflectances(compiled: CompiledScene, wavelength_nm: FloatArray) -> FloatArray:
    """(objects, wavelengths) reflectance; 0 for what is not diffuse."""
    objects = compiled.scene.objects
    table = np.zeros((len(objects), len(wavelength_nm)))
    for row, item in enumerate(objects):
        if isinstance(item.material, scenes.Lambertian):
            table[row] = item.material.reflectance_at(wavelength_nm)
    return table


def _spread(
    compiled: CompiledScene, spectrum: EmissionSpectrum, edges_nm: FloatArray
) -> FloatArray:
    """(objects, bands) ∫ s(λ) ρ(λ) dλ / π over each band, ∫ s dλ = 1 over the film."""
    bands = len(edges_nm) - 1
    parts = np.linspace(edges_nm[0], edges_nm[-1], bands * _PARTS_A_BAND + 1)
    lines_nm, lines = spectrum.line_wavelength_nm, spectrum.line_flux
    continuous = spectrum.band_flux(parts) - np.histogram(lines_nm, parts, weights=lines)[0]
    product = continuous * _reflectances(compiled, 0.5 * (parts[:-1] + parts[1:]))
    spread: FloatArray = product.reshape(len(product), bands, _PARTS_A_BAND).sum(axis=2)
    # A line is reflected as at its own wavelength, not as in the middle of a part of its band.
    for row, reflected in enumerate(lines * _reflectances(compiled, lines_nm)):
        spread[row] += np.histogram(lines_nm, edges_nm, weights=reflected)[0]
    return spread / (spectrum.total * np.pi)
