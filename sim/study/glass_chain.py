"""The light that a study bins: from one lamp, through glass by refraction alone, onto a receiver.

Of the paths that photons take, this is the one that a caustic mesh follows too, so that photons
and mesh measure the same quantity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from sim.photons.photon_batch import PhotonBatch
from sim.study.lamp_charts import has_charts
from sim.study.receiver_bins import ReceiverBins, lay_bins

__all__ = ["ChainPhotons", "GlassChain", "bin_chain", "find_chain", "select_chain"]

FloatArray = npt.NDArray[np.float64]

SHINING = 0.01
"""A lamp counts when so much of the photons' deposits is its light through glass."""

OUTSIDE = 0.005
"""Share of the light left out on each side of the bins: its far tails are all but empty."""


@dataclass(frozen=True, eq=False)
class GlassChain:
    """Whose light is binned, and where.

    Attributes:
        emitter: name of the lamp.
        emitter_row: its row among the lamps that shine.
        receiver: name of the rectangle.
        refractions: that a photon has met on its way, and nothing else.
        side: of the receiver that it lands on, 0 front, 1 back.
        bins: over nearly all of that light.
        edges_nm: (bands + 1,) of the bins [nm].
    """

    emitter: str
    emitter_row: int
    receiver: str
    refractions: int
    side: int
    bins: ReceiverBins
    edges_nm: FloatArray

    @property
    def count(self) -> int:
        """Bins, over place and wavelength."""
        return self.bins.rows * self.bins.columns * (len(self.edges_nm) - 1)


@dataclass(frozen=True, eq=False)
class ChainPhotons:
    """The photons of a chain: slots of their batch, places (n, 2) [m], wavelengths, fluxes [W]."""

    slots: npt.NDArray[np.int32]
    place: FloatArray
    wavelength_nm: FloatArray
    flux: FloatArray


def find_chain(
    scene: scenes.Scene, batch: PhotonBatch, *, cells: int, bands: int
) -> GlassChain | None:
    """The first lamp whose light reaches a rectangle through glass, and what it lights most.

    Args:
        scene: what was traced.
        batch: a pilot's photons, which are not used again.
        cells: bins a side; both sides have as many.
        bands: at most so many, of equal width over the film's range.

    Returns:
        The chain, or None if there is no such light.
    """
    photons = batch.to_numpy()
    through = (photons["reflections"] == 0) & (photons["bounces"] == 0)
    through &= photons["refractions"] > 0
    rectangles = [
        row for row, item in enumerate(scene.objects) if isinstance(item.shape, scenes.Rectangle)
    ]
    through &= np.isin(photons["object"], rectangles)
    edges = scene.film.edges_nm
    shining = [one for one in scene.emitters if one.emission().band_flux(edges).any()]
    for row, emitter in enumerate(shining):
        if emitter.polarisation is not None:
            continue  # the mesh's light starts natural
        lit = through & (photons["emitter"] == row) & has_charts(emitter)
        if np.count_nonzero(lit) < SHINING * len(batch):
            continue
        chosen = {key: values[lit] for key, values in photons.items()}
        return _chain_of(scene, (emitter.name, row), chosen, cells, bands)
    return None


def _chain_of(
    scene: scenes.Scene, lamp: tuple[str, int], photons: dict[str, Any], cells: int, bands: int
) -> GlassChain:
    """The chain that carries most of these photons' flux."""
    kind = np.stack([photons["object"], photons["refractions"], photons["side"]], axis=1)
    kinds, inverse = np.unique(kind, axis=0, return_inverse=True)
    flux = np.bincount(inverse.ravel(), weights=photons["flux"])
    brightest = int(np.argmax(flux))
    prim, refractions, side = (int(one) for one in kinds[brightest])
    name = scene.objects[prim].name
    assert name is not None  # a scene has named everything
    whole = lay_bins(scene, name, rows=1, columns=1)
    position = photons["position"][inverse.ravel() == brightest]
    place = (position - whole.centre) @ whole.frame[:2].T
    low, high = np.quantile(place, [OUTSIDE, 1.0 - OUTSIDE], axis=0)
    window = ((float(low[0]), float(high[0])), (float(low[1]), float(high[1])))
    film = scene.film
    edges = np.linspace(film.edges_nm[0], film.edges_nm[-1], min(film.bands, bands) + 1)
    bins = lay_bins(scene, name, rows=cells, columns=cells, window=window)
    return GlassChain(lamp[0], lamp[1], name, refractions, side, bins, edges)


def select_chain(batch: PhotonBatch, chain: GlassChain) -> ChainPhotons:
    """The batch's photons that came along the chain, without touching the others' places."""
    history = batch.data.history.numpy()[batch.slots]
    surface = batch.data.surface.numpy()[batch.slots]
    # Refractions alone: no reflections in the bits from 10 on, no bounces in those from 20 on.
    along = (history & 0x3FFFFFFF) == chain.refractions
    along &= (surface >> 14) == chain.bins.prim
    along &= (surface & 1) == chain.side
    along &= batch.data.emitter.numpy()[batch.slots] == chain.emitter_row
    slots = batch.slots[along]
    position = batch.data.position.numpy()[slots] + batch.origin
    return ChainPhotons(
        slots,
        (position - chain.bins.centre) @ chain.bins.frame[:2].T,
        batch.data.wavelength_nm.numpy()[slots].astype(np.float64),
        batch.data.flux.numpy()[slots],
    )


def bin_chain(photons: ChainPhotons, chain: GlassChain) -> FloatArray:
    """(rows, columns, bands) spectral irradiance, band means [W m⁻² nm⁻¹]."""
    bins, edges = chain.bins, chain.edges_nm
    shape = (bins.rows, bins.columns, len(edges) - 1)
    column, row = np.floor(bins.to_bins(photons.place)).astype(np.int64).T
    step = (edges[-1] - edges[0]) / shape[2]
    band = ((photons.wavelength_nm - edges[0]) / step).astype(np.int64)
    band = np.clip(band, 0, shape[2] - 1)  # single precision may round a wavelength to the edge
    inside = (column >= 0) & (column < bins.columns) & (row >= 0) & (row < bins.rows)
    flat = (row * bins.columns + column) * shape[2] + band
    weights = photons.flux[inside]
    flux: FloatArray = np.bincount(flat[inside], weights, int(np.prod(shape))).astype(float)
    return bins.irradiance(flux.reshape(shape), edges)
