"""The scene's emitters as rows of the device's Emitter struct: their geometry and radiance."""

from typing import Any

import numpy as np

import scenes
from scenes.emitters import DistantEmitter
from sim.photons.lamp_structs import BEAM, DISTANT, POINT, RECTANGLE_LAMP, SPHERE_LAMP, SPOT
from sim.scene_data import CompiledScene, axis_frame

__all__ = ["emitter_row"]


def emitter_row(compiled: CompiledScene, emitter: Any, flux: float) -> dict[str, Any]:
    """Fields of an Emitter, by name, but for where its targets and its spectrum are.

    Args:
        compiled: the scene.
        emitter: one of its emitters.
        flux: that it has inside the film's wavelengths [W].
    """
    row: dict[str, Any] = {
        "kind": int(POINT), "round": 0, "centre": np.zeros(3), "frame": np.eye(3),
        "half_u": 0.0, "half_v": 0.0, "radius": 0.0, "sin2_half": 1.0, "widening": 0.0,
        "visible": 0, "flux": flux, "radiance": 0.0,
    }  # fmt: skip
    if isinstance(emitter, DistantEmitter):
        return row | _distant(emitter, compiled.bounding_radius, flux)
    row |= {"centre": compiled.to_local(emitter.position)}
    if isinstance(emitter, scenes.Beam):
        row |= _beam(emitter)
    elif isinstance(emitter, scenes.Spot):
        row |= {"kind": int(SPOT), "frame": axis_frame(emitter.direction)}
        row["sin2_half"] = _sin2_half(emitter.half_angle_deg)
    elif isinstance(emitter, scenes.SphereLamp):
        row |= {"kind": int(SPHERE_LAMP), "radius": emitter.radius}
        # A Lambertian surface of area A has Φ = π A L, here with A = 4π R².
        row |= {"visible": int(emitter.visible)}
        row |= {"radiance": flux / (2.0 * np.pi * emitter.radius) ** 2}
    elif isinstance(emitter, scenes.RectangleLamp):
        width, height = emitter.size
        row |= {"kind": int(RECTANGLE_LAMP), "frame": np.stack(emitter.frame())}
        row |= {"half_u": 0.5 * width, "half_v": 0.5 * height, "visible": int(emitter.visible)}
        row |= {"radiance": flux / (np.pi * width * height)}
    return row


def _beam(beam: scenes.Beam) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": int(BEAM), "frame": np.stack(beam.frame())}
    row["sin2_half"] = _sin2_half(beam.divergence_deg)
    row["widening"] = np.tan(np.radians(beam.divergence_deg))
    if isinstance(beam.profile, scenes.RoundProfile):
        radius = beam.profile.radius
        return row | {"round": 1, "half_u": radius, "half_v": radius, "radius": radius}
    return row | {"half_u": 0.5 * beam.profile.width, "half_v": 0.5 * beam.profile.height}


def _distant(emitter: DistantEmitter, radius: float, flux: float) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": int(DISTANT), "frame": axis_frame(emitter.axis)}
    row |= {"radius": radius, "sin2_half": _sin2_half(emitter.cone_deg)}
    row |= {"visible": int(emitter.visible)}
    return row | {"radiance": flux / emitter.flux_through(radius) * emitter.full_radiance}


def _sin2_half(angle_deg: float) -> float:
    """sin² of half an angle."""
    return float(np.sin(0.5 * np.radians(angle_deg)) ** 2)
