"""Radiance that a point of a diffuse receiver sends back: from the photon map, and direct.

The reflected radiance of a band is ``L = Σ K(|x − xₚ|) ρ Φₚ / (π Δλ)`` over the band's photons on
the same side of the same face within the radius, and of photons that no dispersion has touched
each band takes its share, with the kernel of Epanechnikov (1969),
``K(d) = 2/(π r²) (1 − d²/r²)``. Where the disc overhangs the receiver's edge, K is divided by its
integral over the part that does not. Where the map leaves out what comes straight from the lamps,
their irradiance E adds ``ρ E / (π Δλ)``.

References:
    Jensen (1996), "Global illumination using photon maps", §3.2.
    Silverman (1986), *Density Estimation*, §2.10 on boundaries, §3.3 on the kernel.
    Schucany & Sommers (1977), JASA 72, 420: a kernel's bias from a second kernel.
"""

import functools
import math

import warp as wp

from sim.features import Features
from sim.geometry.extent import distance_to_circle, distance_to_planes, distance_to_sides
from sim.geometry.flat import plane_coordinates
from sim.geometry.mesh import facet_normal
from sim.geometry.mesh_extent import distance_on_mesh
from sim.image.direct_light import make_direct_light
from sim.image.sight import ALL_BANDS, make_lights_struct, make_sight_struct
from sim.photons.photon_map import make_map_structs
from sim.photons.photon_structs import surface_key
from sim.photons.receivers import DEALS, make_receiver_structs
from sim.precision import precision_types
from sim.sampling.directions import to_world
from sim.scene_structs import SHAPE_FLAT, SHAPE_MESH, SHAPE_POLYHEDRON, make_scene_structs

__all__ = ["make_gather"]

EDGE_DIRECTIONS = 64
"""Directions in which the overhang is measured: about 1e-4 of the kernel's integral."""

PI = wp.constant(3.141592653589793)


@functools.cache
def make_kernel_integral(precision: str, features: Features) -> object:
    """Device function: the part of the gather kernel that lies on the receiver, in (0, 1]."""
    structs = make_scene_structs(precision)
    real, scene_type = structs.real, structs.Scene
    interaction_type = structs.Interaction

    @wp.func
    def clearance(scene: scene_type, met: interaction_type, radius: real):
        """A lower bound of the distance to the receiver's edge; `radius` where it has none."""
        body = scene.bodies[met.prim]
        distance = radius
        if wp.static(features.flats):
            if body.shape == SHAPE_FLAT:
                flat = scene.flats[body.row]
                u, v = plane_coordinates(met.point - flat.centre, flat.frame)
                distance = wp.min(flat.half_u - wp.abs(u), flat.half_v - wp.abs(v))
                if flat.radius2 < real(wp.inf):
                    distance = wp.sqrt(flat.radius2) - wp.sqrt(u * u + v * v)
        if wp.static(features.polyhedra):
            if body.shape == SHAPE_POLYHEDRON:
                solid = scene.polyhedra[body.row]
                point = met.point - solid.centre
                for other in range(solid.first, solid.first + solid.count):
                    if other != met.face:
                        plane = scene.planes[other]
                        distance = wp.min(distance, plane.offset - wp.dot(plane.normal, point))
        if wp.static(features.meshes):
            if body.shape == SHAPE_MESH:
                distance = scene.meshes.borders[met.face].clearance
        return distance

    @wp.func
    def reach(
        scene: scene_type, met: interaction_type, cos_phi: real, sin_phi: real, radius: real
    ):
        """Distance to the receiver's edge in a tangent direction; far if not within `radius`."""
        body = scene.bodies[met.prim]
        distance = real(wp.inf)
        if wp.static(features.flats):
            if body.shape == SHAPE_FLAT:
                flat = scene.flats[body.row]
                u, v = plane_coordinates(met.point - flat.centre, flat.frame)
                distance = distance_to_sides(u, v, flat.half_u, flat.half_v, cos_phi, sin_phi)
                if flat.radius2 < real(wp.inf):
                    distance = distance_to_circle(u, v, flat.radius2, cos_phi, sin_phi)
        if wp.static(features.polyhedra):
            if body.shape == SHAPE_POLYHEDRON:
                solid = scene.polyhedra[body.row]
                distance = distance_to_planes(
                    met.point - solid.centre,
                    to_world(cos_phi, sin_phi, real(0.0), met.normal),
                    scene.planes, solid.first, solid.count, met.face,
                )
        if wp.static(features.meshes):
            if body.shape == SHAPE_MESH:
                distance = distance_on_mesh(
                    scene.meshes, met.face, met.point - scene.meshes.rows[body.row].centre,
                    to_world(
                        cos_phi, sin_phi, real(0.0), facet_normal(scene.meshes, met.face)
                    ),
                    radius,
                )
        return distance

    @wp.func
    def kernel_integral(scene: scene_type, met: interaction_type, radius: real):
        if clearance(scene, met, radius) >= radius:
            return real(1.0)
        # ∫K dA in polar form: ∮ G(ρ(φ)) dφ with G(ρ) = (x − x²/2)/π, x = ρ²/r².
        total = real(0.0)
        step = real(wp.static(2.0 * math.pi / EDGE_DIRECTIONS))
        for k in range(wp.static(EDGE_DIRECTIONS)):
            phi = step * (real(k) + real(0.5))
            rho = wp.min(reach(scene, met, wp.cos(phi), wp.sin(phi), radius), radius)
            x = rho * rho / (radius * radius)
            total += (x - real(0.5) * x * x) / real(PI) * step
        # A disc as wide as the scene may hold a receiver of a millionth of its width.
        return wp.max(total, real(1e-12))

    return kernel_integral


