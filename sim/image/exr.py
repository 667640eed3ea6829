"""Rendered pictures as spectral EXR files; the layout is in `sim.image.exr_layout`."""

from __future__ import annotations

import dataclasses
import io
import json
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.errors import CapacityError
from sim.image.exr_layout import (
    ACCURACY_CHANNELS,
    ATTRIBUTE_PREFIX,
    BAND_MEANS,
    EMISSIVE_UNITS,
    LAYOUT_VERSION,
    error_channel,
    radiance_channel,
)
from sim.version import VERSION
from spectra.units import LUMINOUS_EFFICACY_LM_W

if TYPE_CHECKING:
    from sim.image.picture import Picture

__all__ = ["encode_channels", "encode_exr", "exr_plane", "rounded_to_8_bits"]

# x and y of red, green, blue and white (IEC 61966-2-1, table 1), as OpenEXR's own attribute.
_SRGB_CHROMATICITIES = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)


def encode_exr(picture: Picture, *, exposure_stops: float | None = None) -> memoryview:
    """Encode a picture as a spectral EXR.

    Channels: spectral radiance and, when there is one, its standard error in each band, and
    linear RGB with its negative values. White of luminance 683 cd/m² has RGB (1, 1, 1), which
    OpenEXR's attribute ``whiteLuminance`` says; ``EV`` is the exposure to develop it with.

    Args:
        picture: What was rendered.
        exposure_stops: Value of ``EV`` [stops]; None: the picture's own exposure.

    Returns:
        The content of the file.
    """
    stops = picture.exposure_stops if exposure_stops is None else exposure_stops
    return encode_channels(
        _channels(picture),
        _reproducing_attributes(picture),
        units=EMISSIVE_UNITS,
        exposure_stops=stops,
    )


def encode_channels(
    channels: dict[str, NDArray[np.float32]],
    attributes: dict[str, str],
    *,
    units: str,
    exposure_stops: float,
) -> memoryview:
    """Encode channels as a spectral EXR.

    Args:
        channels: Their pixels by name, as `exr_plane` gives them.
        attributes: What else the file says, by name.
        units: Unit of the spectral channels.
        exposure_stops: Value of ``EV`` [stops].

    Returns:
        The content of the file.
    """
    import OpenEXR

    header = {
        # Lossless, and known to every reader. On spectra with noise it takes 60 % of the time of
        # ZIP, and 85 % of the room.
        "compression": OpenEXR.PIZ_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "spectralLayoutVersion": LAYOUT_VERSION,
        "emissiveUnits": units,
        "EV": float(exposure_stops),
        "whiteLuminance": LUMINOUS_EFFICACY_LM_W,
        "chromaticities": _SRGB_CHROMATICITIES,
        **attributes,
    }
    # Into memory: on a full disk the library raises nothing and leaves an empty file.
    buffer = io.BytesIO()
    with OpenEXR.File(header, channels) as file:
        file.write(buffer)
    return buffer.getbuffer()


def _channels(picture: Picture) -> dict[str, NDArray[np.float32]]:
    channels = {name: exr_plane(picture.linear_rgb[..., i]) for i, name in enumerate("RGB")}
    has_error = not np.isnan(picture.standard_error).all()
    for band, wavelength_nm in enumerate(picture.wavelengths_nm.tolist()):
        channels[radiance_channel(wavelength_nm)] = exr_plane(picture.spectral_radiance[..., band])
        if has_error:
            error = exr_plane(picture.standard_error[..., band])
            channels[error_channel(wavelength_nm)] = rounded_to_8_bits(error)
    if has_error:
        for name, channel in ACCURACY_CHANNELS.items():
            channels[channel] = rounded_to_8_bits(exr_plane(getattr(picture.accuracy, name)))
    return channels


def exr_plane(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """One channel, contiguous: OpenEXR writes wrong pixels from other arrays, silently.

    Raises:
        CapacityError: a value is beyond the numbers of the file, which are float32.
    """
    largest = float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))
    if largest > float(np.finfo(np.float32).max):
        raise CapacityError(f"a value of {largest:.3g} does not fit into an EXR file: at most 3e38")
    return np.ascontiguousarray(values, dtype=np.float32)


def rounded_to_8_bits(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Round the significand to 8 bits, within 0.4 %: plenty for an error bar, half the size."""
    half_a_step, kept = np.uint32(0x8000), np.uint32(0xFFFF0000)
    return ((values.view(np.uint32) + half_a_step) & kept).view(np.float32)


def _reproducing_attributes(picture: Picture) -> dict[str, str]:
    """What it takes to render the file again, and what the numbers in it mean."""
    film = picture.scene.film
    attributes = {
        "version": VERSION,
        "scene": picture.scene.source_text,
        "scene_name": picture.scene.source_name,
        "settings": json.dumps(picture.settings.reproducing()),
        "seed": str(picture.settings.seed),  # As text: OpenEXR's integers have 32 bits.
        "accuracy": json.dumps(picture.accuracy.summary()),
        "stopping": picture.stopping,
        "energy": json.dumps(dataclasses.asdict(picture.energy)),
        "features": json.dumps(picture.features),
        "bands": BAND_MEANS,
        "band_edges_nm": json.dumps(picture.edges_nm.tolist()),
        "observer": film.observer,
        "gamut": film.gamut,
    }
    return {ATTRIBUTE_PREFIX + name: text for name, text in attributes.items()}
