"""A reference without photons: the irradiance that one chain of smooth surfaces makes.

The mesh's error is of second order in the size of its cells, and known from halving it: with the
differences d₁ between the meshes of K and K/2 cells a side and d₂ between those of K/2 and K/4,

    p = log₂(‖d₂‖ / ‖d₁‖),   error ≈ |d₁| / (2ᵖ − 1)

(Richardson's extrapolation; Roache 1997, "Quantification of Uncertainty in Computational Fluid
Dynamics", Annu. Rev. Fluid Mech. 29). What the nodes over a lamp's extent and over each band leave
out is measured apart, by halving their numbers, and is not divided by anything.
"""

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes import Plane, Scene
from scenes.emitters import AnyLocalEmitter
from sim.errors import SettingsError
from sim.scene_data import CompiledScene
from sim.study.chain_rays import make_chain
from sim.study.lamp_charts import has_charts, has_extent, make_charts
from sim.study.mesh_flux import MeshFlux, trace_mesh
from sim.study.quadrature import band_nodes
from sim.study.receiver_bins import ReceiverBins, find_object

__all__ = ["DEFAULT_RESOLUTION", "CausticMesh", "Resolution", "trace_caustic_mesh"]

FloatArray = npt.NDArray[np.float64]

ORDER_RANGE = (0.5, 2.0)
"""Orders that the error is extrapolated with: a caustic's edge may lower it, but what is measured
above 2 is chance."""

HALVINGS = 3
"""Edges are resolved to K · 2^depth; depth grows with log₂ K − HALVINGS, so that what is cut in the
end goes with 1/K² too."""


@dataclass(frozen=True, kw_only=True)
class Resolution:
    """How finely the light is cut up.

    Attributes:
        cells: K: every chart has K² cells, a power of 2 from 16 on.
        wavelengths: nodes in each band, an even number. Where a band is spread out, as behind a
            prism, there must be so many that their images overlap in every bin.
        lamp_points: nodes along each direction of the lamp's extent, or along its radius, an even
            number; a lamp without extent, or a beam without divergence, has one.

    Raises:
        SettingsError: a number is not allowed.
    """

    cells: int = 128
    wavelengths: int = 4
    lamp_points: int = 4

    def __post_init__(self) -> None:
        """Check."""
        if self.cells < 16 or self.cells & (self.cells - 1):
            raise SettingsError("cells", self.cells, "a power of 2 from 16 on")
        for field in ("wavelengths", "lamp_points"):
            count = getattr(self, field)
            if count < 2 or count % 2:
                raise SettingsError(field, count, "an even number from 2 on")


DEFAULT_RESOLUTION = Resolution()


@dataclass(frozen=True, eq=False)
class CausticMesh:
    """The light of one chain on a receiver, and how sure it is.

    Attributes:
        irradiance: (rows, columns, bands), spectral irradiance as band means [W m⁻² nm⁻¹].
        error: same shape and unit, the estimated error of each.
        edges_nm: (bands + 1,) [nm].
        order: measured order of convergence; NaN where the meshes agree to rounding.
        mesh_error, wavelength_error, lamp_error: relative L2 norms of the error's parts: from the
            size of the cells, the wavelengths of a band, the points of the lamp.
        landed: flux on the receiver's plane, outside of the bins too [W].
        cut_fraction: flux of cells that an edge still cut in the end, relative to `landed`; of
            this, about half is on the chain, and is counted.
        emitted: flux of the lamp within the bands [W].
    """

    irradiance: FloatArray
    error: FloatArray
    edges_nm: FloatArray
    order: float
    mesh_error: float
    wavelength_error: float
    lamp_error: float
    landed: float
    cut_fraction: float
    emitted: float

    @property
    def relative_error(self) -> float:
        """Estimated relative L2 error of the irradiance: the sum of its parts."""
        return self.mesh_error + self.wavelength_error + self.lamp_error


