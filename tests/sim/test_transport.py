"""One step of light: the nearest surface of every shape, and what it does.

Every shape is held against its own description: a solid is where its inside is.
"""

import functools
from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

import scenes
from sim import analytic
from sim.device import start_device
from sim.features import Features
from sim.scene_data import compile_scene
from sim.transport import make_transport

ETA = 1.5
SPACING = 10.0
WAVELENGTH_NM = 550.0


def lens(r1, r2, thickness, aperture, k1=0.0, k2=0.0):
    """Fields of a lens; a radius of 0 stands for a plane."""
    first, second = (
        {"curvature": 0.0} if r == 0.0 else {"radius": r, "conic": k}
        for r, k in ((r1, k1), (r2, k2))
    )
    return scenes.Lens, {
        "axis": (1.0, 2.0, 2.0), "thickness": thickness, "aperture": aperture,
        "first": scenes.LensSurface(**first), "second": scenes.LensSurface(**second),
    }  # fmt: skip


TETRAHEDRON = ((1, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1))
TURNED = {"rotation_deg": (10.0, 20.0, 30.0)}
SOLIDS = {
    "ball": (scenes.Sphere, {"radius": 1.2}),
    "box": (scenes.Box, {"size": (1.0, 2.0, 0.7), **TURNED}),
    "upright box": (scenes.Box, {"size": (1.0, 1.0, 1.0)}),
    "prism": (scenes.Prism, {"apex_deg": 60.0, "base": 2.0, "length": 2.0, **TURNED}),
    "wedge": (scenes.Prism, {"apex_deg": 1e-3, "base": 0.5, "length": 2.0, "height": 2.0}),
    "sharp prism": (scenes.Prism, {"apex_deg": 5.0, "base": 0.2, "length": 1.0, **TURNED}),
    "tetrahedron": (scenes.Polyhedron, {"vertices": TETRAHEDRON, **TURNED}),
    "biconvex": lens(2.0, -1.5, 0.9, 2.0),
    "meniscus": lens(1.2, 2.5, 0.4, 2.0),
    "deep meniscus": lens(-0.95, -1.2, 0.5, 1.8),
    "biconcave": lens(-1.5, 1.2, 0.2, 2.0),
    "half ball": lens(1.0, 0.0, 1.1, 2.0),
    "hyperboloid": lens(0.0, -0.7, 0.8, 1.6, k2=-ETA**2),
    "ellipsoid": lens(1.0, -0.8, 1.3, 1.2, k1=-0.5, k2=0.4),
}  # fmt: skip
NAMES = tuple(SOLIDS)
CENTRES = {name: np.array([SPACING * i, 0.0, 0.0]) for i, name in enumerate(NAMES)}
AIR_BOX = len(NAMES)
FLOOR_Y, CEILING_Y, SHEET_Y = -4.0, 40.0, 4.0
DISK_X, RECTANGLE_X = 5.0, 25.0


def every_shape():
    """All solids in a row, a box of nothing, and above and below them flat things."""
    glass = scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA))
    nothing = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.0))
    objects = [
        scenes.SceneObject(
            name=name, shape=kind(position=tuple(CENTRES[name].tolist()), **fields), material=glass
        )
        for name, (kind, fields) in SOLIDS.items()
    ]
    box = scenes.Box(position=(-SPACING, 0.0, 0.0), size=(2.0, 2.0, 2.0))
    white, black = scenes.Lambertian(reflectance=0.5), scenes.Absorber()
    down = (0.0, -1.0, 0.0)
    flats = [
        (scenes.Plane(position=(0.0, FLOOR_Y, 0.0), normal=(0.0, 1.0, 0.0)), white),
        (scenes.Plane(position=(0.0, CEILING_Y, 0.0), normal=down), black),
        (scenes.Disk(position=(DISK_X, SHEET_Y, 0.0), normal=down, radius=2.0), black),
        (
            scenes.Rectangle(
                position=(RECTANGLE_X, SHEET_Y, 0.0), size=(4.0, 1.0), normal=(0.0, 1.0, 0.0),
                up=(0.6, 0.0, 0.8),
            ),
            white,
        ),
    ]  # fmt: skip
    objects.append(scenes.SceneObject(name="nothing", shape=box, material=nothing))
    objects += [scenes.SceneObject(shape=shape, material=paint) for shape, paint in flats]
    return scenes.Scene(objects=objects)


