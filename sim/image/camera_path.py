"""Camera paths: from a pixel through glass and mirrors to the receivers, and the gather there.

A pixel is sampled in two parts that add up. First a path for all bands at once, which ends where
it meets a dispersive surface. If it met one, a path for each band follows, with a wavelength
drawn from the band, whose branches count only behind a dispersive surface. Bands are so never
mixed behind a prism, and a pixel that sees no glass costs one path, not one for each band.

Pixels behind glass are dear, so their bands take turns: with S turns a pass follows every S-th
band, shifted from pixel to pixel, and S passes make one complete sample of the film.

Radiance divided by the square of the index is constant along a ray: a refraction multiplies the
throughput by (η_i/η_t)², seen along the camera ray.

References:
    Jensen (1996), "Global illumination using photon maps", §4.
    Veach (1997), *Robust Monte Carlo Methods for Light Transport Simulation*, §5.2: radiance
    across a boundary.
    Roberts (2018), "The unreasonable effectiveness of quasirandom sequences": the R2 sequence.
    Welford (1962), Technometrics 4, 419: running mean and sum of squared deviations.
"""

import functools
from typing import Any

import warp as wp

from sim.features import Features
from sim.image.camera import make_camera_functions, make_camera_struct
from sim.image.gather import make_gather
from sim.photons.photon_map import make_map_structs
from sim.photons.receivers import make_receiver_structs
from sim.sampling.counter import hash64, to_unit
from sim.sampling.roulette import play_roulette
from sim.transport import EVENT_BOUNDARY, EVENT_DEPOSIT, make_transport

__all__ = ["make_film_struct", "make_render_camera"]

MAX_INTERACTIONS = wp.constant(48)
"""Surfaces that a camera path and its branches may meet."""

BRANCH_THRESHOLD = wp.constant(0.1)
"""A side branch of less throughput plays Russian roulette for this much."""

STACK_SIZE = wp.constant(8)


@functools.cache
def make_film_struct() -> Any:
    """Struct Film: running mean and squared deviations of each pixel and band, one row a pixel.

    `sample` holds the sample that the passes of one round of turns add up to; `turn` of `turns`
    is the pass within the round, `rounds_before` counts complete ones.
    """

    @wp.struct
    class Film:
        sample: wp.array2d(dtype=wp.float64)
        mean: wp.array2d(dtype=wp.float64)
        squares: wp.array2d(dtype=wp.float64)
        pass_index: int
        turn: int
        turns: int
        rounds_before: int
        key: wp.uint64

    return Film


