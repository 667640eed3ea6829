"""The scene's emitters as device arrays, and how many photons each sends where."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.photons.lamp_structs import (
    AIM_AREA,
    AIM_BASE,
    AIM_CONE,
    BEAM,
    POINT,
    RECTANGLE_LAMP,
    SPHERE_LAMP,
    SPOT,
    make_lamp_structs,
)
from sim.precision import precision_types
from sim.sampling.counter import seed_words
from sim.sampling.sobol import DIMENSIONS, sobol_tables
from sim.scene_data import CompiledScene, axis_frame, struct_array
from spectra import EmissionSpectrum

__all__ = ["Lamps", "Stream", "compile_lamps"]

FloatArray = npt.NDArray[np.float64]


class View(Protocol):
    """What a camera sees of each object: `sim.image.survey.Survey` is one."""

    def extent(self, prim: int, frame: FloatArray) -> FloatArray | None:
        """(2, 3) low and high of the visible part along the rows of `frame`, or None."""

    def fraction(self, prim: int) -> float:
        """Fraction of the picture in which the object is seen, directly or through glass."""


Aim = tuple[Any, ...]
"""The fields of a Target, but for its number of photons."""

SPECULAR_SHARE = 0.25
RECEIVER_SHARE = 0.65
"""Shares of a lamp's photons aimed at specular objects and at receivers; the rest go as the lamp
radiates. They divide effort, not light: any positive shares give the same expected picture."""

SMALLEST_WEIGHT = 0.05
"""A receiver's weight among the others is the fraction of the picture it fills, but at least this:
what the camera barely sees may still be somebody's measurement."""

VISIBLE_SHARE = 0.85
"""Share of a receiver's photons that are aimed at its visible part, if that is aimed at."""

VISIBLE_MARGIN = 0.02
"""Added on each side of a receiver's visible part, as a fraction of its size."""

VISIBLE_WORTH = 0.7
"""A visible part larger than this fraction of the receiver is not aimed at for itself."""


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
        flux: radiant flux inside the film's wavelengths, all lamps together [W].
        spectra: of each emitter on the device, inside the film's wavelengths.
    """

    data: Any
    streams: tuple[Stream, ...]
    flux: float
    spectra: tuple[EmissionSpectrum, ...]

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
) -> Lamps:
    """Lay the emitters out and share `photons` among them and their targets.

    Args:
        compiled: the scene.
        edges_nm: band edges of the film; light outside of them is not emitted.
        photons: photons of one pass.
        view: what the camera sees, so that most photons are aimed there; None: no camera.
    """
    scene, structs = compiled.scene, make_lamp_structs(compiled.precision)
    emitters: list[tuple[Any, ...]] = []
    targets: list[tuple[Any, ...]] = []
    segments: list[tuple[Any, ...]] = []
    streams: list[Stream] = []
    shining: list[EmissionSpectrum] = []
    spectra = [_film_part(emitter, edges_nm) for emitter in scene.emitters]
    counts = _share(photons, [0.5 / len(spectra) + 0.5 * f for f in _fractions(spectra)])
    for row, (emitter, (spectrum, flux)) in enumerate(zip(scene.emitters, spectra, strict=True)):
        if spectrum is None or counts[row] == 0:
            continue
        shining.append(spectrum)
        aims = _find_targets(compiled, emitter, view)
        pieces = _segments(spectrum)
        shares = _share(counts[row], [share for share, _ in aims])
        first = len(targets)
        for (_, aim), count in zip(aims, shares, strict=True):
            streams.append(Stream(len(emitters), len(targets), count))
            targets.append((*aim, float(count)))
        emitters.append(
            (*_emitter_row(compiled, emitter), flux, first, len(aims), len(segments), len(pieces))
        )
        segments.extend(pieces)
    data = structs.Lamps()
    data.emitters = struct_array(structs.Emitter, emitters, compiled.device)
    data.targets = struct_array(structs.Target, targets, compiled.device)
    data.segments = struct_array(structs.Segment, segments, compiled.device)
    data.sobol = wp.array(sobol_tables(), dtype=wp.uint32, device=compiled.device)
    flux = float(sum(flux for _, flux in spectra))
    return Lamps(data, tuple(streams), flux, tuple(shining))


def _film_part(
    emitter: Any, edges_nm: FloatArray
) -> tuple[EmissionSpectrum | None, float]:
    """The emitter's spectrum inside the film's range, and the flux it has there [W]."""
    spectrum = emitter.emission()
    low, high = float(edges_nm[0]), float(edges_nm[-1])
    inside = float(np.sum(spectrum.band_flux(np.array([low, high]))))
    if inside <= 0.0:
        return None, 0.0
    return spectrum.restricted(low, high), emitter.flux * inside / spectrum.total


def _fractions(spectra: list[tuple[EmissionSpectrum | None, float]]) -> list[float]:
    """Each emitter's fraction of the whole flux."""
    total = sum(flux for _, flux in spectra)
    return [flux / total for _, flux in spectra]


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