FLOOR, CEILING, DISK, RECTANGLE = range(AIR_BOX + 1, AIR_BOX + 5)
ESCAPE, BOUNDARY, DEPOSIT, ABSORB = range(4)


@functools.cache
def make_probes(precision: str, features: Features) -> SimpleNamespace:
    transport = make_transport(precision, features)
    real, vec3 = transport.real, transport.vec3
    scene_type, ray_type, met_type = transport.Scene, transport.Ray, transport.Interaction
    interact, media_indices = transport.interact, transport.media_indices
    options = {"module": f"tests_transport_{precision}", "enable_backward": False}

    @wp.kernel(**options)
    def step(
        scene: scene_type,
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        out_met: wp.array(dtype=met_type),
    ):
        i = wp.tid()
        ray = ray_type()
        ray.origin = origins[i]
        ray.direction = directions[i]
        ray.prim = -1
        ray.face = -1
        out_met[i] = interact(scene, ray, media_indices(scene, real(WAVELENGTH_NM)))

    @wp.kernel(**options)
    def reflect_inside(
        scene: scene_type,
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        prims: wp.array(dtype=int),
        bounces: int,
        out_origins: wp.array(dtype=vec3),
        out_directions: wp.array(dtype=vec3),
        out_lost: wp.array(dtype=int),
        out_total: wp.array(dtype=int),
    ):
        """Follow the reflected branch only, and tell after how many steps the solid was lost."""
        i = wp.tid()
        ray = ray_type()
        ray.origin = origins[i]
        ray.direction = directions[i]
        ray.prim = -1
        ray.face = -1
        indices = media_indices(scene, real(WAVELENGTH_NM))
        lost = wp.int32(-1)
        total = wp.int32(0)
        for bounce in range(bounces):
            met = interact(scene, ray, indices)
            if met.event != BOUNDARY or met.prim != prims[i] or met.side != 1:
                lost = bounce
                break
            total += met.total
            ray.origin = met.point
            ray.direction = met.reflected
            ray.prim = met.prim
            ray.face = met.face
        out_origins[i] = ray.origin
        out_directions[i] = ray.direction
        out_lost[i] = lost
        out_total[i] = total

    return SimpleNamespace(step=step, reflect_inside=reflect_inside)


class Bench:
    """The compiled scene, with the world's coordinates outside."""

    def __init__(self, precision):
        start_device("cpu")
        self.precision = precision
        self.eps = float(np.finfo(precision).eps)
        self.compiled = compile_scene(every_shape(), precision=precision)
        self.probes = make_probes(precision, self.compiled.features)

    def vectors(self, array):
        return wp.array(array, dtype=self.compiled.structs.vec3, device="cpu")

    def step(self, origins, directions):
        """What each ray meets, as a structured array; `point` is in the world."""
        met = wp.zeros(len(origins), dtype=self.compiled.structs.Interaction, device="cpu")
        inputs = [
            self.compiled.data,
            self.vectors(self.compiled.to_local(origins)),
            self.vectors(directions),
        ]
        wp.launch(self.probes.step, dim=len(origins), inputs=inputs, outputs=[met], device="cpu")
        found = met.numpy()
        fields = {name: found[name] for name in found.dtype.names}
        fields["point"] = fields["point"] + self.compiled.origin
        return SimpleNamespace(**fields)

    def reflect_inside(self, origins, directions, prims, bounces):
        """Ends, directions, steps after which the solid was lost (−1 never), total reflections."""
        n = len(origins)
        outs = [wp.zeros(n, dtype=self.compiled.structs.vec3, device="cpu") for _ in range(2)]
        outs += [wp.zeros(n, dtype=int, device="cpu") for _ in range(2)]
        inputs = [
            self.compiled.data,
            self.vectors(self.compiled.to_local(origins)),
            self.vectors(directions),
            wp.array(prims, dtype=int, device="cpu"),
            bounces,
        ]
        wp.launch(self.probes.reflect_inside, dim=n, inputs=inputs, outputs=outs, device="cpu")
        ends, ways, lost, total = (out.numpy() for out in outs)
        return ends + self.compiled.origin, ways.astype(np.float64), lost, total


