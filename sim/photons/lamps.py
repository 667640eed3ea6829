"""The scene's emitters as device arrays, and how many photons each sends where."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.photons.aiming import Aim, Guide, View, aim_at_sensors, plan_photons
from sim.photons.emitted_light import compile_vibrations
from sim.photons.emitter_rows import emitter_row, full_flux, mask_functions
from sim.photons.lamp_structs import AIM_CELLS, make_lamp_structs
from sim.precision import precision_types
from sim.sampling.counter import seed_words
from sim.sampling.sobol import DIMENSIONS, sobol_tables
from sim.scene_data import CompiledScene, struct_array
from spectra import EmissionSpectrum

__all__ = ["Lamps", "Stream", "compile_lamps"]

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Stream:
    """Photons of one emitter at one target: one low-discrepancy sequence of `photons` points."""

    emitter: int
    target: int
    photons: int


@dataclass(frozen=True)
class Lamps:
    """Emitters on the device, and the streams that a pass draws from them.

    Attributes:
        data: the device-side Lamps struct.
        streams: what one pass emits; their photon counts add up to the pass's photons.
        flux: radiant flux inside the film's wavelengths, all lamps together [W]; of distant lamps
            what comes through a sphere around the scene.
        spectra: of each emitter on the device, inside the film's wavelengths.
        aims: of each emitter on the device, what its streams are aimed at.
    """

    data: Any
    streams: tuple[Stream, ...]
    flux: float
    spectra: tuple[EmissionSpectrum, ...]
    aims: tuple[tuple[Aim, ...], ...]

    def seed(self, device: str, seed: int, pass_index: int) -> None:
        """Give every stream its own scramble for this pass."""
        words = seed_words(len(self.streams) * DIMENSIONS, seed, pass_index)
        self.data.seeds = wp.array(words, dtype=wp.uint32, device=device)


def compile_lamps(
    compiled: CompiledScene,
    edges_nm: FloatArray,
    photons: int,
    *,
    view: View | None = None,
    direct: bool = True,
    guide: Guide | None = None,
) -> Lamps:
    """Lay the emitters out and share `photons` among them and their targets.

    Args:
        compiled: the scene.
        edges_nm: band edges of the film; light outside of them is not emitted.
        photons: photons of one pass.
        view: what the camera sees, so that most photons are aimed there; None: no camera.
        direct: whether what comes straight from a lamp is worth photons; else only glass is.
        guide: what a pilot has learned of where photons are worth most, in place of both.

    Raises:
        scenes.SceneError: no emitter shines inside the film's wavelengths.
    """
    shining = find_shining(compiled, edges_nm)
    emitters = [(emitter, flux) for emitter, _, flux in shining]
    if guide is None:
        guide = plan_photons(compiled, emitters, view, direct=direct)
    else:
        guide = aim_at_sensors(compiled, emitters, guide)
    counts = _share(photons, list(guide.shares))
    tables = _Tables()
    for (emitter, spectrum, flux), aims, count in zip(shining, guide.aims, counts, strict=True):
        tables.add(
            emitter_row(compiled, emitter, flux), spectrum, aims, count, mask_functions(emitter)
        )
    data = tables.on_device(compiled)
    data.vibrations = compile_vibrations(
        [emitter for emitter, _, _ in shining], compiled.precision, compiled.device
    )
    flux = sum(flux for _, _, flux in shining)
    spectra = tuple(spectrum for _, spectrum, _ in shining)
    return Lamps(data, tuple(tables.streams), flux, spectra, guide.aims)


class _Tables:
    """Rows of the device's arrays as they grow, lamp by lamp, and the streams they make."""

    def __init__(self) -> None:
        self.emitters: list[dict[str, Any]] = []
        self.targets: list[tuple[Any, ...]] = []
        self.segments: list[tuple[Any, ...]] = []
        self.streams: list[Stream] = []
        self.distributions: list[FloatArray] = []

    def add(
        self,
        emitter: dict[str, Any],
        spectrum: EmissionSpectrum,
        aims: tuple[Aim, ...],
        photons: int,
        mask: list[FloatArray],
    ) -> None:
        """Add a lamp with its spectrum, mask and aims, among which `photons` are shared out."""
        pieces, shares = _segments(spectrum)
        self.emitters.append({
            **emitter,
            "first_target": len(self.targets), "target_count": len(aims),
            "first_segment": len(self.segments), "segment_count": len(pieces),
            "first_cdf": self._add_distribution(shares),
            "first_mask": self._add_distribution(*mask) if mask else -1,
            "mask_columns": len(mask) - 1, "mask_rows": len(mask[-1]) - 1 if mask else 0,
        })  # fmt: skip
        self.segments.extend(pieces)
        for aim, count in zip(aims, _share(photons, [a.share for a in aims]), strict=True):
            self.streams.append(Stream(len(self.emitters) - 1, len(self.targets), count))
            functions = aim.distribution.reshape(-1, int(AIM_CELLS) + 1)
            first_cdf = self._add_distribution(*functions) if len(functions) else -1
            shape = (aim.kind, aim.centre, aim.frame, *aim.half, aim.radius, aim.pivot)
            self.targets.append((*shape, first_cdf, float(count)))

    def _add_distribution(self, *functions: FloatArray) -> int:
        """Where the given distribution functions start among all of them."""
        first = sum(len(one) for one in self.distributions)
        self.distributions.extend(functions)
        return first

    def on_device(self, compiled: CompiledScene) -> Any:
        """The device-side Lamps struct, but for the seeds, which are a pass's own."""
        structs, device = make_lamp_structs(compiled.precision), compiled.device
        types = precision_types(compiled.precision)
        data = structs.Lamps()
        fields = structs.Emitter.numpy_dtype()["names"]
        rows = [tuple(one[name] for name in fields) for one in self.emitters]
        data.emitters = struct_array(structs.Emitter, rows, device)
        data.targets = struct_array(structs.Target, self.targets, device)
        data.segments = struct_array(structs.Segment, self.segments, device)
        data.sobol = wp.array(sobol_tables(), dtype=wp.uint32, device=device)
        cdf = np.concatenate(self.distributions).astype(types.dtype)
        data.cdf = wp.array(cdf, dtype=types.real, device=device)
        guide = np.concatenate([_guide(one) for one in self.distributions])
        data.guide = wp.array(guide, dtype=int, device=device)
        return data