@functools.cache
def make_render_camera(precision: str, features: Features) -> Any:
    """Kernel `render_camera(start, scene, camera, photons, receivers, film)`."""
    transport = make_transport(precision, features)
    real, interact = transport.real, transport.interact
    media_indices, split = transport.media_indices, transport.split
    scene_type, ray_type = transport.Scene, transport.Ray
    map_type = make_map_structs(precision).Map
    receivers_type = make_receiver_structs(precision).Receivers
    camera_type, film_type = make_camera_struct(precision), make_film_struct()
    look = make_camera_functions(precision)
    gather = make_gather(precision, features)

    @wp.func
    def follow(
        scene: scene_type,
        photons: map_type,
        receivers: receivers_type,
        camera_ray: ray_type,
        band: int,
        deal: int,
        weight: real,
        wavelength_nm: real,
        key: wp.uint64,
        sample: wp.array2d(dtype=wp.float64),
        row: int,
    ):
        """Add one path's radiance to `sample[row]`; 1 if a branch met a dispersive surface."""
        indices = media_indices(scene, wavelength_nm)
        stack_ray = wp.zeros(shape=(8,), dtype=ray_type)
        stack_throughput = wp.zeros(shape=(8,), dtype=real)
        stack_dispersed = wp.zeros(shape=(8,), dtype=int)
        depth = int(0)
        alive = bool(True)
        ray = camera_ray
        throughput = weight
        threshold = weight * real(BRANCH_THRESHOLD)
        dispersed = int(0)
        met_dispersive = int(0)
        for step in range(MAX_INTERACTIONS):
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
                throughput = stack_throughput[depth]
                dispersed = stack_dispersed[depth]
                alive = bool(True)
            met = interact(scene, ray, indices)
            if met.event == EVENT_BOUNDARY:
                if met.dispersive == 1:
                    met_dispersive = 1
                    dispersed = 1
                if met.dispersive == 1 and band < 0:
                    alive = False
                else:
                    stronger, weaker, refracts = split(met)
                    side = throughput * met.reflectance
                    main = (throughput - side) * met.eta * met.eta
                    if refracts == 0:
                        swapped = side
                        side = main
                        main = swapped
                    ray.origin = met.point
                    ray.direction = stronger
                    ray.prim = met.prim
                    ray.face = met.face
                    throughput = main
                    side = play_roulette(side, threshold, key, wp.uint64(step))
                    if side > real(0.0) and depth < STACK_SIZE:
                        side_ray = ray_type()
                        side_ray.origin = met.point
                        side_ray.direction = weaker
                        side_ray.prim = met.prim
                        side_ray.face = met.face
                        stack_ray[depth] = side_ray
                        stack_throughput[depth] = side
                        stack_dispersed[depth] = dispersed
                        depth += 1
            else:
                alive = False
                if met.event == EVENT_DEPOSIT and (band < 0 or dispersed == 1):
                    gather(
                        scene, photons, receivers, met, band, deal,
                        throughput / receivers.band_width_nm, sample, row,
                    )
        return met_dispersive

    @wp.kernel(module="unique", enable_backward=False)
    def render_camera(
        start: int,
        scene: scene_type,
        camera: camera_type,
        photons: map_type,
        receivers: receivers_type,
        film: film_type,
    ):
        pixel = start + wp.tid()
        if film.turn == 0:
            for column in range(receivers.bands + receivers.lamps):
                film.sample[pixel, column] = wp.float64(0.0)
        # R2 points over the passes, shifted at random for each pixel: every pixel's samples
        # are spread, and neighbours share no pattern.
        step = real(film.pass_index)
        shift = wp.uint64(pixel)
        x = to_unit(hash64(film.key, shift * wp.uint64(3)), step)
        y = to_unit(hash64(film.key, shift * wp.uint64(3) + wp.uint64(1)), step)
        z = to_unit(hash64(film.key, shift * wp.uint64(3) + wp.uint64(2)), step)
        x += step * real(0.7548776662466927)
        y += step * real(0.5698402909980532)
        z += step * real(0.6180339887498949)
        ray = ray_type()
        ray.origin = camera.position
        ray.direction = look(
            camera,
            real(pixel % camera.width) + x - wp.floor(x),
            real(pixel // camera.width) + y - wp.floor(y),
        )
        ray.prim = -1
        ray.face = -1
        inside_band = z - wp.floor(z)
        key = hash64(
            film.key + wp.uint64(1), shift * wp.uint64(1048576) + wp.uint64(film.pass_index)
        )
        half_range_nm = real(0.5) * receivers.band_width_nm * real(receivers.bands)
        wavelength_nm = receivers.first_edge_nm + half_range_nm
        dispersed = follow(
            scene, photons, receivers, ray, -1, 0, real(1.0) / real(film.turns), wavelength_nm,
            key, film.sample, pixel,
        )
        if dispersed == 1:
            deal = int(key >> wp.uint64(40))
            # Neighbours to the right and below have turns of their own: no stripes.
            place = pixel % camera.width + pixel // camera.width * (film.turns // 2)
            for band in range((place + film.turn) % film.turns, receivers.bands, film.turns):
                wavelength_nm = receivers.first_edge_nm
                wavelength_nm += receivers.band_width_nm * (real(band) + inside_band)
                follow(
                    scene, photons, receivers, ray, band, deal, real(1.0), wavelength_nm, key,
                    film.sample, pixel,
                )
        if film.turn == film.turns - 1:
            share = wp.float64(1.0) / wp.float64(film.rounds_before + 1)
            for band in range(receivers.bands):
                value = film.sample[pixel, band]
                delta = value - film.mean[pixel, band]
                mean = film.mean[pixel, band] + delta * share
                film.mean[pixel, band] = mean
                film.squares[pixel, band] += delta * (value - mean)

    return render_camera