@pytest.fixture(scope="module", params=["float64", "float32"])
def bench(request):
    return Bench(request.param)


# Each solid's own idea of what is inside it


def outsideness(shape, points):
    """Negative inside, positive outside, 0 on the surface: a distance or about one, (n,)."""
    if isinstance(shape, scenes.Sphere):
        return np.linalg.norm(points - shape.position, axis=-1) - shape.radius
    if not isinstance(shape, scenes.Lens):
        normals, offsets = shape.faces()
        return np.max((points - shape.position) @ normals.T - offsets, axis=-1)
    axis = np.array(shape.axis)
    z = (points - shape.position) @ axis
    rho = np.linalg.norm(points - shape.position - z[..., None] * axis, axis=-1)
    half, rim = 0.5 * shape.thickness, 0.5 * shape.aperture
    before = -depth(surface=shape.first, rho=np.minimum(rho, rim), z=z + half)
    behind = depth(surface=shape.second, rho=np.minimum(rho, rim), z=z - half)
    return np.maximum(np.maximum(before, behind), rho - rim)


def depth(surface, rho, z):
    """z − sag(ρ) over √(1 + slope²): about the distance behind a surface whose vertex is at 0."""
    cosine2 = np.maximum(1.0 - surface.steepness * rho**2, 0.0)
    sag = surface.curvature * rho**2 / (1.0 + np.sqrt(cosine2))
    slope2_cosine2 = (surface.curvature * rho) ** 2
    return (z - sag) * np.sqrt(cosine2 / (cosine2 + slope2_cosine2 + 1e-300))


def shape_of(bench, name):
    return bench.compiled.scene.objects[NAMES.index(name)].shape


def points_inside(shape, count, rng):
    centre, radius = shape.bounding_sphere()
    found = []
    while sum(map(len, found)) < count:
        points = centre + rng.uniform(-radius, radius, (20 * count, 3))
        found.append(points[outsideness(shape, points) < -1e-3 * radius])
    return np.concatenate(found)[:count]


def random_directions(count, rng):
    directions = rng.normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def first_change(shape, origins, directions, reach, steps=300):
    """Where each ray first passes the surface, by a walk and bisection; inf where it is unseen."""
    first = outsideness(shape, origins) < 0.0
    low, high = np.zeros(len(origins)), np.zeros(len(origins))
    found = np.zeros(len(origins), dtype=bool)

    def differs(t):
        return (outsideness(shape, origins + t[:, None] * directions) < 0.0) != first

    for step in np.linspace(0.0, reach, steps)[1:]:
        low, high = np.where(found, low, high), np.where(found, high, step)
        found |= differs(high)
    for _ in range(55):
        middle = 0.5 * (low + high)
        changed = differs(middle)
        low, high = np.where(changed, low, middle), np.where(changed, middle, high)
    return np.where(found, high, np.inf)


@pytest.mark.parametrize("name", NAMES)
def test_solids_are_met_where_their_inside_begins_and_ends(bench, name):
    shape, prim = shape_of(bench, name), NAMES.index(name)
    rng = np.random.default_rng(prim)
    centre, radius = shape.bounding_sphere()
    outside = centre + 1.5 * radius * random_directions(500, rng)
    outside = np.vstack([outside, points_inside(shape, 500, rng)])
    aims = centre + rng.uniform(-0.8, 0.8, (1000, 3)) * radius
    directions = aims - outside
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    met = bench.step(outside, directions)
    expected = first_change(shape, outside, directions, 3.5 * radius)
    seen, hit = np.isfinite(expected), met.prim == prim
    # The walk misses what is thinner than its step: a corner cut, or a wedge's apex.
    assert np.mean(seen == hit) > 0.98
    assert not np.any(seen & ~hit) or np.mean(seen & ~hit) < 0.002
    both = seen & hit
    assert both.sum() > 500
    cosine = np.abs(np.sum(met.normal * directions, axis=1))
    clear = both & (cosine > 0.02)
    first_of_two = clear & (np.abs(met.t - expected) < 0.02 * radius)
    assert first_of_two.sum() > 0.97 * clear.sum()
    # Coordinates in the local frame, some 80 of them, round by ε, and the ray is slanted.
    error = np.abs(met.t - expected)[first_of_two]
    assert np.all(error <= 16.0 * bench.eps * 80.0 / cosine[first_of_two])
    # The normal faces the ray, is of length 1, and points out of the inside.
    np.testing.assert_allclose(np.linalg.norm(met.normal[both], axis=1), 1.0, atol=4 * bench.eps)
    assert np.all(np.sum(met.normal * directions, axis=1)[both] < 0.0)
    assert np.array_equal(met.side[both] == 1, outsideness(shape, outside[both]) < 0.0)


