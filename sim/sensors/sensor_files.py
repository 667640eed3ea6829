"""Readings of sensors as files: spectral EXR and NumPy archives.

The EXR has the layout of pictures (`sim.image.exr_layout`), with the unit of irradiance: what is
radiance there is irradiance here.
"""

from __future__ import annotations

import dataclasses
import io
import json
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.image.exr import encode_channels, exr_plane, rounded_to_8_bits
from sim.image.exr_layout import (
    ATTRIBUTE_PREFIX,
    IRRADIANCE_BAND_MEANS,
    IRRADIANCE_UNITS,
    error_channel,
    radiance_channel,
)
from sim.version import VERSION

if TYPE_CHECKING:
    from sim.sensors.irradiance import IrradianceReading
    from sim.sensors.rays import RaysReading

__all__ = ["irradiance_exr", "irradiance_npz", "rays_npz"]


def irradiance_exr(reading: IrradianceReading) -> memoryview:
    """The content of a spectral EXR: irradiance, its standard error if there is one, linear RGB."""
    channels = {name: exr_plane(reading.linear_rgb[..., i]) for i, name in enumerate("RGB")}
    for band, wavelength_nm in enumerate(reading.wavelengths_nm.tolist()):
        values = exr_plane(reading.spectral_irradiance[..., band])
        channels[radiance_channel(wavelength_nm)] = values
        if reading.passes > 1:
            error = exr_plane(reading.standard_error[..., band])
            channels[error_channel(wavelength_nm)] = rounded_to_8_bits(error)
    texts = {
        **_origin_texts(reading),
        "bands": IRRADIANCE_BAND_MEANS,
        "band_edges_nm": json.dumps(reading.edges_nm.tolist()),
        # The energy books are in the film's bands.
        "film_edges_nm": json.dumps(list(reading.origin.scene.film.edges_nm)),
        "observer": reading.origin.scene.film.observer,
    }
    return encode_channels(
        channels,
        {ATTRIBUTE_PREFIX + name: text for name, text in texts.items()},
        units=IRRADIANCE_UNITS,
        exposure_stops=0.0,
    )


def irradiance_npz(reading: IrradianceReading) -> memoryview:
    """The content of a NumPy archive with every array of the reading."""
    names = (
        "spectral_irradiance", "standard_error", "irradiance", "irradiance_error", "flux",
        "flux_error", "edges_nm", "x", "y", "areas",
    )  # fmt: skip
    return _archive(reading, names)


def rays_npz(reading: RaysReading) -> memoryview:
    """The content of a NumPy archive with every array of the reading."""
    names = (
        "position", "direction", "place", "cosines", "wavelength_nm", "flux", "pass_index",
        "refractions", "reflections", "bounces", "dispersed", "emitter", "crossings", "kept",
        "total_flux", "total_flux_error",
    )  # fmt: skip
    return _archive(reading, names)


def _archive(reading: IrradianceReading | RaysReading, names: tuple[str, ...]) -> memoryview:
    arrays: dict[str, Any] = {name: np.asarray(getattr(reading, name)) for name in names}
    arrays.update(_origin_texts(reading))
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getbuffer()


def _origin_texts(reading: IrradianceReading | RaysReading) -> dict[str, str]:
    """What it takes to measure again, and what was measured where."""
    origin = reading.origin
    return {
        "version": VERSION,
        "sensor": reading.name,
        "sensor_table": reading.sensor.model_dump_json(exclude_none=True),
        "media": ", ".join(reading.media),
        "scene": origin.scene.source_text,
        "scene_name": origin.scene.source_name,
        "settings": json.dumps(origin.settings.reproducing()),
        "seed": str(origin.settings.seed),
        "energy": json.dumps(dataclasses.asdict(origin.energy)),
    }
