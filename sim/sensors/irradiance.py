"""What an irradiance sensor has measured."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.atomic_file import write_whole
from sim.sensors.origin import measured_text
from spectra.observer import observer
from spectra.srgb import xyz_to_linear_srgb
from spectra.units import LUMINOUS_EFFICACY_LM_W

if TYPE_CHECKING:
    from scenes import IrradianceSensor
    from sim.sensors.origin import Origin

__all__ = ["IrradianceReading"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class IrradianceReading:
    """Spectral irradiance on the cells of a rectangle or a disk.

    Cells are in rows from the top down and columns from left to right, as who looks at the front
    sees them with the shape's `up` on top. A cell's value is the mean over the part of it that
    lies in the shape; outside it is 0, and `areas` are.

    Attributes:
        sensor: What measured.
        spectral_irradiance: Means over cells and bands [W m⁻² nm⁻¹], (rows, columns, bands).
        standard_error: One standard deviation of each, from the scatter of the passes, same
            shape; NaN from a single pass.
        irradiance: All bands together [W m⁻²], (rows, columns).
        irradiance_error: One standard deviation of it: bands vary together, so it is not made of
            theirs.
        flux: Through the whole sensor [W].
        flux_error: One standard deviation of it.
        edges_nm: Band edges [nm], (bands + 1,).
        x: Edges of the columns along the width, from the centre [m], (columns + 1,).
        y: Edges of the rows along the height, from the centre [m], (rows + 1,), decreasing.
        areas: Of the cells [m²], (rows, columns).
        media: Names of the media that the sensor lies in; several if it reaches into several.
        passes: Replicates.
        origin: What it takes to measure it again.
    """

    sensor: IrradianceSensor
    spectral_irradiance: FloatArray
    standard_error: FloatArray
    irradiance: FloatArray
    irradiance_error: FloatArray
    flux: float
    flux_error: float
    edges_nm: FloatArray
    x: FloatArray
    y: FloatArray
    areas: FloatArray
    media: tuple[str, ...]
    passes: int
    origin: Origin

    @property
    def name(self) -> str:
        """The sensor's name."""
        return self.sensor.name

    @property
    def summary(self) -> str:
        """What was measured, in a line."""
        rows, columns, bands = self.spectral_irradiance.shape
        measured = measured_text(self.flux, self.flux_error, self.media)
        return f"{columns} × {rows} cells, {bands} bands; {measured}"

    @property
    def wavelengths_nm(self) -> FloatArray:
        """Band centres [nm], (bands,)."""
        return 0.5 * (self.edges_nm[:-1] + self.edges_nm[1:])

    @cached_property
    def xyz(self) -> FloatArray:
        """CIE XYZ of the film's observer, (rows, columns, 3); Y is the illuminance [lx]."""
        return observer(self.origin.scene.film.observer).xyz(
            self.spectral_irradiance, self.edges_nm
        )

    @property
    def illuminance(self) -> FloatArray:
        """Illuminance [lx], (rows, columns)."""
        lux: FloatArray = self.xyz[..., 1]
        return lux

    @cached_property
    def linear_rgb(self) -> FloatArray:
        """Linear sRGB, unclipped, (rows, columns, 3); white of 683 lx is (1, 1, 1)."""
        return xyz_to_linear_srgb(self.xyz / LUMINOUS_EFFICACY_LM_W)

    def save_exr(self, path: str | os.PathLike[str]) -> None:
        """Write the irradiance and its standard error as a spectral EXR.

        Args:
            path: The file; an existing one is replaced, and stays whole if writing fails.

        Raises:
            OutputError: The file cannot be written.
        """
        from sim.sensors.sensor_files import irradiance_exr

        write_whole(path, irradiance_exr(self))

    def save_npz(self, path: str | os.PathLike[str]) -> None:
        """Write every array of the reading, in float64, and what made it.

        Args:
            path: The file; an existing one is replaced, and stays whole if writing fails.

        Raises:
            OutputError: The file cannot be written.
        """
        from sim.sensors.sensor_files import irradiance_npz

        write_whole(path, irradiance_npz(self))