def _segments(spectrum: EmissionSpectrum) -> list[tuple[float, ...]]:
    """Rows of Segment: the continuous part's trapezoids, then the lines, with their shares."""
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
    return [(*row[:-1], edges[i], edges[i + 1]) for i, row in enumerate(rows)]


def _emitter_row(compiled: CompiledScene, emitter: Any) -> tuple[Any, ...]:
    """The geometric fields of an Emitter: kind to sin2_half."""
    centre = compiled.to_local(emitter.position)
    frame = np.eye(3)
    if isinstance(emitter, scenes.Beam):
        frame = np.stack(emitter.frame())
        sin2_half = np.sin(0.5 * np.radians(emitter.divergence_deg)) ** 2
        if isinstance(emitter.profile, scenes.RoundProfile):
            radius = emitter.profile.radius
            return int(BEAM), 1, centre, frame, radius, radius, radius, sin2_half
        half_u, half_v = 0.5 * emitter.profile.width, 0.5 * emitter.profile.height
        return int(BEAM), 0, centre, frame, half_u, half_v, 0.0, sin2_half
    if isinstance(emitter, scenes.Point):
        return int(POINT), 0, centre, frame, 0.0, 0.0, 0.0, 1.0
    if isinstance(emitter, scenes.Spot):
        sin2_half = np.sin(0.5 * np.radians(emitter.half_angle_deg)) ** 2
        return int(SPOT), 0, centre, axis_frame(emitter.direction), 0.0, 0.0, 0.0, sin2_half
    if isinstance(emitter, scenes.SphereLamp):
        return int(SPHERE_LAMP), 0, centre, frame, 0.0, 0.0, emitter.radius, 1.0
    frame = np.stack(emitter.frame())
    half_u, half_v = 0.5 * emitter.size[0], 0.5 * emitter.size[1]
    return int(RECTANGLE_LAMP), 0, centre, frame, half_u, half_v, 0.0, 1.0


def _find_targets(
    compiled: CompiledScene, emitter: Any, view: View | None
) -> list[tuple[float, Aim]]:
    """(share of photons, Target fields but the count); the lamp's own distribution first."""
    base = (int(AIM_BASE), np.zeros(3), np.eye(3), 0.0, 0.0, 0.0)
    if isinstance(emitter, scenes.Beam):
        return [(1.0, base)]
    # A spherical lamp draws cones from its centre: what its rays can hit is larger by its radius.
    margin = emitter.radius if isinstance(emitter, scenes.SphereLamp) else 0.0
    specular: list[Aim] = []
    receivers: list[tuple[float, Aim]] = []
    for prim, item in enumerate(compiled.scene.objects):
        if isinstance(item.shape, scenes.Plane):
            continue  # without end, so there is nothing to aim at
        if isinstance(item.material, scenes.Dielectric):
            specular.append(_cone(compiled, item.shape, margin))
        elif isinstance(item.material, scenes.Lambertian):
            weight = 1.0 if view is None else max(view.fraction(prim), SMALLEST_WEIGHT)
            if isinstance(item.shape, scenes.Rectangle):
                receivers.extend(_areas(compiled, item.shape, prim, weight, view))
            else:
                receivers.append((weight, _cone(compiled, item.shape, margin)))
    aims = [(SPECULAR_SHARE / len(specular), aim) for aim in specular]
    total = sum(weight for weight, _ in receivers)
    aims += [(RECEIVER_SHARE * weight / total, aim) for weight, aim in receivers]
    return [(1.0 - SPECULAR_SHARE - RECEIVER_SHARE, base), *aims]


def _cone(compiled: CompiledScene, shape: Any, margin: float) -> Aim:
    """The cone around a shape's bounding sphere."""
    centre, radius = shape.bounding_sphere()
    return int(AIM_CONE), compiled.to_local(centre), np.eye(3), 0.0, 0.0, radius + margin


def _areas(
    compiled: CompiledScene, shape: scenes.Rectangle, prim: int, weight: float, view: View | None
) -> list[tuple[float, Aim]]:
    """A rectangle, and the part of it that the camera sees if that is much smaller; each with its weight."""
    frame = np.stack(shape.frame())
    centre = compiled.to_local(shape.position)
    half = 0.5 * np.asarray(shape.size)
    whole: Aim = (int(AIM_AREA), centre, frame, half[0], half[1], 0.0)
    extent = None if view is None else view.extent(prim, frame)
    if extent is not None:
        middle = frame @ centre
        margin = VISIBLE_MARGIN * (extent[1] - extent[0])
        low = np.maximum((extent[0] - margin)[:2], middle[:2] - half)
        high = np.minimum((extent[1] + margin)[:2], middle[:2] + half)
        seen = 0.5 * (high - low)
        if np.all(seen > 0.0) and np.prod(seen) < VISIBLE_WORTH * np.prod(half):
            at = frame.T @ np.array([*(0.5 * (low + high)), middle[2]])
            part: Aim = (int(AIM_AREA), at, frame, seen[0], seen[1], 0.0)
            return [(weight * (1.0 - VISIBLE_SHARE), whole), (weight * VISIBLE_SHARE, part)]
    return [(weight, whole)]
