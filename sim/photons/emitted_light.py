"""How the light of a lamp vibrates as it leaves."""

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

import scenes
from sim.device_arrays import struct_array
from sim.features import Features
from sim.photons.lamp_structs import make_lamp_structs
from sim.polarised_light import make_light

__all__ = ["compile_vibrations", "make_emitted_light"]

_UPRIGHT = scenes.Polarisation(degree=0.0)


@functools.cache
def make_emitted_light(precision: str, features: Features) -> object:
    """Device function `emitted_light(lamps, emitter, direction)`: light and its frame."""
    structs = make_lamp_structs(precision)
    vec3, lamps_type = structs.vec3, structs.Lamps
    mode = features.light_of("photons")
    carried = make_light(precision, mode, polarisers=features.polarisers)
    start, natural = carried.start, carried.natural

    @wp.func
    def natural_light(lamps: lamps_type, emitter: int, direction: vec3):
        return natural(direction)

    @wp.func
    def emitted_light(lamps: lamps_type, emitter: int, direction: vec3):
        own = lamps.vibrations[emitter]
        return start(own.light, own.up, direction)

    return emitted_light if mode == "stokes" else natural_light


def compile_vibrations(emitters: Sequence[Any], precision: str, device: str) -> Any:
    """A device array of Vibration, one an emitter.

    Args:
        emitters: of a scene, those that shine.
        precision: of the numbers.
        device: where they live.
    """
    rows = []
    for emitter in emitters:
        light = emitter.polarisation or _UPRIGHT
        up = light.reference(emitter.axis) if emitter.axis is not None else light.up
        rows.append((light.stokes(), np.array([0.0, 1.0, 0.0]) if up is None else np.array(up)))
    return struct_array(make_lamp_structs(precision).Vibration, rows, device)
