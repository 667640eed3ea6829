"""How the light of a lamp vibrates as it leaves."""

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
import warp as wp

import scenes
from sim.device_arrays import struct_array
from sim.features import Features
from sim.optics.polarisation import frame_across, seen_part
from sim.photons.lamp_structs import make_lamp_structs
from sim.polarised_light import make_light

__all__ = ["compile_vibrations", "make_emitted_light", "make_seen_light"]

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


@functools.cache
def make_seen_light(precision: str, features: Features) -> object:
    """Device function `seen_light(lamps, emitter, direction, eye, frame)`.

    What the eye of a camera path, which carries `eye` in `frame`, sees of the lamp's light over
    what it would see of natural light; 1 but where camera paths carry Stokes vectors.
    """
    structs = make_lamp_structs(precision)
    real, vec3, lamps_type = structs.real, structs.vec3, structs.Lamps
    mode = features.light_of("camera")
    carried = make_light(precision, mode, polarisers=features.polarisers, towards_eye=True)
    light_type, frame_type = carried.Light, carried.Frame

    @wp.func
    def all_light(
        lamps: lamps_type, emitter: int, direction: vec3, eye: light_type, frame: frame_type
    ):
        return real(1.0)

    @wp.func
    def seen_light(
        lamps: lamps_type, emitter: int, direction: vec3, eye: light_type, frame: frame_type
    ):
        own = lamps.vibrations[emitter]
        return seen_part(eye, frame, own.light, frame_across(-direction, own.up), direction)

    return seen_light if mode == "stokes" else all_light


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