def trace_caustic_mesh(
    compiled: CompiledScene,
    receiver: ReceiverBins,
    *,
    emitter: str,
    target: str,
    edges_nm: npt.ArrayLike,
    branches: Sequence[str] | None = None,
    resolution: Resolution = DEFAULT_RESOLUTION,
) -> CausticMesh:
    """Trace the mesh, and its halves for the error.

    Features smaller than a cell that none of its corners meets are missed, as are chains through
    objects the mesh is not made for.

    Args:
        compiled: the scene, in float64.
        receiver: the bins, see `lay_bins`.
        emitter: name of the lamp.
        target: name of the object that the chain meets first, around which the mesh is made.
        edges_nm: (bands + 1,) band edges [nm], within the film's range.
        branches: "refract" or "reflect" at each surface on the way; None refracts at all there
            are.
        resolution: of the finest mesh.

    Raises:
        SettingsError: there is no such emitter or object, its light is polarised, a branch has
            another name, or the edges are outside of the film's range.
    """
    edges = _require_film(compiled.scene, edges_nm)
    lamp = _find_emitter(compiled.scene, emitter)
    if lamp.polarisation is not None:
        raise SettingsError("emitter", emitter, "a lamp of natural light, for a mesh")
    bounds = _bounds(compiled.scene, target)
    chain = make_chain(compiled, receiver, branches)

    @functools.cache
    def trace(cells: int, wavelengths: int, lamp_points: int) -> MeshFlux:
        return trace_mesh(
            chain,
            receiver,
            make_charts(lamp, *bounds, lamp_points),
            band_nodes(lamp.emission(), edges, wavelengths),
            flux=lamp.flux,
            bands=len(edges) - 1,
            cells=cells,
            depth=max(0, round(math.log2(cells)) - HALVINGS),
        )

    emitted = lamp.flux * float(np.sum(lamp.emission().band_flux(edges))) / lamp.emission().total
    return _halve(trace, resolution, has_extent(lamp), (receiver, edges, emitted))


def _halve(
    trace: Callable[[int, int, int], MeshFlux],
    resolution: Resolution,
    extended: bool,
    frame: tuple[ReceiverBins, FloatArray, float],
) -> CausticMesh:
    """The finest mesh with its error, from others of half and a quarter of its numbers.

    Args:
        trace: a mesh of so many cells, wavelengths and points of the lamp.
        resolution: of the finest mesh.
        extended: whether the lamp has more points than one.
        frame: the bins, the band edges [nm] and the flux of the lamp within them [W].
    """
    receiver, edges, emitted = frame
    cells, wavelengths = resolution.cells, resolution.wavelengths
    points = resolution.lamp_points if extended else 1
    finest, half, quarter = (trace(cells // part, wavelengths, points) for part in (1, 2, 4))
    order, mesh_error = _extrapolate(finest.flux, half.flux, quarter.flux)
    errors = [
        mesh_error,
        np.abs(quarter.flux - trace(cells // 4, wavelengths // 2, points).flux),
        np.abs(quarter.flux - trace(cells // 4, wavelengths, max(1, points // 2)).flux),
    ]
    norm = float(np.linalg.norm(finest.flux)) or 1.0
    parts = [float(np.linalg.norm(one)) / norm for one in errors]
    return CausticMesh(
        irradiance=receiver.irradiance(finest.flux, edges),
        error=receiver.irradiance(np.sum(errors, axis=0), edges),
        edges_nm=edges,
        order=order,
        mesh_error=parts[0],
        wavelength_error=parts[1],
        lamp_error=parts[2],
        landed=finest.landed,
        cut_fraction=finest.cut / finest.landed if finest.landed else 0.0,
        emitted=emitted,
    )


def _extrapolate(
    finest: FloatArray, half: FloatArray, quarter: FloatArray
) -> tuple[float, FloatArray]:
    """Measured order of convergence, and the error of the finest mesh."""
    first, second = np.abs(finest - half), np.abs(half - quarter)
    # Rounding, of sums over thousands of cells, has no order.
    rounding = 1e-12 * float(np.linalg.norm(finest))
    if np.linalg.norm(first) <= rounding or np.linalg.norm(second) <= rounding:
        return math.nan, first
    order = math.log2(float(np.linalg.norm(second) / np.linalg.norm(first)))
    used = min(max(order, ORDER_RANGE[0]), ORDER_RANGE[1])
    return order, first / (2.0**used - 1.0)


def _find_emitter(scene: Scene, name: str) -> AnyLocalEmitter:
    """The emitter called `name`."""
    for lamp in scene.emitters:
        if lamp.name == name:
            if has_charts(lamp):
                return lamp
            raise SettingsError("emitter", name, "one not infinitely far away, and without mask")
    names = ", ".join(lamp.name for lamp in scene.emitters)
    raise SettingsError("emitter", name, f"an emitter of the scene: {names}")


def _bounds(scene: Scene, target: str) -> tuple[FloatArray, float]:
    """Centre and radius of the sphere around an object [m]."""
    shape = scene.objects[find_object(scene, "target", target)].shape
    if isinstance(shape, Plane):
        raise SettingsError("target", target, "an object of finite size")
    return shape.bounding_sphere()


def _require_film(scene: Scene, edges_nm: npt.ArrayLike) -> FloatArray:
    """The band edges as an array, once they are found within the film's.

    Only there is every medium of the scene known to have an index.
    """
    edges = np.asarray(edges_nm, dtype=np.float64)
    film = scene.film.edges_nm
    if edges[0] < film[0] - 1e-9 or edges[-1] > film[-1] + 1e-9:
        allowed = f"within the film's {film[0]:g} to {film[-1]:g} nm"
        raise SettingsError("edges_nm", (float(edges[0]), float(edges[-1])), allowed)
    return edges
