"""Polarised light on its way: what surfaces make of it, and what it carries from one to the next.

Three ways to follow light, of which kernels are compiled for one (`Features.light_of`): "averaged"
takes the mean of s and p at every surface, as if light were natural each time; "s-p" carries the
share q of s over p, which is all there is to know while all planes of incidence are one; "stokes"
carries (q, u, v) and its frame. The last two share one pattern:

    met = interact(…)                                         # with the surface's matrix
    light, frame = turn(scene, met, direction, light, frame)  # into the plane of incidence
    reflectance, absorbed = judge(met, light)                 # as this light finds them
    light = send(met, light, refracts)                        # of the branch that is followed

Conventions and formulas: `sim.optics.polarisation`.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.features import LightMode
from sim.optics.polarisation import (
    apply_surface,
    frame_across,
    share_of_flux,
    turn_frame,
)
from sim.scene_structs import make_scene_structs

__all__ = ["make_light"]


@functools.cache
def make_light(
    precision: str, mode: LightMode, *, polarisers: bool, towards_eye: bool = False
) -> SimpleNamespace:
    """Types and device functions of light that is followed as "s-p" or as "stokes".

    Args:
        precision: of the vectors.
        mode: "s-p" or "stokes".
        polarisers: whether the scene may have any.
        towards_eye: whether paths run from the eye against the light: then what is carried is
            the row of the eye's sensitivities.

    Returns:
        A namespace with the types `Light` and `Frame`, and the device functions
        `start(stokes, up, direction)`, `natural(direction)` and
        `turn(scene, met, direction, light, frame)`, all returning light and frame,
        `judge(met, light)`, the reflectance and the absorbed part as this light finds them, and
        `send(met, light, refracts)`, the light behind.
    """
    structs = make_scene_structs(precision)
    real, interaction_type = structs.real, structs.Interaction
    one_number = wp.types.vector(length=1, dtype=real)
    light_type = structs.vec3 if mode == "stokes" else one_number
    frame_type = structs.vec3 if mode == "stokes" else one_number

    @wp.func
    def judge(met: interaction_type, light: light_type):
        kept = share_of_flux(light[0], met.matrix[0], met.matrix[1])
        reflectance = kept
        absorbed = met.absorbed
        if met.opaque == 1:
            reflectance = real(1.0)
            absorbed += (real(1.0) - absorbed) * (real(1.0) - kept)
        if wp.static(polarisers):
            if met.filters == 1:
                reflectance = real(0.0)
                absorbed += (real(1.0) - absorbed) * kept
        return reflectance, absorbed

    if mode == "stokes":
        functions = _make_stokes(precision, polarisers, towards_eye)
    else:
        functions = _make_shares(precision)
    start, vec3 = functions.start, structs.vec3

    @wp.func
    def natural(direction: vec3):
        return start(vec3(), vec3(real(0.0), real(1.0), real(0.0)), direction)

    return SimpleNamespace(
        Light=light_type, Frame=frame_type, natural=natural, judge=judge, **vars(functions)
    )


def _make_stokes(precision: str, polarisers: bool, towards_eye: bool) -> SimpleNamespace:
    """`start`, `turn` and `send` of Stokes vectors."""
    structs = make_scene_structs(precision)
    real, vec3, scene_type = structs.real, structs.vec3, structs.Scene
    interaction_type = structs.Interaction
    sign = -1.0 if towards_eye else 1.0

    @wp.func
    def start(stokes: vec3, up: vec3, direction: vec3):
        return stokes, frame_across(direction, up)

    @wp.func
    def turn(
        scene: scene_type, met: interaction_type, direction: vec3, light: vec3, frame: vec3
    ):
        across = met.normal
        if wp.static(polarisers):
            if met.filters == 1:
                across = scene.absorbing_axes[met.prim]
        return turn_frame(light, frame, direction, across)

    @wp.func
    def send(met: interaction_type, light: vec3, refracts: int):
        if refracts == 1:
            return apply_surface(
                light, real(1.0) - met.matrix[0], -met.matrix[1], met.together, real(0.0)
            )
        return apply_surface(
            light, met.matrix[0], met.matrix[1], met.matrix[2], real(sign) * met.matrix[3]
        )

    return SimpleNamespace(start=start, turn=turn, send=send)


def _make_shares(precision: str) -> SimpleNamespace:
    """`start`, `turn` and `send` of the share q alone: the plane of incidence stays as it is."""
    structs = make_scene_structs(precision)
    real, vec3, scene_type = structs.real, structs.vec3, structs.Scene
    interaction_type = structs.Interaction
    one_number = wp.types.vector(length=1, dtype=real)

    @wp.func
    def start(stokes: vec3, up: vec3, direction: vec3):
        # Natural light: polarised lamps and polarisers are refused, see `sim.features.plan`.
        return one_number(real(0.0)), one_number(real(0.0))

    @wp.func
    def turn(
        scene: scene_type, met: interaction_type, direction: vec3, light: one_number,
        frame: one_number,
    ):
        return light, frame

    @wp.func
    def send(met: interaction_type, light: one_number, refracts: int):
        mean = met.matrix[0]
        half = met.matrix[1]
        if refracts == 1:
            mean = real(1.0) - mean
            half = -half
        share = mean + half * light[0]
        over = real(0.0)
        if share > real(0.0):
            over = real(1.0) / share
        return one_number((half + mean * light[0]) * over)

    return SimpleNamespace(start=start, turn=turn, send=send)
