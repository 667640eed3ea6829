"""Rays that follow one chain of refractions and reflections, to where it meets the receiver.

Each advances by the same `interact` step as photons and camera paths. Where photons split at a
surface, a chain takes one branch and carries its share of the flux, 1 − R or R, as the light is
polarised there: the contributions of all chains add up to what photons deposit. Light starts
natural.
"""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.errors import SettingsError
from sim.features import Features
from sim.geometry.flat import intersect_plane, plane_coordinates
from sim.optics.absorption import absorbed_fraction
from sim.polarised_light import make_light
from sim.scene_data import CompiledScene
from sim.study.receiver_bins import ReceiverBins
from sim.transport import EVENT_BOUNDARY, EVENT_PASS, make_transport

__all__ = ["Chain", "Landings", "make_chain", "trace_chain"]

FloatArray = npt.NDArray[np.float64]

BRANCHES = ("refract", "reflect")


@dataclass(frozen=True, eq=False)
class Chain:
    """Which branch is taken at each surface on the way to which receiver.

    Attributes:
        compiled: the scene, in float64.
        data: the device-side Chain struct.
    """

    compiled: CompiledScene
    data: Any


@dataclass(frozen=True, eq=False)
class Landings:
    """Where rays meet the receiver's plane.

    Attributes:
        place: (n, 2) along the receiver's u and v, from its centre [m]; 0 off the chain.
        transmittance: (n,) share of a ray's flux that arrives; 0 off the chain.
        signature: (n,) uint64, the same for rays that met the same faces; 0 off the chain.
    """

    place: FloatArray
    transmittance: FloatArray
    signature: npt.NDArray[np.uint64]


@functools.cache
def make_chain_structs(precision: str, features: Features) -> SimpleNamespace:
    """The struct Chain and, as `transport`, the device functions of a light step."""
    transport = make_transport(precision, features)
    real, vec3, mat33 = transport.real, transport.vec3, transport.mat33

    @wp.struct
    class ChainData:
        receiver: int
        centre: vec3
        frame: mat33  # rows: u, v, normal
        reflects: wp.array(dtype=int)
        length: int  # surfaces to cross; −1: as many as there are, all refracting
        limit: int

    return SimpleNamespace(Chain=ChainData, transport=transport, real=real, vec3=vec3)


@functools.cache
def make_trace_chain(precision: str, features: Features) -> Any:
    """Kernel that follows one ray a thread along the chain."""
    structs = make_chain_structs(precision, features)
    transport, chain_type = structs.transport, structs.Chain
    real, vec3, interact = structs.real, structs.vec3, transport.interact
    scene_type, ray_type, met_type = transport.Scene, transport.Ray, transport.Interaction
    free_ray = transport.free_ray
    media_indices = transport.media_indices
    losses = features.absorption or features.finishes or features.polarisers
    mode = features.light_of("photons")
    polarised = mode != "averaged"
    carried = make_light(precision, mode, polarisers=features.polarisers)
    natural, turn, judge, send = carried.natural, carried.turn, carried.judge, carried.send

    @wp.func
    def land(chain: chain_type, ray: ray_type, met: met_type):
        """Whether the ray meets the receiver's plane before anything else, where, how far away."""
        local = ray.origin - chain.centre
        t = intersect_plane(local, ray.direction, chain.frame[2])
        free = met.prim < 0 or met.prim == chain.receiver or t < met.t
        u, v = plane_coordinates(local + ray.direction * t, chain.frame)
        return t >= real(0.0) and free, u, v, t

    @wp.kernel(module="unique", enable_backward=False)
    def follow_chain(
        scene: scene_type,
        chain: chain_type,
        wavelengths_nm: wp.array(dtype=real),
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        out_landings: wp.array(dtype=vec3),
        out_signatures: wp.array(dtype=wp.uint64),
    ):
        i = wp.tid()
        ray = free_ray(origins[i], directions[i])
        indices = media_indices(scene, wavelengths_nm[i])
        share = real(1.0)
        if wp.static(polarised):
            light, frame = natural(ray.direction)
        signature = wp.uint64(14695981039346656037)
        step = int(0)
        while step <= chain.limit:
            met = interact(scene, ray, indices)
            boundary = met.event == EVENT_BOUNDARY
            passes = met.event == EVENT_PASS
            if step == chain.length or (chain.length < 0 and not boundary and not passes):
                landed, u, v, distance = land(chain, ray, met)
                if landed:
                    if wp.static(features.absorption):
                        share -= share * absorbed_fraction(met.alpha, distance)
                    out_landings[i] = vec3(u, v, share)
                    out_signatures[i] = signature
                break
            if not boundary and not passes:
                break
            if wp.static(polarised):
                if boundary:
                    light, frame = turn(scene, met, ray.direction, light, frame)
                    reflectance, lost = judge(met, light)
                    met.reflectance = reflectance
                    met.absorbed = lost
            if wp.static(losses):
                share -= share * met.absorbed
            reflects = int(0)
            if chain.length >= 0:
                reflects = chain.reflects[step]
            if passes:
                if reflects == 1:
                    break
            elif reflects == 1 or met.opaque == 1:
                share *= met.reflectance
                ray.direction = met.reflected
                if wp.static(polarised):
                    light = send(met, light, 0)
            elif met.total == 1:
                break
            else:
                share *= real(1.0) - met.reflectance
                ray.direction = met.refracted
                if wp.static(polarised):
                    light = send(met, light, 1)
            ray.origin = met.point
            ray.prim = met.prim
            ray.face = met.face
            ray.prim2 = met.prim2
            ray.face2 = met.face2
            # FNV-1a over the faces met (Fowler, Noll & Vo): 64 bits tell sequences apart.
            signature = (signature ^ wp.uint64(met.prim + 1)) * wp.uint64(1099511628211)
            signature = (signature ^ wp.uint64(met.part + 1)) * wp.uint64(1099511628211)
            step += 1

    return follow_chain