def find_shining(
    compiled: CompiledScene, edges_nm: FloatArray
) -> list[tuple[Any, EmissionSpectrum, float]]:
    """The emitters that shine inside the film's range, each with what it gives there."""
    shining = [
        (emitter, *part)
        for emitter in compiled.scene.emitters
        if (part := _film_part(compiled, emitter, edges_nm)) is not None
    ]
    if not shining:
        allowed = f"an emitter that shines between {edges_nm[0]:g} and {edges_nm[-1]:g} nm"
        problem = scenes.Problem("emitters", f"none gives light; it needs {allowed}", None, allowed)
        raise scenes.SceneError(compiled.scene.source_name, [problem])
    return shining


def _film_part(
    compiled: CompiledScene, emitter: Any, edges_nm: FloatArray
) -> tuple[EmissionSpectrum, float] | None:
    """The emitter's spectrum inside the film's range and the flux it has there [W], if any."""
    spectrum = emitter.emission()
    low, high = float(edges_nm[0]), float(edges_nm[-1])
    inside = float(np.sum(spectrum.band_flux(np.array([low, high]))))
    if inside <= 0.0:
        return None
    return spectrum.restricted(low, high), full_flux(compiled, emitter) * inside / spectrum.total


def _share(total: int, weights: list[float]) -> list[int]:
    """Whole numbers in proportion to `weights` that add up to `total`, none of them zero.

    A target without photons would leave its light to the others' weights, so where `total` is
    smaller than the number of weights, each still gets one.
    """
    scaled = np.asarray(weights) / np.sum(weights) * total
    counts = np.maximum(np.floor(scaled).astype(int), 1)
    largest = np.argmax(counts)
    counts[largest] = max(1, counts[largest] + total - counts.sum())
    return [int(count) for count in counts]


def _segments(spectrum: EmissionSpectrum) -> tuple[list[tuple[float, ...]], FloatArray]:
    """Rows of Segment (trapezoids, then lines), and the distribution function over them."""
    knots, density = spectrum.wavelength_nm, spectrum.density
    rows = []
    for i in range(len(knots) - 1):
        width = float(knots[i + 1] - knots[i])
        mass = 0.5 * width * float(density[i] + density[i + 1])
        if mass > 0.0:
            rows.append((float(knots[i]), width, float(density[i]), float(density[i + 1]), mass))
    for line_nm, flux in zip(spectrum.line_wavelength_nm, spectrum.line_flux, strict=True):
        rows.append((float(line_nm), 0.0, 0.0, 0.0, float(flux)))
    edges = np.concatenate([[0.0], np.cumsum([row[-1] for row in rows])])
    edges /= edges[-1]
    return [row[:-1] for row in rows], edges


def _guide(cdf: FloatArray) -> npt.NDArray[np.int32]:
    """Cell of a distribution function over n cells at u = 0, 1/n, … 1 (n + 1 numbers)."""
    cells = len(cdf) - 1
    found = np.searchsorted(cdf[1:], np.arange(cells + 1) / cells, side="right")
    return np.minimum(found, cells - 1).astype(np.int32)