@functools.cache
def make_gather(precision: str, features: Features) -> object:
    """Device function `gather(scene, lights, met, sight, scale, sums)`.

    It adds `scale` times the reflected radiance, times the bands' width, to the bands of the
    sight's row of `sums`: to all of them, or to the sight's own, and then of undispersed photons
    from one of their deals. The columns behind the bands, one a lamp, are
    scratch, zero before and after; in the last one the kernel's bias adds up, as luminance.
    """
    real = precision_types(precision).real
    structs = make_scene_structs(precision)
    scene_type, interaction_type = structs.Scene, structs.Interaction
    map_type = make_map_structs(precision).Map
    receivers_type = make_receiver_structs(precision).Receivers
    lights_type, sight_type = make_lights_struct(precision), make_sight_struct(precision)
    kernel_integral = make_kernel_integral(precision, features)
    direct_irradiance = make_direct_light(precision, features)

    @wp.func
    def bias_kernel(x: real):
        """b(x) = 2 (k(x) − 2 k(2x)): what Σ k w is too much by, if curvature is all that matters.

        The bias of a kernel of half the disc's area is half as large, r² ∇²E / 24 for r² ∇²E / 12,
        so twice the difference estimates it.
        """
        narrow = wp.max(real(1.0) - x - x, real(0.0))
        return real(2.0) * (real(1.0) - x - narrow - narrow)

    @wp.func
    def sum_group(
        photons: map_type, receivers: receivers_type, met: interaction_type, radius: real,
        group: int, band: int,
    ):
        """Σ k w and Σ b w of one group's photons, as far as they shine in `band`."""
        surface = surface_key(met.prim, met.part, met.side)
        inv_radius2 = real(1.0) / (radius * radius)
        query = wp.hash_grid_query(photons.grid, met.point, radius, group)
        candidate = int(0)
        # In double precision always: in single, 10⁶ photons on one disc would be 3 % off.
        total = wp.float64(0.0)
        bias = wp.float64(0.0)
        while wp.hash_grid_query_next(query, candidate):
            offset = photons.position[candidate] - met.point
            x = wp.dot(offset, offset) * inv_radius2
            if x < real(1.0) and photons.surface[candidate] == surface:
                weight = photons.weight[candidate]
                if group >= receivers.bands:
                    weight *= receivers.spread[photons.lamp[candidate], met.prim, band]
                total += wp.float64((real(1.0) - x) * weight)
                bias += wp.float64(bias_kernel(x) * weight)
        return real(total), real(bias)

    @wp.func
    def add_groups(
        photons: map_type, receivers: receivers_type, met: interaction_type, radius: real,
        peak: real, sums: wp.array2d(dtype=wp.float64), row: int,
    ):
        """Add `peak` k w of every photon to its band's column, or to its lamp's.

        Returns the luminance of Σ `peak` b w.
        """
        bands = receivers.bands
        surface = surface_key(met.prim, met.part, met.side)
        inv_radius2 = real(1.0) / (radius * radius)
        query = wp.hash_grid_query(photons.grid, met.point, radius)
        candidate = int(0)
        bias = wp.float64(0.0)
        while wp.hash_grid_query_next(query, candidate):
            offset = photons.position[candidate] - met.point
            x = wp.dot(offset, offset) * inv_radius2
            if x < real(1.0) and photons.surface[candidate] == surface:
                weight = peak * photons.weight[candidate]
                column = photons.group[candidate]
                if column < bands:
                    bias += wp.float64(bias_kernel(x) * weight * receivers.luminance[column])
                else:
                    lamp = photons.lamp[candidate]
                    spread = receivers.spread_luminance[lamp, met.prim]
                    bias += wp.float64(bias_kernel(x) * weight * spread)
                    column = bands + lamp
                sums[row, column] += wp.float64((real(1.0) - x) * weight)
        return bias

    @wp.func
    def peak_density(scene: scene_type, met: interaction_type, radius: real):
        """Kernel at its centre, normalised over what the disc has of the receiver [1/m²]."""
        return real(2.0) / (real(PI) * radius * radius * kernel_integral(scene, met, radius))

    @wp.func
    def add_all(
        scene: scene_type, photons: map_type, receivers: receivers_type, met: interaction_type,
        sight: sight_type, scale: real, sums: wp.array2d(dtype=wp.float64),
    ):
        """Add a map's photons of all bands, `scale` times, and their bias."""
        row = sight.row
        radius = photons.radius * sight.radius_scale
        peak = scale * peak_density(scene, met, radius)
        bias = add_groups(photons, receivers, met, radius, peak, sums, row)
        sums[row, receivers.bands + receivers.lamps] += bias

    @wp.func
    def sum_band(
        scene: scene_type, photons: map_type, receivers: receivers_type, met: interaction_type,
        sight: sight_type,
    ):
        """A map's irradiance times the reflectance over π in the sight's band, and its bias."""
        radius = photons.radius * sight.radius_scale
        total, bias = sum_group(photons, receivers, met, radius, sight.band, sight.band)
        if wp.static(features.undispersed_photons):
            if photons.undispersed == 1:
                dealt = receivers.bands + (sight.band + sight.deal) % DEALS
                undispersed, bias_dealt = sum_group(
                    photons, receivers, met, radius, dealt, sight.band
                )
                total += undispersed * real(wp.static(float(DEALS)))
                bias += bias_dealt * real(wp.static(float(DEALS)))
        density = peak_density(scene, met, radius)
        return total * density, bias * density

    @wp.func
    def gather(
        scene: scene_type, lights: lights_type, met: interaction_type, sight: sight_type,
        scale: real, sums: wp.array2d(dtype=wp.float64),
    ):
        receivers = lights.receivers
        bands = receivers.bands
        row = sight.row
        if sight.band == ALL_BANDS:
            add_all(scene, lights.photons, receivers, met, sight, scale, sums)
            if wp.static(features.interreflection):
                if lights.interreflection == 1:
                    add_all(scene, lights.bounced, receivers, met, sight, scale, sums)
            lamp = int(0)
            while lamp < receivers.lamps:
                total = sums[row, bands + lamp]
                sums[row, bands + lamp] = wp.float64(0.0)
                if wp.static(features.direct_light):
                    if lights.direct == 1:
                        total += wp.float64(
                            scale * direct_irradiance(scene, lights.lamps, lamp, met, sight)
                        )
                if total > wp.float64(0.0):
                    band = int(0)
                    while band < bands:
                        share = wp.float64(receivers.spread[lamp, met.prim, band])
                        sums[row, band] += total * share
                        band += 1
                lamp += 1
        elif wp.static(features.dispersion):
            total_band, bias_band = sum_band(scene, lights.photons, receivers, met, sight)
            if wp.static(features.interreflection):
                if lights.interreflection == 1:
                    more, more_bias = sum_band(scene, lights.bounced, receivers, met, sight)
                    total_band += more
                    bias_band += more_bias
            bias_band *= scale * receivers.luminance[sight.band]
            sums[row, bands + receivers.lamps] += wp.float64(bias_band)
            if wp.static(features.direct_light):
                if lights.direct == 1:
                    lamp = int(0)
                    while lamp < receivers.lamps:
                        irradiance = direct_irradiance(scene, lights.lamps, lamp, met, sight)
                        total_band += irradiance * receivers.spread[lamp, met.prim, sight.band]
                        lamp += 1
            sums[row, sight.band] += wp.float64(scale * total_band)

    return gather
