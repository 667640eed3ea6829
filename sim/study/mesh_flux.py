"""One caustic mesh: cells of a lamp's rays, warped onto the receiver, their flux in bins.

A cell of a chart's coordinates holds an exactly known flux. Its corners are traced along the
chain; where all four met the same faces, the cell's image is two triangles, over each of which
its flux, times the mean of what its corners transmit, is spread evenly. Where images overlap, as
behind a caustic, they add up. Cells that an edge cuts, of an object or of the lit region, are
halved in both coordinates again and again; what is still cut in the end gives a quarter of its
flux to each corner that is on the chain.

Reference:
    Born & Wolf 1999, §3.1.2: the intensity law of geometrical optics. Flux is constant
    along a tube of rays.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from sim.study.chain_rays import Chain, trace_chain
from sim.study.quadrature import BandNode
from sim.study.ray_charts import Chart
from sim.study.receiver_bins import ReceiverBins
from sim.study.triangle_bins import bin_triangles

__all__ = ["MeshFlux", "trace_mesh"]

FloatArray = npt.NDArray[np.float64]
Number = TypeVar("Number", bound=np.generic)

CELLS_AT_ONCE = 1 << 18
"""Cells that are traced together: meshes of several wavelengths, where they are small."""


@dataclass(frozen=True, eq=False)
class MeshFlux:
    """What one mesh put into the bins.

    Attributes:
        flux: (rows, columns, bands) [W].
        landed: flux on the receiver's plane, outside of the bins too [W].
        cut: flux of the cells that an edge still cut in the end [W].
    """

    flux: FloatArray
    landed: float
    cut: float


@dataclass(frozen=True, eq=False)
class _Cells:
    """Cells of a chart with their corners (s₀, t₀), (s₁, t₀), (s₁, t₁), (s₀, t₁).

    Attributes:
        s: (n, 2) from and to.
        t: (n,) from.
        node: (n,) which wavelength.
        flux: (n,) of each at intensity 1, as a share of the chart's over all wavelengths.
        place: (n, 4, 2) where the corners land [m].
        weight: (n, 4) intensity times transmittance.
        signature: (n, 4), 0 off the chain.
    """

    s: FloatArray
    t: FloatArray
    node: npt.NDArray[np.intp]
    flux: FloatArray
    place: FloatArray
    weight: FloatArray
    signature: npt.NDArray[np.uint64]

    @property
    def is_whole(self) -> npt.NDArray[np.bool_]:
        """(n,) whether all corners are on the chain and met the same faces."""
        first = self.signature[:, :1]
        whole: npt.NDArray[np.bool_] = np.all(self.signature == first, axis=1) & (first[:, 0] > 0)
        return whole

    @property
    def is_cut(self) -> npt.NDArray[np.bool_]:
        """(n,) whether corners differ, and some are on the chain."""
        cut: npt.NDArray[np.bool_] = np.any(self.signature > 0, axis=1) & ~self.is_whole
        return cut


def trace_mesh(
    chain: Chain,
    receiver: ReceiverBins,
    charts: Sequence[Chart],
    nodes: Sequence[BandNode],
    *,
    flux: float,
    bands: int,
    cells: int,
    depth: int,
) -> MeshFlux:
    """Trace a mesh over every chart and wavelength.

    Args:
        chain: surfaces on the way, and the scene.
        receiver: the bins.
        charts: of the lamp's rays.
        nodes: wavelengths, each with its band and share of the lamp's flux.
        flux: of the lamp [W].
        bands: how many there are.
        cells: a chart has cells² cells: as many each way, or four times as many round as out.
        depth: how often cells that an edge cuts are halved.
    """
    shape = (bands, receiver.rows, receiver.columns)
    total = np.zeros(shape)
    landed = cut = 0.0
    at_once = max(1, CELLS_AT_ONCE // cells**2)
    for chart in charts:
        for first in range(0, len(nodes), at_once):
            mesh = _ChartMesh(chain, chart, nodes[first : first + at_once], cells)
            images, still_cut = mesh.trace(depth)
            emitted = flux * chart.flux * images.share
            total += bin_triangles(
                receiver.to_bins(images.place),
                emitted,
                images.band,
                shape,
                device=chain.compiled.device,
            )
            landed += float(emitted.sum())
            cut += flux * chart.flux * still_cut
    return MeshFlux(np.moveaxis(total, 0, 2), landed, cut)


class _Images(NamedTuple):
    """Triangles on the receiver."""

    place: FloatArray  # (n, 3, 2) [m]
    share: FloatArray  # (n,) of the chart's flux
    band: npt.NDArray[np.intp]  # (n,)


class _ChartMesh:
    """The mesh over one chart, at several wavelengths."""

    def __init__(
        self, chain: Chain, chart: Chart, nodes: Sequence[BandNode], cells: int
    ) -> None:
        self.chain, self.chart = chain, chart
        self.bands = np.array([band for band, _, _ in nodes])
        self.wavelengths_nm = np.array([wavelength_nm for _, wavelength_nm, _ in nodes])
        self.shares = np.array([share for _, _, share in nodes])
        self.sides = (cells // 2, 2 * cells) if chart.is_round else (cells, cells)

    def trace(self, depth: int) -> tuple[_Images, float]:
        """Images of all cells, and the share of the flux in those still cut in the end."""
        count = len(self.shares)
        step = 1.0 / np.array(self.sides)
        cells = self._trace_cells(np.zeros((count, 2)), np.arange(count), step, self.sides)
        found = [self._triangles(cells)]
        for _ in range(depth):
            cut = cells.is_cut
            if not np.any(cut):
                break
            low = np.column_stack([cells.s[cut, 0], cells.t[cut]])
            step = 0.5 * step
            cells = self._trace_cells(low, cells.node[cut], step, (2, 2))
            found.append(self._triangles(cells))
        cut = cells.is_cut
        found.append(self._corners(cells, cut))
        still_cut = float(np.sum(cells.flux[cut] * cells.weight[cut].max(axis=1)))
        return _Images(*(np.concatenate(part) for part in zip(*found, strict=True))), still_cut

    def _trace_cells(
        self,
        low: FloatArray,
        node: npt.NDArray[np.intp],
        step: FloatArray,
        sides: tuple[int, int],
    ) -> _Cells:
        """Trace patches of cells.

        Args:
            low: (p, 2) coordinates (s, t) where each patch begins.
            node: (p,) its wavelength.
            step: (2,) size of a cell.
            sides: cells of a patch along s and t.
        """
        s = low[:, :1] + step[0] * np.arange(sides[0] + 1)
        t = low[:, 1:] + step[1] * np.arange(sides[1] + 1)
        size = (len(low), sides[0] + 1, sides[1] + 1)
        every_s = np.broadcast_to(s[:, :, None], size).ravel()
        every_t = np.broadcast_to(t[:, None, :], size).ravel()
        rays = self.chart.rays(every_s, every_t)
        wavelengths_nm = np.repeat(self.wavelengths_nm[node], size[1] * size[2])
        landings = trace_chain(self.chain, rays.origins, rays.directions, wavelengths_nm)
        signature = np.where(rays.intensity > 0.0, landings.signature, np.uint64(0))
        weight = landings.transmittance * rays.intensity
        flux = self.shares[node][:, None] * np.diff(self.chart.flux_below(s), axis=1) * step[1]
        span = np.stack([s[:, :-1], s[:, 1:]], axis=2)
        count = (len(low), *sides)
        return _Cells(
            s=np.broadcast_to(span[:, :, None, :], (*count, 2)).reshape(-1, 2),
            t=np.broadcast_to(t[:, None, :-1], count).ravel(),
            node=np.repeat(node, sides[0] * sides[1]),
            flux=np.broadcast_to(flux[:, :, None], count).ravel(),
            place=_corners_of(landings.place.reshape(*size, 2)).reshape(-1, 4, 2),
            weight=_corners_of(weight.reshape(size)).reshape(-1, 4),
            signature=_corners_of(signature.reshape(size)).reshape(-1, 4),
        )

    def _triangles(self, cells: _Cells) -> _Images:
        """Both triangles of every whole cell.

        Each gets the cell's flux in proportion to its area at the lamp: to the width of its side.
        """
        whole = cells.is_whole
        place, weight, flux = cells.place[whole], cells.weight[whole], cells.flux[whole]
        width = self.chart.width(cells.s[whole])
        outer = width[:, 1] / width.sum(axis=1)
        halves = (([0, 1, 2], outer), ([0, 2, 3], 1.0 - outer))
        return _Images(
            np.concatenate([place[:, at] for at, _ in halves]),
            np.concatenate([flux * part * weight[:, at].mean(axis=1) for at, part in halves]),
            np.tile(self.bands[cells.node[whole]], 2),
        )

    def _corners(self, cells: _Cells, cut: npt.NDArray[np.bool_]) -> _Images:
        """A quarter of every cut cell's flux at each corner that is on the chain."""
        on_chain = cells.signature[cut] > 0
        place = cells.place[cut][on_chain]
        share = 0.25 * cells.flux[cut][:, None] * cells.weight[cut]
        band = np.broadcast_to(self.bands[cells.node[cut]][:, None], on_chain.shape)
        return _Images(np.repeat(place[:, None, :], 3, axis=1), share[on_chain], band[on_chain])


def _corners_of(values: npt.NDArray[Number]) -> npt.NDArray[Number]:
    """(p, m, n, 4, ...) values at the corners of cells, of (p, m + 1, n + 1, ...) at vertices."""
    low, high = values[:, :-1], values[:, 1:]
    return np.stack([low[:, :, :-1], high[:, :, :-1], high[:, :, 1:], low[:, :, 1:]], axis=3)