@pytest.mark.parametrize("name", NAMES)
def test_normals_point_straight_off_the_surface(bench, name):
    shape, prim = shape_of(bench, name), NAMES.index(name)
    rng = np.random.default_rng(100 + prim)
    inside = points_inside(shape, 1000, rng)
    met = bench.step(inside, random_directions(1000, rng))
    assert np.all(met.prim == prim)
    # Across the surface the outsideness grows; along it, it stays, to first order. Edges aside.
    step = 1e-4
    along = np.cross(met.normal, random_directions(1000, rng))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    in_glass = outsideness(shape, met.point + 10.0 * step * met.normal)
    in_air = outsideness(shape, met.point - 10.0 * step * met.normal)
    slip = outsideness(shape, met.point + step * along) - outsideness(shape, met.point)
    smooth = (in_glass < 0.0) & (in_air > 5.0 * step)  # the inward normal, since side is 1
    assert smooth.mean() > 0.8
    # Curvature up to 1.5 times the square of the step, slope up to some 3.
    assert np.quantile(np.abs(slip[smooth]), 0.97) < 10.0 * step**2 + 40.0 * bench.eps * 80.0


def test_no_ray_inside_a_solid_is_ever_lost(bench):
    # 10⁵ rays from inside, 24 reflections each: every one ends on the solid's own surface, seen
    # from within.
    rng = np.random.default_rng(9)
    count = 100_000 // len(NAMES) + 1
    origins = np.vstack([points_inside(shape_of(bench, name), count, rng) for name in NAMES])
    prims = np.repeat(np.arange(len(NAMES)), count)
    ends, ways, lost, _ = bench.reflect_inside(
        origins, random_directions(len(origins), rng), prims, 24
    )
    assert len(origins) >= 100_000
    assert {NAMES[prim] for prim in prims[lost >= 0]} == set()
    np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1.0, rtol=0, atol=4 * bench.eps)
    for name in NAMES:
        mine = ends[prims == NAMES.index(name)]
        off = np.abs(outsideness(shape_of(bench, name), mine))
        # Each of 24 hits is rounded at coordinates up to 80, slanted rays more.
        assert np.quantile(off, 0.999) < 24.0 * 80.0 * bench.eps


def edge_points(shape):
    """Corners and points of the edges of a polyhedron, or of the seams of a lens."""
    if isinstance(shape, scenes.Lens):
        phi = np.linspace(0.0, 2.0 * np.pi, 101)[:-1]
        u, v, axis = (np.array(a) for a in scenes_frame(shape.axis))
        rim, half = 0.5 * shape.aperture, 0.5 * shape.thickness
        heights = (-half + shape.first.sag(rim), half + shape.second.sag(rim))
        circle = rim * (np.cos(phi)[:, None] * u + np.sin(phi)[:, None] * v)
        return np.vstack([np.array(shape.position) + circle + z * axis for z in heights])
    corners = shape.vertices_world()
    middles = 0.5 * (corners[:, None] + corners[None])
    return np.vstack([corners, middles.reshape(-1, 3)])


def scenes_frame(axis):
    w = np.array(axis)
    u = np.cross(w, [0.0, 0.0, 1.0])
    u /= np.linalg.norm(u)
    return u, np.cross(w, u), w


