"""A camera path and all its branches: through glass and mirrors to the lamps and the receivers.

Radiance divided by the square of the index is constant along a ray. What a path carries is the
throughput of that basic radiance, which losses and splits alone make smaller, so that roulette
takes a branch in glass for what it is worth outside. Where light is found, (η_o/η_i)² of the media
at the camera and there makes radiance of it.

Reference:
    Veach (1997), *Robust Monte Carlo Methods for Light Transport Simulation*, §5.2: radiance
    across a boundary.
"""

import functools

import warp as wp

from sim.features import Features
from sim.image.gather import make_gather
from sim.image.sight import ALL_BANDS, make_lights_struct, make_sight_struct
from sim.image.visible_lamps import make_see_lamps
from sim.polarised_light import make_light
from sim.sampling.roulette import choose_branches, play_roulette
from sim.transport import EVENT_BOUNDARY, EVENT_DEPOSIT, EVENT_PASS, make_transport

__all__ = ["make_follow_sight"]

MAX_INTERACTIONS = wp.constant(48)
"""Surfaces that a camera path and its branches may meet."""

BRANCH_THRESHOLD = wp.constant(0.03)
"""A side branch of less throughput plays Russian roulette for this much."""

LAST_PART = wp.constant(0.1)
"""A stronger branch plays roulette for this part of a side branch's threshold."""

STACK_SIZE = wp.constant(8)


@functools.cache
def make_follow_sight(precision: str, features: Features) -> object:
    """Device function `follow(scene, lights, camera_ray, sight, sample)`."""
    transport = make_transport(precision, features)
    real, interact = transport.real, transport.interact
    media_indices, split = transport.media_indices, transport.split
    scene_type, ray_type = transport.Scene, transport.Ray
    lights_type, sight_type = make_lights_struct(precision), make_sight_struct(precision)
    leaving_ray = transport.leaving_ray
    losses = features.absorption or features.finishes or features.polarisers
    mode = features.light_of("camera")
    polarised = mode != "averaged"
    carried = make_light(precision, mode, polarisers=features.polarisers, towards_eye=True)
    light_type, frame_type, natural = carried.Light, carried.Frame, carried.natural
    turn, judge, send = carried.turn, carried.judge, carried.send
    gather = make_gather(precision, features)
    see_lamps = make_see_lamps(precision, features)

    @wp.func
    def follow(
        scene: scene_type,
        lights: lights_type,
        camera_ray: ray_type,
        sight: sight_type,
        sample: wp.array2d(dtype=wp.float64),
    ):
        """Add one path's radiance to the sample; 1 if a branch met a dispersive surface."""
        indices = media_indices(scene, sight.wavelength_nm)
        stack_ray = wp.zeros(shape=(8,), dtype=ray_type)
        stack_throughput = wp.zeros(shape=(8,), dtype=real)
        stack_dispersed = wp.zeros(shape=(8,), dtype=int)
        # What the eye is sensitive to, of the light that comes against the path: all alike.
        light, frame = natural(camera_ray.direction)
        if wp.static(polarised):
            stack_light = wp.zeros(shape=(8,), dtype=light_type)
            stack_frame = wp.zeros(shape=(8,), dtype=frame_type)
        depth = int(0)
        alive = bool(True)
        ray = camera_ray
        throughput = sight.weight
        threshold = sight.weight * real(BRANCH_THRESHOLD)
        dispersed = int(0)
        met_dispersive = int(0)
        eta_camera = real(1.0)
        step = int(0)
        while step < MAX_INTERACTIONS:
            if not alive:
                if depth == 0:
                    break
                depth -= 1
                # Field by field: see `interact`.
                pending = stack_ray[depth]
                ray.origin = pending.origin
                ray.direction = pending.direction
                ray.prim = pending.prim
                ray.face = pending.face
                ray.prim2 = pending.prim2
                ray.face2 = pending.face2
                if wp.static(polarised):
                    light = stack_light[depth]
                    frame = stack_frame[depth]
                throughput = stack_throughput[depth]
                dispersed = stack_dispersed[depth]
                alive = bool(True)
            met = interact(scene, ray, indices)
            if step == 0:
                eta_camera = indices[met.medium]
            if wp.static(features.visible_lamps):
                parted = int(dispersed)
                if wp.static(features.absorption):
                    parted = parted | scene.media[met.medium].tints
                if (sight.band == ALL_BANDS) != (parted == 1):
                    eta = eta_camera / indices[met.medium]
                    scale = throughput * eta * eta / lights.receivers.band_width_nm
                    see_lamps(lights, ray, met, sight, scale, light, frame, sample)
            if wp.static(polarised):
                if met.event == EVENT_BOUNDARY:
                    light, frame = turn(scene, met, ray.direction, light, frame)
                    reflectance, lost = judge(met, light)
                    met.reflectance = reflectance
                    met.absorbed = lost
            if wp.static(losses):
                throughput -= throughput * met.absorbed
            if met.dispersive == 1:
                met_dispersive = 1
                dispersed = 1
            if met.dispersive == 1 and sight.band == ALL_BANDS:
                alive = False
            elif met.event == EVENT_PASS:
                ray.origin = met.point
                ray.prim = met.prim
                ray.face = met.face
                ray.prim2 = met.prim2
                ray.face2 = met.face2
            elif met.event == EVENT_BOUNDARY:
                stronger, weaker, refracts = split(met)
                side = throughput * met.reflectance
                main = throughput - side
                if refracts == 0:
                    main = throughput * met.reflectance
                    side = throughput - main
                ray.origin = met.point
                ray.direction = stronger
                ray.prim = met.prim
                ray.face = met.face
                ray.prim2 = met.prim2
                ray.face2 = met.face2
                throughput, side, swapped = choose_branches(
                    main, side, threshold, depth < STACK_SIZE, sight.key, wp.uint64(step)
                )
                if swapped:
                    ray.direction = weaker
                    refracts = 1 - refracts
                if wp.static(polarised):
                    if side > real(0.0):
                        stack_light[depth] = send(met, light, 1 - refracts)
                        stack_frame[depth] = frame
                    light = send(met, light, refracts)
                if side > real(0.0):
                    stack_ray[depth] = leaving_ray(met, weaker)
                    stack_throughput[depth] = side
                    stack_dispersed[depth] = dispersed
                    depth += 1
                # The stronger branch plays as well: reflected again and again, ever fainter, it
                # would use up the interactions that the branches behind it need.
                throughput = play_roulette(
                    throughput, real(LAST_PART) * threshold, sight.key + wp.uint64(1),
                    wp.uint64(step),
                )
                alive = throughput > real(0.0)
            else:
                alive = False
                if met.event == EVENT_DEPOSIT and (sight.band == ALL_BANDS or dispersed == 1):
                    eta = eta_camera / indices[met.medium]
                    scale = throughput * eta * eta / lights.receivers.band_width_nm
                    gather(scene, lights, met, sight, scale, sample)
            step += 1
        return met_dispersive

    return follow
