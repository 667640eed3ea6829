"""A photon and all its branches: through glass to the diffuse surfaces, where they are stored.

At a boundary the stronger of the two branches is followed with its weight and the other is put
on a stack while its flux matters; below a threshold either plays Russian roulette for the
threshold's flux. Nothing is averaged away, and the books keep what roulette adds or takes.

References:
    Jensen (1996), "Global illumination using photon maps", §2.1: photon tracing.
"""

import functools

import warp as wp

from sim.features import Features
from sim.optics.dispersion import tabulated_index
from sim.photons.energy import BOOK_COLUMNS
from sim.photons.photon_structs import (
    add_bounce,
    add_event,
    bounces_of,
    has_events,
    make_photon_structs,
    mark_dispersed,
    surface_key,
)
from sim.polarised_light import make_light
from sim.sampling.counter import hash64, to_unit
from sim.sampling.directions import sample_cosine_hemisphere, to_world
from sim.sampling.draws import BOUNCE, BOUNCE_ROULETTE, FAINT_BRANCH, SPLIT
from sim.sampling.roulette import choose_branches, play_roulette
from sim.sensors.crossing import make_record_crossings
from sim.transport import (
    EVENT_ABSORB,
    EVENT_BOUNDARY,
    EVENT_DEPOSIT,
    EVENT_PASS,
    make_transport,
)

__all__ = ["FLOWS", "make_follow"]

STACK_SIZE = wp.constant(8)

BOUNCE_THRESHOLD = wp.constant(0.25)
"""A photon reflected by a diffuse surface with less than this part of its flux plays roulette."""


FLOWS = wp.types.vector(length=len(BOOK_COLUMNS) - 1, dtype=wp.float64)
"""Flux deposited, absorbed, escaped and culled: the books' columns behind the first."""