@pytest.mark.parametrize("name", [name for name in NAMES if name != "ball"])
def test_rays_into_edges_and_corners_are_not_lost(bench, name):
    shape, prim = shape_of(bench, name), NAMES.index(name)
    targets = edge_points(shape)
    starts = points_inside(shape, 40, np.random.default_rng(11))
    directions = (targets[None] - starts[:, None]).reshape(-1, 3)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origins = np.repeat(starts, len(targets), axis=0)
    _, _, lost, _ = bench.reflect_inside(origins, directions, np.full(len(origins), prim), 6)
    # From a seam that is hit to the last digit a ray may run along the rim, tangent to it, so that
    # in single precision rounding decides from which side it meets the rim again.
    assert np.mean(lost >= 0) <= (0.0 if bench.precision == "float64" else 1e-3)


def test_total_reflection_ten_thousand_times(bench):
    # In a box of index 1.5 a ray whose direction has no component beyond cos 41.8° = 0.745 along
    # any normal never gets out; only the signs of its components change.
    shape, prim = shape_of(bench, "box"), NAMES.index("box")
    rng = np.random.default_rng(12)
    local = random_directions(4000, rng)
    local = local[np.abs(local).max(axis=1) < 0.74][:64]
    rotation = scenes.rotation_matrix(shape.rotation_deg)
    origins = points_inside(shape, 64, rng)
    bounces = 10_000
    ends, ways, lost, total = bench.reflect_inside(
        origins, local @ rotation.T, np.full(64, prim), bounces
    )
    assert len(local) == 64
    assert np.all(lost == -1)
    assert np.all(total == bounces)
    np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1.0, rtol=0, atol=4 * bench.eps)
    # Each reflection turns the direction by its rounding: as much as a random walk, or as a
    # steady drift at the worst.
    drift = np.abs(np.abs(ways @ rotation) - np.abs(local)).max()
    assert drift <= 2.0 * bench.eps * bounces
    assert np.max(outsideness(shape, ends)) < 80.0 * 8.0 * bench.eps


def test_a_ball_keeps_its_light(bench):
    # Chords that pass the centre further away than R/η are reflected totally, for ever.
    shape = shape_of(bench, "ball")
    rng = np.random.default_rng(13)
    radial, onward = random_directions(64, rng), random_directions(64, rng)
    tangent = np.cross(radial, onward)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    miss = rng.uniform(0.7, 0.98, 64) * shape.radius  # R/η = 0.667 R
    origins = shape.position + miss[:, None] * radial
    prims = np.zeros(64, dtype=int)
    ends, ways, lost, total = bench.reflect_inside(origins, tangent, prims, 10_000)
    assert np.all(lost == -1)
    assert np.all(total == 10_000)
    # The distance of the chord from the centre is an invariant.
    closest = np.linalg.norm(np.cross(ends - shape.position, ways), axis=1)
    assert np.max(np.abs(closest - miss)) < 80.0 * bench.eps * 10_000
    assert np.quantile(np.abs(closest - miss), 0.5) < 80.0 * bench.eps * 300


# Flat things, and what surfaces do


def test_flat_things_end_at_their_edges(bench):
    rng = np.random.default_rng(14)
    origins = rng.uniform([-5.0, 4.5, -5.0], [35.0, 9.0, 5.0], (5000, 3))
    directions = random_directions(5000, rng)
    directions[:, 1] = -np.abs(directions[:, 1]) - 0.3
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    t = (SHEET_Y - origins[:, 1]) / directions[:, 1]
    x, z = (origins[:, axis] + t * directions[:, axis] for axis in (0, 2))
    on_disk = 2.0 - np.hypot(x - DISK_X, z)
    u, v = (x - RECTANGLE_X) * 0.8 - z * 0.6, (x - RECTANGLE_X) * 0.6 + z * 0.8
    on_rectangle = np.minimum(2.0 - np.abs(u), 0.5 - np.abs(v))
    met = bench.step(origins, directions)
    sure = np.minimum(np.abs(on_disk), np.abs(on_rectangle)) > 1e3 * bench.eps
    np.testing.assert_array_equal((met.prim == DISK)[sure], (on_disk > 0.0)[sure])
    np.testing.assert_array_equal((met.prim == RECTANGLE)[sure], (on_rectangle > 0.0)[sure])
    flat = (met.prim == DISK) | (met.prim == RECTANGLE)
    assert flat.sum() > 100
    np.testing.assert_allclose(met.t[flat], t[flat], rtol=100 * bench.eps)
    np.testing.assert_allclose(met.point[flat, 1], SHEET_Y, atol=200 * bench.eps)


