"""Camera paths: from a pixel through glass and mirrors to the receivers, and the gather there.

A pixel is sampled in two parts that add up. First a path for all bands at once, which ends where
it meets a dispersive surface. If it met one, a path for each band follows, with a wavelength
drawn from the band, whose branches count only behind a dispersive surface. Bands are so never
mixed behind a prism, and a pixel that sees no glass costs one path, not one for each band.

Pixels behind glass are dear, so their bands take turns: with S turns a pass follows every S-th
band, shifted from pixel to pixel, and S passes make one complete sample of the film.

Radiance divided by the square of the index is constant along a ray. What a path carries is the
throughput of that basic radiance, which losses and splits alone make smaller, so that roulette
takes a branch in glass for what it is worth outside. Where light is found, (η_o/η_i)² of the media
at the camera and there makes radiance of it.

References:
    Jensen (1996), "Global illumination using photon maps", §4.
    Veach (1997), *Robust Monte Carlo Methods for Light Transport Simulation*, §5.2: radiance
    across a boundary.
    Welford (1962), Technometrics 4, 419: running mean and sum of squared deviations.
"""

import functools
from typing import Any

import warp as wp

from sim.features import Features
from sim.image.camera import make_camera_functions, make_camera_struct
from sim.image.gather import make_gather
from sim.image.sight import ALL_BANDS, make_lights_struct, make_sight_struct
from sim.image.visible_lamps import make_see_lamps
from sim.polarised_light import make_light
from sim.sampling.counter import hash64
from sim.sampling.kronecker import r1_point, r2_point
from sim.sampling.roulette import choose_branches, play_roulette
from sim.transport import EVENT_BOUNDARY, EVENT_DEPOSIT, EVENT_PASS, make_transport

__all__ = ["make_film_struct", "make_render_camera"]

MAX_INTERACTIONS = wp.constant(48)
"""Surfaces that a camera path and its branches may meet."""

BRANCH_THRESHOLD = wp.constant(0.03)
"""A side branch of less throughput plays Russian roulette for this much."""

LAST_PART = wp.constant(0.1)
"""A stronger branch plays roulette for this part of a side branch's threshold."""

STACK_SIZE = wp.constant(8)

SHADOW_RAYS = wp.constant(4)
"""To each lamp, of a path for all bands; the many paths for single bands cast one each."""


@functools.cache
def make_film_struct() -> Any:
    """Struct Film: running mean and squared deviations of each pixel and band, one row a pixel.

    `sample` holds the sample that the passes of one round of turns add up to, as
    `sim.image.gather` fills it; `turn` of `turns` is the pass within its `round`, `rounds_before`
    counts the complete ones. `tally` holds of each pixel the running mean and squared deviations of
    its luminance, of the part of it that is the gather's bias, and of the rest, in this order.
    """

    @wp.struct
    class Film:
        sample: wp.array2d(dtype=wp.float64)
        mean: wp.array2d(dtype=wp.float64)
        squares: wp.array2d(dtype=wp.float64)
        tally: wp.array2d(dtype=wp.float64)
        round: int
        turn: int
        turns: int
        rounds_before: int
        key: wp.uint64

    return Film


