"""Camera paths: from a pixel through glass and mirrors to the receivers, and the gather there.

A pixel is sampled in two parts that add up. First a path for all bands at once, which ends where
it meets a dispersive surface. If it met one, a path for each band follows, with a wavelength
drawn from the band, whose branches count only behind a dispersive surface. Bands are so never
mixed behind a prism, and a pixel that sees no glass costs one path, not one for each band.

Pixels behind glass are dear, so their bands take turns: with S turns a pass follows every S-th
band, shifted from pixel to pixel, and S passes make one complete sample of the film.

Behind a lens with an aperture a pass sends several paths for all bands, through points spread over
the lens, and the bands' paths are dealt out to these points.

References:
    Jensen (1996), "Global illumination using photon maps", §4.
    Welford (1962), Technometrics 4, 419: running mean and sum of squared deviations.
"""

import functools
from typing import Any

import warp as wp

from sim.features import Features
from sim.image.camera import make_camera_functions, make_camera_struct
from sim.image.camera_branches import make_follow_sight
from sim.image.sight import ALL_BANDS, make_lights_struct, make_sight_struct
from sim.sampling.counter import hash64
from sim.sampling.kronecker import r1_point, r2_point
from sim.transport import make_transport

__all__ = ["make_film_struct", "make_render_camera"]

SHADOW_RAYS = 4
"""To each lamp, of a path for all bands; the many paths for single bands cast one each."""

LENS_POINTS = 4
"""Paths for all bands, of a camera with a lens; they share the shadow rays."""


@functools.cache
def make_film_struct() -> Any:
    """Struct Film: running mean and squared deviations of each pixel and band, one row a pixel.

    `sample` holds the sample that the passes of one round of turns add up to, as
    `sim.image.gather` fills it; `turn` of `turns` is the pass within its `round`, `rounds_before`
    counts the complete ones. `tally` holds of each pixel the running mean and squared deviations of
    its luminance, of the part of it that is the gather's bias, and of the rest, in this order.
    `radius_scale` is each pixel's gather radius in that of the photon map.
    """

    @wp.struct
    class Film:
        sample: wp.array2d(dtype=wp.float64)
        mean: wp.array2d(dtype=wp.float64)
        squares: wp.array2d(dtype=wp.float64)
        tally: wp.array2d(dtype=wp.float64)
        radius_scale: wp.array(dtype=wp.float32)
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
    real, scene_type, free_ray = transport.real, transport.Scene, transport.free_ray
    lights_type, sight_type = make_lights_struct(precision), make_sight_struct(precision)
    camera_type, film_type = make_camera_struct(precision), make_film_struct()
    seeing = make_camera_functions(precision, features)
    look_through, place_in_pixel = seeing.look_through, seeing.place_in_pixel
    lens_points = LENS_POINTS if features.thin_lens else 1
    follow = make_follow_sight(precision, features)

    @wp.func
    def ray_through(camera: camera_type, pixel: int, x: real, y: real, key: wp.uint64, point: int):
        """The ray of a place (x, y) in a pixel through one of the points on its lens."""
        u0, u1 = r2_point(key + wp.uint64(4), wp.uint32(point), x)
        origin, direction = look_through(
            camera, real(pixel % camera.width) + x, real(pixel // camera.width) + y, u0, u1
        )
        return free_ray(origin, direction)

    @wp.func
    def sample_pixel(
        scene: scene_type, camera: camera_type, lights: lights_type, film: film_type, pixel: int
    ):
        """Add one sample of a pixel to its row: paths for all bands, and paths for its turn's."""
        receivers = lights.receivers
        # Spread over the turns of a round, and drawn anew for the next one: rounds are replicates.
        key = hash64(hash64(film.key, wp.uint64(pixel)), wp.uint64(film.round))
        turn = wp.uint32(film.turn)
        ux, uy = r2_point(key, turn, receivers.band_width_nm)
        x, y = place_in_pixel(camera, ux, uy)
        inside_band = r1_point(key + wp.uint64(1), turn, receivers.band_width_nm)
        sight = sight_type()
        sight.row = pixel
        sight.radius_scale = real(film.radius_scale[pixel])
        sight.band = ALL_BANDS
        sight.weight = real(wp.static(1.0 / lens_points)) / real(film.turns)
        half_range_nm = real(0.5) * receivers.band_width_nm * real(receivers.bands)
        sight.wavelength_nm = receivers.first_edge_nm + half_range_nm
        sight.lamp_key = key + wp.uint64(3)
        sight.shadow_rays = wp.static(SHADOW_RAYS // lens_points)
        first_point = film.turn * wp.static(lens_points)
        dispersing = int(0)  # points of the lens behind which there is dispersion, a bit each
        point = int(0)
        while point < wp.static(lens_points):
            sight.sample = first_point + point
            sight.key = hash64(key + wp.uint64(2), wp.uint64(sight.sample))
            ray = ray_through(camera, pixel, x, y, key, sight.sample)
            dispersing |= follow(scene, lights, ray, sight, film.sample) << point
            point += 1
        if wp.static(features.dispersion):
            if dispersing != 0:
                sight.deal = int(sight.key >> wp.uint64(40))
                sight.weight = real(1.0)
                sight.shadow_rays = 1
                sight.sample = film.turn
                # Where the round starts is each pixel's own: turns leave no stripes or checks.
                sight.band = (int(key >> wp.uint64(40)) + film.turn) % film.turns
                point = sight.deal
                while sight.band < receivers.bands:
                    point = (point + 1) % wp.static(lens_points)
                    if (dispersing >> point) & 1 == 1:
                        offset_nm = receivers.band_width_nm * (real(sight.band) + inside_band)
                        sight.wavelength_nm = receivers.first_edge_nm + offset_nm
                        ray = ray_through(camera, pixel, x, y, key, first_point + point)
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
