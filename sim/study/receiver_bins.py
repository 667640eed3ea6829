"""Bins on a flat receiver: where they lie, and what photons put into them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from sim.errors import SettingsError

__all__ = ["ReceiverBins", "find_object", "lay_bins"]

FloatArray = npt.NDArray[np.float64]

Window = tuple[tuple[float, float], tuple[float, float]]
"""((u low, u high), (v low, v high)) [m], from the receiver's centre."""


@dataclass(frozen=True, eq=False)
class ReceiverBins:
    """A regular grid of bins on a rectangle; [j, i] counts along v, then along u.

    Attributes:
        prim: row of the receiver among the scene's objects.
        centre: (3,) of the rectangle [m].
        frame: (3, 3), rows u (along the width), v (along the height), normal.
        low: (2,) where the first bin begins, along u and v from the centre [m].
        bin_size: (2,) of one bin along u and v [m].
        rows: bins along v.
        columns: bins along u.
    """

    prim: int
    centre: FloatArray
    frame: FloatArray
    low: FloatArray
    bin_size: FloatArray
    rows: int
    columns: int

    @property
    def bin_area(self) -> float:
        """Area of a bin [m²]."""
        return float(np.prod(self.bin_size))

    def to_bins(self, place: FloatArray) -> FloatArray:
        """Places (..., 2) along u and v [m] in units of bins."""
        in_bins: FloatArray = (place - self.low) / self.bin_size
        return in_bins

    def bin_centres(self) -> FloatArray:
        """World positions of the bins' centres, (rows, columns, 3) [m]."""
        u = self.low[0] + (np.arange(self.columns) + 0.5) * self.bin_size[0]
        v = self.low[1] + (np.arange(self.rows) + 0.5) * self.bin_size[1]
        along = u[None, :, None] * self.frame[0] + v[:, None, None] * self.frame[1]
        centres: FloatArray = self.centre + along
        return centres

    def irradiance(self, flux: FloatArray, edges_nm: npt.ArrayLike) -> FloatArray:
        """Band means [W m⁻² nm⁻¹] of the flux (rows, columns, bands) in each bin and band [W]."""
        spectral: FloatArray = flux / (self.bin_area * np.diff(np.asarray(edges_nm)))
        return spectral

    def bin_photons(
        self, photons: Mapping[str, npt.NDArray[Any]], edges_nm: npt.ArrayLike
    ) -> FloatArray:
        """Sum photons into the bins.

        Args:
            photons: arrays of equal length as from `PhotonBatch.to_numpy`: position (n, 3),
                wavelength_nm, flux and object are used. Both sides of the receiver count.
            edges_nm: (bands + 1,) band edges [nm].

        Returns:
            (rows, columns, bands) spectral irradiance, band means [W m⁻² nm⁻¹].
        """
        met = photons["object"] == self.prim
        place = (photons["position"][met] - self.centre) @ self.frame[:2].T
        sample = np.column_stack([self.to_bins(place)[:, ::-1], photons["wavelength_nm"][met]])
        edges = np.arange(self.rows + 1), np.arange(self.columns + 1), np.asarray(edges_nm)
        flux = np.histogramdd(sample, edges, weights=photons["flux"][met])[0]
        return self.irradiance(flux, edges_nm)


def find_object(scene: scenes.Scene, field: str, name: str) -> int:
    """Row of the object called `name`; `field` is what asks for it, for the message.

    Raises:
        SettingsError: there is none.
    """
    names = [item.name for item in scene.objects]
    if name not in names:
        raise SettingsError(field, name, f"an object of the scene: {', '.join(names)}")
    return names.index(name)


def lay_bins(
    scene: scenes.Scene, name: str, *, rows: int, columns: int, window: Window | None = None
) -> ReceiverBins:
    """Lay bins over a rectangle of the scene, or over a part of it.

    Args:
        scene: a scene.
        name: of the object, which is a rectangle.
        rows: bins along its height.
        columns: bins along its width.
        window: the part that is covered; None covers all of it.

    Raises:
        SettingsError: there is no such rectangle, or the window is empty or larger than it.
    """
    prim = find_object(scene, "receiver", name)
    shape = scene.objects[prim].shape
    if not isinstance(shape, scenes.Rectangle):
        raise SettingsError("receiver", name, f"a rectangle, not a {shape.type}")
    if rows < 1 or columns < 1:
        raise SettingsError("rows, columns", (rows, columns), "whole numbers from 1")
    half = 0.5 * np.asarray(shape.size)
    spans = np.stack([-half, half], axis=1) if window is None else np.asarray(window, dtype=float)
    low, high = spans[:, 0], spans[:, 1]
    # A window given as the rectangle's own edges may be off by rounding.
    if not (np.all(low < high) and np.all(np.abs(spans) <= half[:, None] * (1.0 + 1e-9))):
        raise SettingsError("window", window, f"low < high, within ±{half[0]:g}, ±{half[1]:g} m")
    return ReceiverBins(
        prim=prim,
        centre=np.asarray(shape.position, dtype=np.float64),
        frame=np.stack(shape.frame()),
        low=low,
        bin_size=(high - low) / np.array([columns, rows]),
        rows=rows,
        columns=columns,
    )
