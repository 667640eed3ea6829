"""The result of a rendering: spectral radiance, how sure it is, and what it was made from."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.atomic_file import write_whole
from sim.image.exposure import automatic_stops, lamp_level, scene_stops
from sim.image.exr import encode_exr
from sim.image.png import encode_png
from spectra.observer import observer
from spectra.srgb import encode_srgb, map_to_gamut, xyz_to_linear_srgb
from spectra.units import LUMINOUS_EFFICACY_LM_W

if TYPE_CHECKING:
    from scenes import Scene
    from sim.image.accuracy import Accuracy
    from sim.photons.energy import EnergyBooks
    from sim.sensors.readings import Readings
    from sim.settings import ResolvedSettings

__all__ = ["Picture"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """A rendered picture.

    Attributes:
        spectral_radiance: Band means [W m⁻² sr⁻¹ nm⁻¹], shape (height, width, bands), row 0 on
            top.
        standard_error: One standard deviation of each estimate, same unit and shape; NaN where
            there is none (a single pass).
        edges_nm: Band edges [nm], shape (bands + 1,), increasing.
        accuracy: How far the luminance may be off, noise and bias apart.
        energy: Where the emitted flux went [W].
        scene: The scene that was rendered.
        settings: The settings that render it again, resolved: with the passes that there were.
        sensors: What the scene's sensors have measured, by their names.
        stopping: Why there were no more: "all passes", "target error" or "time budget".
        timings: Seconds that each stage took.
        features: What the kernels could do and could not, and what that can cost, ready for JSON.
    """

    spectral_radiance: NDArray[np.float64]
    standard_error: NDArray[np.float64]
    accuracy: Accuracy
    edges_nm: NDArray[np.float64]
    energy: EnergyBooks
    scene: Scene
    settings: ResolvedSettings
    sensors: Readings = field(default_factory=dict)
    stopping: str = "all passes"
    timings: dict[str, float] = field(default_factory=dict)
    features: dict[str, Any] = field(default_factory=dict)

    @property
    def wavelengths_nm(self) -> NDArray[np.float64]:
        """Band centres [nm], shape (bands,)."""
        return 0.5 * (self.edges_nm[:-1] + self.edges_nm[1:])

    @cached_property
    def xyz(self) -> NDArray[np.float64]:
        """CIE XYZ of the film's observer, Y in cd/m², shape (height, width, 3)."""
        return observer(self.scene.film.observer).xyz(self.spectral_radiance, self.edges_nm)

    @cached_property
    def linear_rgb(self) -> NDArray[np.float64]:
        """Linear sRGB, unclipped, shape (height, width, 3).

        White of luminance 683 cd/m² is (1, 1, 1). Colours outside the sRGB gamut have negative
        channels.
        """
        return xyz_to_linear_srgb(self.xyz / LUMINOUS_EFFICACY_LM_W)

    @cached_property
    def exposure_stops(self) -> float:
        """The film's or the camera's exposure [stops]; automatic when the scene leaves it open.

        At e stops a white of 683 · 2⁻ᵉ cd/m² is developed to full white.
        """
        stops = scene_stops(self.scene)
        if stops is None:
            return automatic_stops(self.linear_rgb, lamp_level(self.scene))
        return stops

    @cached_property
    def srgb(self) -> NDArray[np.uint8]:
        """The developed picture at `exposure_stops`, 8-bit sRGB, shape (height, width, 3)."""
        return self.develop()

    def develop(self, *, exposure_stops: float | None = None) -> NDArray[np.uint8]:
        """Expose, map into the sRGB gamut as the film says, and encode.

        Args:
            exposure_stops: Exposure [stops]; None: the picture's own.

        Returns:
            8-bit sRGB, shape (height, width, 3).
        """
        stops = self.exposure_stops if exposure_stops is None else exposure_stops
        exposed = self.linear_rgb * 2.0**stops
        return encode_srgb(map_to_gamut(exposed, method=self.scene.film.gamut))

    def save_exr(
        self, path: str | os.PathLike[str], *, exposure_stops: float | None = None
    ) -> None:
        """Write the spectral radiance, its standard error and all that reproduces it.

        Args:
            path: The file; an existing one is replaced, and stays whole if writing fails.
            exposure_stops: Exposure that the file recommends [stops]; None: the picture's own.

        Raises:
            OutputError: The file cannot be written.
        """
        write_whole(path, encode_exr(self, exposure_stops=exposure_stops))

    def save_png(
        self, path: str | os.PathLike[str], *, exposure_stops: float | None = None
    ) -> None:
        """Write the developed picture as 8-bit sRGB.

        Args:
            path: The file; an existing one is replaced, and stays whole if writing fails.
            exposure_stops: Exposure [stops]; None: the picture's own.

        Raises:
            OutputError: The file cannot be written.
        """
        write_whole(path, encode_png(self.develop(exposure_stops=exposure_stops)))