def test_events_and_sides(bench):
    x_ball = CENTRES["ball"][0]
    down, up = [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]
    cases = [
        ([x_ball - 4.0, 0.0, 0.0], down, DEPOSIT, FLOOR, 0),
        ([x_ball - 4.0, -9.0, 0.0], up, DEPOSIT, FLOOR, 1),  # its back
        ([x_ball - 4.0, 0.0, 0.0], up, ABSORB, CEILING, 0),  # its normal points down
        ([DISK_X, 0.0, 0.0], up, ABSORB, DISK, 0),
        ([RECTANGLE_X, 9.0, 0.0], down, DEPOSIT, RECTANGLE, 0),
        ([RECTANGLE_X, 0.0, 0.0], up, DEPOSIT, RECTANGLE, 1),
        ([x_ball, 3.0, 0.0], down, BOUNDARY, 0, 0),
        ([x_ball, 0.0, 0.0], down, BOUNDARY, 0, 1),
        ([x_ball, 3.0, 0.0], [0.0, 0.0, 1.0], ESCAPE, -1, 0),
    ]
    met = bench.step(*(np.array([case[i] for case in cases]) for i in (0, 1)))
    assert met.event.tolist() == [case[2] for case in cases]
    assert met.prim.tolist() == [case[3] for case in cases]
    assert met.side.tolist() == [case[4] for case in cases]


def test_boundaries_reflect_and_refract_as_fresnel_and_snell_say(bench):
    shape = shape_of(bench, "upright box")
    angles = np.deg2rad(np.linspace(0.0, 80.0, 41))
    ways = np.column_stack([np.sin(angles), -np.cos(angles), np.zeros(41)])
    top = np.add(shape.position, [0.0, 0.5, 0.0])
    inside, outside = (bench.step(top - sign * 0.1 * ways, ways * sign) for sign in (-1.0, 1.0))
    # From above, η = 1/1.5.
    r_s, r_p = analytic.fresnel_reflectance(np.cos(angles), 1.0, ETA)
    np.testing.assert_allclose(outside.reflectance, 0.5 * (r_s + r_p), atol=100 * bench.eps)
    np.testing.assert_allclose(outside.eta, 1.0 / ETA, rtol=2 * bench.eps)
    theta_t = analytic.snell_angle(angles, 1.0, ETA).theta_t
    np.testing.assert_allclose(outside.refracted[:, 0], np.sin(theta_t), atol=8 * bench.eps)
    np.testing.assert_allclose(outside.reflected, ways * [1.0, -1.0, 1.0], atol=8 * bench.eps)
    # From below, total beyond 41.8°, and the same reflectance along the same path.
    critical = np.arcsin(1.0 / ETA)
    np.testing.assert_array_equal(inside.total == 1, angles > critical)
    np.testing.assert_array_equal(outside.total, 0)
    assert np.all(inside.reflectance[angles > critical] == 1.0)
    below = analytic.fresnel_reflectance(np.cos(angles), ETA, 1.0)
    off = np.abs(np.cos(angles) ** 2 - np.cos(critical) ** 2)  # cos²θₜ/η²: see the rounding below
    np.testing.assert_array_less(
        np.abs(inside.reflectance - 0.5 * (below[0] + below[1])), 100 * bench.eps / np.sqrt(off)
    )


@pytest.mark.parametrize("cosine", [0.5, 1e-3, 1e-5, 1e-9])
def test_equal_media_let_everything_through_unchanged(bench, cosine):
    # A box of index 1, met at glancing angles: no reflection, and no bend.
    way = np.array([[np.sqrt((1.0 - cosine) * (1.0 + cosine)), -cosine, 0.0]])
    top = np.array([[-SPACING, 1.0, 0.0]])
    met = bench.step(top - 0.3 * way, way)
    assert met.prim.tolist() == [AIR_BOX]
    assert met.total.tolist() == [0]
    assert met.reflectance.tolist() == [0.0]
    np.testing.assert_array_equal(met.refracted, way.astype(bench.precision))
