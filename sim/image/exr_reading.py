"""Spectral EXR files, ours and others', read back."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.file_content import require_file
from sim.errors import FileFormatError
from sim.image.exr_claims import refuse_bombs
from sim.image.exr_layout import (
    ACCURACY_CHANNELS,
    ATTRIBUTE_PREFIX,
    error_wavelength_nm,
    radiance_wavelength_nm,
)
from sim.native_output import silenced_native_output

__all__ = ["SpectralImage", "read_exr"]


@dataclass(frozen=True, kw_only=True, eq=False)
class SpectralImage:
    """What a spectral EXR holds.

    Attributes:
        path: The file.
        wavelengths_nm: Wavelength of each band [nm], shape (bands,), increasing.
        spectral_radiance: Shape (height, width, bands), row 0 on top, in the file's unit.
        standard_error: Same shape and unit; None if the file has none.
        linear_rgb: Shape (height, width, 3); None if the file has none.
        luminance_noise: Standard error of the luminance [cd/m²], shape (height, width); or None.
        luminance_bias: What the gather's blur adds to the luminance, as estimated; or None.
        attributes: The file's attributes that are text or numbers, by name.
        other_channels: Names of the channels that are none of the above.
    """

    path: str
    wavelengths_nm: NDArray[np.float64]
    spectral_radiance: NDArray[np.float32]
    standard_error: NDArray[np.float32] | None
    linear_rgb: NDArray[np.float32] | None
    luminance_noise: NDArray[np.float32] | None
    luminance_bias: NDArray[np.float32] | None
    attributes: dict[str, str | float | int]
    other_channels: tuple[str, ...]

    def attribute(self, name: str) -> str | None:
        """Text of Nephroid's own attribute `name` ("scene", "settings", "seed", …), or None."""
        value = self.attributes.get(ATTRIBUTE_PREFIX + name)
        return value if isinstance(value, str) else None


def read_exr(path: str | os.PathLike[str]) -> SpectralImage:
    """Read a spectral EXR in the layout of Fichet, Pacanowski and Wilkie (2021).

    Args:
        path: The file.

    Returns:
        Its bands in the order of their wavelengths, and its attributes.

    Raises:
        FileFormatError: It is no OpenEXR file, it is damaged or cut off, it claims more than it
            can hold, or it has no channels of spectral radiance.
        OSError: It cannot be opened.
    """
    path = os.fspath(path)
    header, pixels = _read_part(path)
    if len({plane.shape for plane in pixels.values()}) > 1:
        raise FileFormatError(path, "its channels differ in size")
    radiance = _layer(pixels, radiance_wavelength_nm)
    error = _layer(pixels, error_wavelength_nm)
    if not radiance:
        names = ", ".join(sorted(pixels)) or "none"
        raise FileFormatError(path, f"it has no spectral radiance; its channels: {names}")
    known = {*radiance.values(), *error.values(), *ACCURACY_CHANNELS.values()}
    has_rgb = {"R", "G", "B"} <= pixels.keys()
    if has_rgb:
        known |= {"R", "G", "B"}
    return SpectralImage(
        path=path,
        wavelengths_nm=np.array(list(radiance), dtype=np.float64),
        spectral_radiance=_stack(pixels, radiance.values()),
        standard_error=_stack(pixels, error.values()) if error.keys() == radiance.keys() else None,
        linear_rgb=_stack(pixels, "RGB") if has_rgb else None,
        luminance_noise=pixels.get(ACCURACY_CHANNELS["noise"]),
        luminance_bias=pixels.get(ACCURACY_CHANNELS["bias"]),
        attributes={k: v for k, v in header.items() if isinstance(v, str | float | int)},
        other_channels=tuple(sorted(pixels.keys() - known)),
    )


def _read_part(path: str) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Attributes and pixels of the first part of an OpenEXR file."""
    require_file(Path(path))
    refuse_bombs(path)
    import OpenEXR

    try:
        # The library reports damage by printing, and hands back a file without parts.
        with silenced_native_output():
            parts = OpenEXR.File(path, separate_channels=True).parts
    except (RuntimeError, ValueError) as error:
        raise FileFormatError(path, f"it is damaged or cut off ({error})") from error
    if not parts:
        raise FileFormatError(path, "it is damaged or cut off")
    return parts[0].header, {name: channel.pixels for name, channel in parts[0].channels.items()}


def _layer(
    pixels: Iterable[str], wavelength_of: Callable[[str], float | None]
) -> dict[float, str]:
    """Channel names by wavelength, in the order of the wavelengths, not of the names."""
    found = {wavelength_of(name): name for name in pixels}
    return dict(sorted((nm, name) for nm, name in found.items() if nm is not None))


def _stack(pixels: dict[str, NDArray[Any]], names: Iterable[str]) -> NDArray[np.float32]:
    return np.stack([pixels[name] for name in names], axis=-1).astype(np.float32, copy=False)