@functools.cache
def make_follow(precision: str, features: Features) -> object:
    """Device function `follow(scene, job, ray, first, wavelength_nm, flux, draws, …)`."""
    transport = make_transport(precision, features)
    real, vec3, scatter = transport.real, transport.vec3, transport.scatter
    media_indices, split = transport.media_indices, transport.split
    absorption_of = transport.absorption_of
    scene_type, ray_type, hit_type = transport.Scene, transport.Ray, transport.Hit
    photon_structs = make_photon_structs(precision)
    photons_type, job_type = photon_structs.Photons, photon_structs.Job
    intersect, facet_toward = transport.intersect, transport.facet_toward
    record_crossings = make_record_crossings(precision)
    leaving_ray = transport.leaving_ray
    both_branches = features.method.branching == "weights"
    losses = features.absorption or features.finishes or features.polarisers
    mode = features.light_of("photons")
    polarised = mode != "averaged"
    carried = make_light(precision, mode, polarisers=features.polarisers)
    light_type, frame_type, turn = carried.Light, carried.Frame, carried.turn
    natural, judge, send = carried.natural, carried.judge, carried.send

    @wp.func
    def store(
        photons: photons_type, slot: int, point: vec3, direction: vec3, wavelength_nm: real,
        flux: real, surface: int, history: int, emitter: int,
    ):
        photons.position[slot] = point
        photons.direction[slot] = wp.vec3(
            wp.float32(direction[0]), wp.float32(direction[1]), wp.float32(direction[2])
        )
        photons.wavelength_nm[slot] = wp.float32(wavelength_nm)
        photons.flux[slot] = wp.float64(flux)
        photons.surface[slot] = surface
        photons.history[slot] = history
        photons.emitter[slot] = emitter

    @wp.func
    def diffuse_reflectance(scene: scene_type, finish: transport.Finish, wavelength_nm: real):
        return tabulated_index(
            scene.knots_nm, scene.cubics, finish.first, finish.count, wavelength_nm
        )

    @wp.func
    def bounce(normal: vec3, key: wp.uint64, like: real):
        """A direction off a Lambertian surface: as the cosine."""
        u0 = to_unit(hash64(key, wp.uint64(0)), like)
        u1 = to_unit(hash64(key, wp.uint64(1)), like)
        x, y, z = sample_cosine_hemisphere(u0, u1)
        return to_world(x, y, z, normal)

    @wp.func
    def follow(
        scene: scene_type, job: job_type, start_ray: ray_type, first: hit_type,
        wavelength_nm: real, start_flux: real, start_light: light_type, start_frame: frame_type,
        draws: wp.uint64, out_photons: photons_type, out_counts: wp.array2d(dtype=int),
    ):
        """Follow a photon of one wavelength, about to meet `first`, and all its branches.

        Returns FLOWS.
        """
        indices = media_indices(scene, wavelength_nm)
        deposited = real(0.0)
        absorbed = real(0.0)
        escaped = real(0.0)
        culled = real(0.0)
        ray = start_ray
        flux = start_flux
        threshold = flux * job.branch_threshold
        history = int(0)

        stack_ray = wp.zeros(shape=(8,), dtype=ray_type)
        stack_flux = wp.zeros(shape=(8,), dtype=real)
        stack_history = wp.zeros(shape=(8,), dtype=int)
        if wp.static(polarised):
            light = start_light
            frame = start_frame
            stack_light = wp.zeros(shape=(8,), dtype=light_type)
            stack_frame = wp.zeros(shape=(8,), dtype=frame_type)
        depth = int(0)
        alive = bool(True)
        hit = first
        step = int(0)
        while step < job.max_interactions:
            met = scatter(scene, ray, hit, indices)
            if wp.static(features.sensors):
                alpha = real(0.0)
                tints = int(0)
                if wp.static(features.absorption):
                    alpha = absorption_of(indices, met.medium)
                    tints = scene.media[met.medium].tints
                record_crossings(
                    job, ray, hit.t, alpha, wavelength_nm, flux, history, tints,
                    draws + wp.uint64(step), out_photons, out_counts,
                )
            history = mark_dispersed(history, met.dispersive)
            if wp.static(polarised):
                if met.event == EVENT_BOUNDARY:
                    light, frame = turn(scene, met, ray.direction, light, frame)
                    reflectance, lost_here = judge(met, light)
                    met.reflectance = reflectance
                    met.absorbed = lost_here
            if wp.static(losses):
                lost = flux * met.absorbed
                absorbed += lost
                flux -= lost
            if met.event == EVENT_BOUNDARY:
                stronger, weaker, refracts = split(met)
                side_flux = flux * met.reflectance
                if refracts == 0:
                    side_flux = flux - side_flux
                side_history = add_event(history, 1 - refracts)
                history = add_event(history, refracts)
                ray.origin = met.point
                ray.direction = stronger
                ray.prim = met.prim
                ray.face = met.face
                ray.prim2 = met.prim2
                ray.face2 = met.face2
                draw = draws + wp.uint64(step)
                before = flux
                room = depth < STACK_SIZE
                if wp.static(not both_branches):
                    room = False
                flux, side_flux, swapped = choose_branches(
                    flux - side_flux, side_flux, threshold, room, job.key + SPLIT, draw
                )
                if swapped:
                    ray.direction = weaker
                    history = side_history
                    refracts = 1 - refracts
                if wp.static(polarised):
                    if side_flux > real(0.0):
                        stack_light[depth] = send(met, light, 1 - refracts)
                        stack_frame[depth] = frame
                    light = send(met, light, refracts)
                if side_flux > real(0.0):
                    stack_ray[depth] = leaving_ray(met, weaker)
                    stack_flux[depth] = side_flux
                    stack_history[depth] = side_history
                    depth += 1
                # The stronger branch plays as well: a path reflected again and again, and ever
                # fainter, would use up the interactions that the branches behind it need.
                flux = play_roulette(flux, threshold, job.key + FAINT_BRANCH, draw)
                culled += before - flux - side_flux
                alive = flux > real(0.0)
            elif met.event == EVENT_PASS:
                # It is an event all the same: shadow rays stop here, so that the light behind is
                # the photons'.
                history = add_event(history, 1)
                ray.origin = met.point
                ray.prim = met.prim
                ray.face = met.face
                ray.prim2 = met.prim2
                ray.face2 = met.face2
                alive = flux > real(0.0)
            else:
                alive = False
                if met.event == EVENT_DEPOSIT:
                    if job.store_direct == 1 or has_events(history):
                        slot = wp.atomic_add(out_counts, job.range_row, 0, 1)
                        if slot < job.slot_count:
                            store(
                                out_photons, job.first_slot + slot, met.point, ray.direction,
                                wavelength_nm, flux, surface_key(met.prim, met.part, met.side),
                                history, job.emitter,
                            )
                    goes_on = real(0.0)
                    if wp.static(features.interreflection):
                        if bounces_of(history) < job.bounces:
                            finish = scene.finishes[scene.bodies[met.prim].finish]
                            goes_on = flux * diffuse_reflectance(scene, finish, wavelength_nm)
                            history = add_bounce(mark_dispersed(history, finish.varies))
                            draw = draws + wp.uint64(step)
                            way = bounce(met.normal, hash64(job.key + BOUNCE, draw), flux)
                            if wp.static(features.meshes):
                                # About a smooth normal, but never through the facet.
                                facet = facet_toward(scene, met, ray.direction)
                                way -= facet * (real(2.0) * wp.min(wp.dot(way, facet), real(0.0)))
                            ray.direction = way
                            ray.origin = met.point
                            ray.prim = met.prim
                            ray.face = met.face
                            ray.prim2 = met.prim2
                            ray.face2 = met.face2
                            if wp.static(polarised):
                                light, frame = natural(ray.direction)
                    deposited += flux - goes_on
                    if wp.static(features.interreflection):
                        flux = play_roulette(
                            goes_on, start_flux * real(BOUNCE_THRESHOLD), job.key + BOUNCE_ROULETTE,
                            draws + wp.uint64(step),
                        )
                        culled += goes_on - flux
                        alive = flux > real(0.0)
                elif met.event == EVENT_ABSORB:
                    absorbed += flux
                else:
                    escaped += flux
            if not alive:
                if depth == 0:
                    break
                depth -= 1
                # Field by field: see `scatter`.
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
                flux = stack_flux[depth]
                history = stack_history[depth]
                alive = True
            hit = intersect(scene, ray)
            step += 1

        if alive:
            culled += flux
        for k in range(depth):
            culled += stack_flux[k]
        return FLOWS(
            wp.float64(deposited), wp.float64(absorbed), wp.float64(escaped), wp.float64(culled)
        )

    return follow
