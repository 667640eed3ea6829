"""Direct light: what a receiver gets straight from a lamp, by a shadow ray.

Light that meets nothing between lamp and receiver needs no photon: the lamp's radiance, the
geometry and one ray to see whether the way is free give its irradiance without a kernel's bias,
and for a lamp without extent without noise. Whatever is in the way stops it, glass too: light
that has met glass belongs to the photons, and no light is counted twice.

Reference:
    Jensen (1996), "Global illumination using photon maps", §4.1: direct light by ray tracing.
"""

import functools

import warp as wp

from sim.features import Features
from sim.image.connections import make_connection, make_distant_connection
from sim.image.sight import make_sight_struct
from sim.optics.absorption import absorbed_fraction
from sim.photons.lamp_structs import DISTANT, POINT, SPOT, make_lamp_structs
from sim.sampling.counter import hash64
from sim.sampling.kronecker import r2_point
from sim.scene_structs import make_scene_structs
from sim.transport import make_transport

__all__ = ["make_direct_light"]

CLEARANCE = 1.0 - 1e-6
"""A shadow ray ends this part of its way to the lamp, so that what the lamp lies on is no shade."""

ENVIRONMENT_RAYS = wp.constant(4)
"""Shadow rays to light from all around, for one to a lamp."""


@functools.cache
def make_direct_light(precision: str, features: Features) -> object:
    """Device function `direct_irradiance(scene, lamps, row, met, sight)` [W m⁻²].

    The irradiance from emitter `row` on the side of the receiver that `met` shows, the mean over
    the sight's shadow rays.
    """
    structs, lamp_structs = make_scene_structs(precision), make_lamp_structs(precision)
    real, scene_type, interaction_type = structs.real, structs.Scene, structs.Interaction
    lamps_type = lamp_structs.Lamps
    sight_type = make_sight_struct(precision)
    connect = make_connection(precision, features)
    connect_distant = make_distant_connection(precision)
    transport = make_transport(precision, features)
    intersect, leaving_ray = transport.intersect, transport.leaving_ray

    @wp.func
    def direct_irradiance(
        scene: scene_type, lamps: lamps_type, row: int, met: interaction_type, sight: sight_type,
    ):
        emitter = lamps.emitters[row]
        key = hash64(sight.lamp_key, wp.uint64(row))
        rays = int(sight.shadow_rays)
        if emitter.kind == POINT or emitter.kind == SPOT:
            rays = int(1)
        if wp.static(features.distant_lamps):
            if emitter.kind == DISTANT and emitter.sin2_half >= real(1.0):
                rays *= ENVIRONMENT_RAYS
        total = real(0.0)
        k = int(0)
        while k < rays:
            index = wp.uint32(sight.sample * rays + k)
            u0, u1 = r2_point(key, index, total)
            way, distance, irradiance = connect(lamps, emitter, met.point, u0, u1)
            irradiance *= -wp.dot(way, met.normal)
            if wp.static(features.distant_lamps):
                if emitter.kind == DISTANT:
                    way, irradiance = connect_distant(emitter, met.normal, u0, u1)
                    distance = real(wp.inf)
            if irradiance > real(0.0):
                hit = intersect(scene, leaving_ray(met, -way))
                if hit.prim < 0 or hit.t >= distance * real(CLEARANCE):
                    if wp.static(features.absorption):
                        irradiance -= irradiance * absorbed_fraction(met.alpha, distance)
                    total += irradiance
            k += 1
        return total / real(rays)

    return direct_irradiance