@functools.cache
def make_render_camera(precision: str, features: Features) -> Any:
    """Kernel `render_camera(start, scene, camera, lights, film)`."""
    transport = make_transport(precision, features)
    real, interact = transport.real, transport.interact
    media_indices, split = transport.media_indices, transport.split
    scene_type, ray_type = transport.Scene, transport.Ray
    lights_type, sight_type = make_lights_struct(precision), make_sight_struct(precision)
    camera_type, film_type = make_camera_struct(precision), make_film_struct()
    free_ray, leaving_ray = transport.free_ray, transport.leaving_ray
    seeing = make_camera_functions(precision, features)
    look_through, place_in_pixel = seeing.look_through, seeing.place_in_pixel
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

    @wp.func
    def sample_pixel(
        scene: scene_type, camera: camera_type, lights: lights_type, film: film_type, pixel: int
    ):
        """Add one sample of a pixel to its row: a path for all bands, and paths for its turn's."""
        receivers = lights.receivers
        # Spread over the turns of a round, and drawn anew for the next one: rounds are replicates.
        key = hash64(hash64(film.key, wp.uint64(pixel)), wp.uint64(film.round))
        turn = wp.uint32(film.turn)
        ux, uy = r2_point(key, turn, receivers.band_width_nm)
        x, y = place_in_pixel(camera, ux, uy)
        inside_band = r1_point(key + wp.uint64(1), turn, receivers.band_width_nm)
        u0, u1 = r2_point(key + wp.uint64(4), turn, receivers.band_width_nm)
        origin, direction = look_through(
            camera, real(pixel % camera.width) + x, real(pixel // camera.width) + y, u0, u1
        )
        ray = free_ray(origin, direction)
        sight = sight_type()
        sight.row = pixel
        sight.band = ALL_BANDS
        sight.weight = real(1.0) / real(film.turns)
        half_range_nm = real(0.5) * receivers.band_width_nm * real(receivers.bands)
        sight.wavelength_nm = receivers.first_edge_nm + half_range_nm
        sight.key = hash64(key + wp.uint64(2), wp.uint64(film.turn))
        sight.lamp_key = key + wp.uint64(3)
        sight.sample = film.turn
        sight.shadow_rays = SHADOW_RAYS
        meets_dispersion = follow(scene, lights, ray, sight, film.sample)
        if wp.static(features.dispersion):
            if meets_dispersion == 1:
                sight.deal = int(sight.key >> wp.uint64(40))
                sight.weight = real(1.0)
                sight.shadow_rays = 1
                # Where the round starts is each pixel's own: turns leave no stripes or checks.
                sight.band = (int(key >> wp.uint64(40)) + film.turn) % film.turns
                while sight.band < receivers.bands:
                    offset_nm = receivers.band_width_nm * (real(sight.band) + inside_band)
                    sight.wavelength_nm = receivers.first_edge_nm + offset_nm
                    follow(scene, lights, ray, sight, film.sample)
                    sight.band += film.turns

    @wp.func
    def add_value(
        mean: wp.array2d(dtype=wp.float64), squares: wp.array2d(dtype=wp.float64), row: int,
        mean_column: int, squares_column: int, value: wp.float64, before: int,
    ):
        """Update a running mean and its sum of squared deviations (Welford 1962)."""
        delta = value - mean[row, mean_column]
        now = mean[row, mean_column] + delta / wp.float64(before + 1)
        mean[row, mean_column] = now
        squares[row, squares_column] += delta * (value - now)

    @wp.kernel(module="unique", enable_backward=False)
    def render_camera(
        start: int, scene: scene_type, camera: camera_type, lights: lights_type, film: film_type
    ):
        pixel = start + wp.tid()
        bands = lights.receivers.bands
        if film.turn == 0:
            column = int(0)
            while column <= bands + lights.receivers.lamps:
                film.sample[pixel, column] = wp.float64(0.0)
                column += 1
        sample_pixel(scene, camera, lights, film, pixel)
        if film.turn == film.turns - 1:
            luminance = wp.float64(0.0)
            band = int(0)
            while band < bands:
                value = film.sample[pixel, band]
                luminance += value * wp.float64(lights.receivers.luminance[band])
                add_value(film.mean, film.squares, pixel, band, band, value, film.rounds_before)
                band += 1
            bias = film.sample[pixel, bands + lights.receivers.lamps]
            add_value(film.tally, film.tally, pixel, 0, 1, luminance, film.rounds_before)
            add_value(film.tally, film.tally, pixel, 2, 3, bias, film.rounds_before)
            add_value(film.tally, film.tally, pixel, 4, 5, luminance - bias, film.rounds_before)

    return render_camera