def make_chain(
    compiled: CompiledScene,
    receiver: ReceiverBins,
    branches: Sequence[str] | None,
    *,
    max_interactions: int = 256,
) -> Chain:
    """Lay a chain out for the device.

    Args:
        compiled: the scene, in float64.
        receiver: where the chain ends.
        branches: "refract" or "reflect" at each surface on the way, and no surface more; one that
            is hidden inside a solid counts as refracting, as with photons; an empty sequence is
            direct light. None refracts at every surface there is.
        max_interactions: surfaces to follow a ray through where `branches` is None.

    Raises:
        SettingsError: the scene is not in float64, or a branch is neither of the two.
    """
    if compiled.precision != "float64":
        raise SettingsError("precision", compiled.precision, "'float64' for a reference")
    if isinstance(branches, str) or not all(one in BRANCHES for one in branches or ()):
        raise SettingsError("branches", branches, "a sequence of 'refract' or 'reflect', or None")
    reflects = np.array([one == "reflect" for one in branches or ()], dtype=np.int32)
    data = make_chain_structs(compiled.precision, compiled.features).Chain()
    data.receiver = receiver.prim
    data.centre = compiled.to_local(receiver.centre)
    data.frame = receiver.frame
    data.reflects = wp.array(reflects, dtype=int, device=compiled.device)
    data.length = -1 if branches is None else len(reflects)
    data.limit = max_interactions if branches is None else len(reflects)
    return Chain(compiled, data)


def trace_chain(
    chain: Chain, origins: FloatArray, directions: FloatArray, wavelengths_nm: FloatArray
) -> Landings:
    """Follow rays: (n, 3) world positions [m] and unit directions, (n,) wavelengths."""
    compiled, device = chain.compiled, chain.compiled.device
    vec3 = compiled.structs.vec3
    landings = wp.zeros(len(origins), dtype=vec3, device=device)
    signatures = wp.zeros(len(origins), dtype=wp.uint64, device=device)
    wp.launch(
        make_trace_chain(compiled.precision, compiled.features),
        dim=len(origins),
        inputs=[
            compiled.data,
            chain.data,
            wp.array(wavelengths_nm, dtype=compiled.structs.real, device=device),
            wp.array(compiled.to_local(origins), dtype=vec3, device=device),
            wp.array(directions, dtype=vec3, device=device),
        ],
        outputs=[landings, signatures],
        device=device,
    )
    landed = landings.numpy()
    return Landings(landed[:, :2], landed[:, 2], signatures.numpy())
