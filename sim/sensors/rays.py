"""The rays that have crossed a sensor."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.atomic_file import write_whole
from sim.sensors.frames import sensor_frame
from sim.sensors.origin import measured_text

if TYPE_CHECKING:
    from scenes import RaySensor
    from sim.sensors.origin import Origin

__all__ = ["FarField", "RaysReading", "Spot"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]


class FarField(NamedTuple):
    """Radiant intensity in rings about the sensor's axis [W/sr], and one standard deviation."""

    intensity: FloatArray
    standard_error: FloatArray


class Spot(NamedTuple):
    """Where rays cross, weighed by their flux: centre (2,) and root mean square radius [m]."""

    centre: FloatArray
    rms_radius: float


@dataclass(frozen=True, kw_only=True, eq=False)
class RaysReading:
    """Rays that cross a rectangle or a disk, one row a ray, in the order of emission.

    Each row stands for its flux: all together carry, but for noise, what crosses the sensor. If
    more rays crossed than could be kept, those left are an even sample, and carry the flux of the
    others too.

    Attributes:
        sensor: What kept them.
        position: Where they cross, in the world [m], (n, 3).
        direction: Where they go, unit, (n, 3).
        wavelength_nm: (n,).
        flux: (n,) [W].
        pass_index: Which pass each is of, (n,); passes are independent replicates.
        refractions, reflections, bounces: What each met before, (n,): boundaries it was refracted
            at, specular reflections, and diffuse ones.
        dispersed: Whether it met a boundary that parts light by its wavelength, (n,).
        emitter: Which of the scene's emitters it is from, (n,).
        crossings: How many rays crossed.
        kept: With which probability each was kept.
        total_flux: Through the sensor [W], of all that crossed.
        total_flux_error: One standard deviation of it; NaN from a single pass.
        media: Names of the media that the sensor lies in; several if it reaches into several.
        passes: Replicates.
        origin: What it takes to measure it again.
    """

    sensor: RaySensor
    position: FloatArray
    direction: FloatArray
    wavelength_nm: FloatArray
    flux: FloatArray
    pass_index: IntArray
    refractions: IntArray
    reflections: IntArray
    bounces: IntArray
    dispersed: NDArray[np.bool_]
    emitter: IntArray
    crossings: int
    kept: float
    total_flux: float
    total_flux_error: float
    media: tuple[str, ...]
    passes: int
    origin: Origin

    def __len__(self) -> int:
        return len(self.flux)

    @property
    def name(self) -> str:
        """The sensor's name."""
        return self.sensor.name

    @property
    def summary(self) -> str:
        """What was measured, in a line."""
        thinned = "" if self.kept == 1.0 else f" of {self.crossings}"
        measured = measured_text(self.total_flux, self.total_flux_error, self.media)
        return f"{len(self)} rays{thinned}; {measured}"

    @cached_property
    def place(self) -> FloatArray:
        """Where the rays cross, along the width and along the height [m], (n, 2)."""
        offset = self.position - np.asarray(self.sensor.shape.position)
        place: FloatArray = offset @ sensor_frame(self.sensor)[:2].T
        return place

    @cached_property
    def cosines(self) -> FloatArray:
        """Cosines of the rays with the width, the height and the normal, (n, 3)."""
        cosines: FloatArray = self.direction @ sensor_frame(self.sensor).T
        return cosines

    def spot(self, select: ArrayLike | None = None) -> Spot:
        """Centre and root mean square radius of the spot diagram, weighed by flux.

        Args:
            select: Mask or indices of the rays that count, (n,); None: all.

        Returns:
            NaN throughout where no ray counts.
        """
        mine = slice(None) if select is None else np.asarray(select)
        place, flux = self.place[mine], self.flux[mine]
        if flux.sum() <= 0.0:
            return Spot(np.full(2, np.nan), float("nan"))
        centre = np.average(place, axis=0, weights=flux)
        square = np.average(np.sum((place - centre) ** 2, axis=1), weights=flux)
        return Spot(centre, float(np.sqrt(square)))

    def far_field(self, edges: ArrayLike) -> FarField:
        """Radiant intensity against the angle from the sensor's axis, either way.

        I = Φ/Ω with Ω = 2π (cos θ₀ − cos θ₁) for the ring between two edges.

        Args:
            edges: Increasing angles [rad], 0 to π/2, (rings + 1,).
        """
        edges = np.asarray(edges, dtype=np.float64)
        # sin²(θ/2) keeps the digits of small angles, where 1 − cos θ loses them.
        sines = np.hypot(self.cosines[:, 0], self.cosines[:, 1])
        angles = np.arctan2(sines, np.abs(self.cosines[:, 2]))
        halves = np.sin(0.5 * edges) ** 2
        solid_angles = 4.0 * np.pi * np.diff(halves)
        numbers = np.arange(self.passes + 1) - 0.5
        flux = np.histogram2d(
            self.pass_index, angles, bins=(numbers, edges), weights=self.flux * self.passes
        )[0]
        error = np.full(len(solid_angles), np.nan)
        if self.passes > 1:
            error = flux.std(axis=0, ddof=1) / np.sqrt(self.passes)
        return FarField(flux.mean(axis=0) / solid_angles, error / solid_angles)

    def save_npz(self, path: str | os.PathLike[str]) -> None:
        """Write every array of the reading, and what made it.

        Args:
            path: The file; an existing one is replaced, and stays whole if writing fails.

        Raises:
            OutputError: The file cannot be written.
        """
        from sim.sensors.sensor_files import rays_npz

        write_whole(path, rays_npz(self))
