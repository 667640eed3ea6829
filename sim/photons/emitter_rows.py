"""The scene's emitters as rows of the device's Emitter struct: their geometry and radiance."""

from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from scenes.emitters import DistantEmitter, Glowing
from sim.photons.lamp_structs import BEAM, DISTANT, POINT, RECTANGLE_LAMP, SPHERE_LAMP, SPOT
from sim.precision import precision_types
from sim.scene_data import CompiledScene, axis_frame

__all__ = ["emitter_row", "full_flux", "mask_functions"]
FloatArray = npt.NDArray[np.float64]


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
    if isinstance(emitter, Glowing):
        of_all = flux / full_flux(compiled, emitter)
        row |= {"visible": int(emitter.visible), "radiance": emitter.full_radiance * of_all}
    if isinstance(emitter, DistantEmitter):
        row |= {"kind": int(DISTANT), "frame": axis_frame(emitter.axis)}
        row |= {"radius": compiled.bounding_radius, "sin2_half": _sin2_half(emitter.cone_deg)}
        return row
    row |= {"centre": compiled.to_local(emitter.position)}
    if isinstance(emitter, scenes.Beam):
        row |= _beam(emitter)
    elif isinstance(emitter, scenes.Spot):
        row |= {"kind": int(SPOT), "frame": axis_frame(emitter.direction)}
        row["sin2_half"] = _sin2_half(emitter.half_angle_deg)
    elif isinstance(emitter, scenes.SphereLamp):
        radius = max(emitter.radius, _least_radius(compiled, row["centre"]))
        row |= {"kind": int(SPHERE_LAMP), "radius": radius}
        row["radiance"] *= (emitter.radius / radius) ** 2
    elif isinstance(emitter, scenes.RectangleLamp):
        width, height = emitter.size
        row |= {"kind": int(RECTANGLE_LAMP), "frame": np.stack(emitter.frame())}
        row |= {"half_u": 0.5 * width, "half_v": 0.5 * height}
    return row


def _least_radius(compiled: CompiledScene, centre: FloatArray) -> float:
    """Of a ball whose points the kernels can tell from its centre, to 0.4 % of it [m].

    A smaller lamp is given this size and the radiance that leaves its flux what it is.
    """
    eps = float(np.finfo(precision_types(compiled.precision).dtype).eps)
    return 256.0 * eps * float(np.linalg.norm(centre))


def full_flux(compiled: CompiledScene, emitter: Any) -> float:
    """Flux over the whole spectrum; of a distant emitter, into a sphere around the scene [W]."""
    if isinstance(emitter, DistantEmitter):
        return emitter.flux_through(compiled.bounding_radius)
    return float(emitter.flux)


def mask_functions(emitter: Any) -> list[FloatArray]:
    """Distribution functions over a mask's columns, then over each column's cells, bottom up.

    Empty for an emitter without a mask.
    """
    masked = emitter.profile if isinstance(emitter, scenes.Beam) else emitter
    mask = getattr(masked, "mask", None)
    if mask is None:
        return []
    columns = mask.cells()[::-1].T
    sums = columns.sum(axis=1)
    # No light goes to a dark column: its cells may be spread anyhow.
    inside = np.where(sums[:, None] > 0.0, columns, 1.0)
    return [_cumulated(sums), *(_cumulated(one) for one in inside)]


def _cumulated(weights: FloatArray) -> FloatArray:
    """0, the running sums of `weights` in parts of the whole, and at the end exactly 1."""
    sums = np.concatenate([[0.0], np.cumsum(weights)])
    return np.asarray(sums / sums[-1])


def _beam(beam: scenes.Beam) -> dict[str, Any]:
    row: dict[str, Any] = {"kind": int(BEAM), "frame": np.stack(beam.frame())}
    row["sin2_half"] = _sin2_half(beam.divergence_deg)
    row["widening"] = np.tan(np.radians(beam.divergence_deg))
    if isinstance(beam.profile, scenes.RoundProfile):
        radius = beam.profile.radius
        return row | {"round": 1, "half_u": radius, "half_v": radius, "radius": radius}
    return row | {"half_u": 0.5 * beam.profile.width, "half_v": 0.5 * beam.profile.height}


def _sin2_half(angle_deg: float) -> float:
    """sin² of half an angle."""
    return float(np.sin(0.5 * np.radians(angle_deg)) ** 2)
