"""Media on both sides of surfaces, against asking every solid whether it holds the points there."""

import numpy as np
import pytest

import scenes
from scenes.shapes.depth import height_above
from sim import trace_ray
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays

STEP = 1e-7
WAVELENGTH_NM = 550.0
AMBIENT = 1.1


def random_solid(random, index):
    """A solid of any kind about the origin, of an index and a priority of its own."""
    place = tuple(random.uniform(-0.6, 0.6, 3).tolist())
    turn = tuple(random.uniform(-180.0, 180.0, 3).tolist())
    size = random.uniform(0.3, 1.2)
    axis = tuple(random.normal(size=3).tolist())
    curved = {"thickness": 0.5 * size, "aperture": size,
              "first": scenes.LensSurface(radius=size), "second": scenes.LensSurface(radius=-size)}
    shape = (
        scenes.Sphere(position=place, radius=0.6 * size),
        scenes.Box(position=place, size=(size, 0.7 * size, 1.2 * size), rotation_deg=turn),
        scenes.Prism(position=place, apex_deg=60, base=size, length=size, rotation_deg=turn),
        scenes.Lens(position=place, axis=axis, **curved),
    )[index % 4]
    material = scenes.Dielectric(
        medium=scenes.ConstantMedium(eta=1.0 + 0.05 * (index + 1)),
        priority=int(random.permutation(2001)[0]) - 1000,
    )
    return scenes.SceneObject(name=f"solid {index}", shape=shape, material=material)


def indices_at(scene, points):
    """(n,) index at points: that of the solid of the highest priority that holds them."""
    eta = np.full(len(points), AMBIENT)
    priority = np.full(len(points), -np.inf)
    for item in scene.objects:
        holds = (height_above(item.shape, points) < 0.0) & (item.material.priority > priority)
        eta[holds] = item.material.medium.eta
        priority[holds] = item.material.priority
    return eta


def normals_at(scene, names, points):
    """(n, 3) outward unit normals, by the slope of the named objects' heights."""
    shapes = {item.name: item.shape for item in scene.objects}
    found = np.zeros_like(points)
    for k, (name, point) in enumerate(zip(names, points, strict=True)):
        steps = np.vstack([point + STEP * np.eye(3), point - STEP * np.eye(3)])
        heights = height_above(shapes[name], steps)
        found[k] = heights[:3] - heights[3:]
    return found / np.linalg.norm(found, axis=1)[:, None]


@pytest.mark.parametrize("seed", range(4))
def test_every_vertex_obeys_snell_with_the_media_that_are_there(seed):
    random = np.random.default_rng(seed)
    solids = [random_solid(random, index) for index in range(8)]
    scene = scenes.Scene(
        ambient=scenes.ConstantMedium(eta=AMBIENT),
        objects=[solids[k] for k in random.permutation(8)],
    )
    starts = random.normal(size=(300, 3))
    starts *= 3.0 / np.linalg.norm(starts, axis=1)[:, None]
    ways = random.uniform(-0.7, 0.7, (300, 3)) - starts
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    # Of rays that start inside solids, nobody has counted which.
    starts[::2] += 3.0 * ways[::2]
    compiled = compile_scene(scene)
    paths = trace_compiled_rays(compiled, starts, ways, np.full(300, WAVELENGTH_NM),
                                max_interactions=24)  # fmt: skip
    passes = refractions = reflections = 0
    for path in paths:
        last = len(path.events) - 1
        if last == 0:
            continue
        points, before, after = path.points[1 : last + 1], path.directions[:-1], path.directions[1:]
        normals = normals_at(scene, path.objects[:last], points)
        steep = np.abs(np.sum(before * normals, axis=1)) > 0.05
        side = np.sign(np.sum(before * normals, axis=1))[:, None] * normals
        eta_i = indices_at(scene, points - STEP * side)
        eta_t = indices_at(scene, points + STEP * side)
        # Vertices at edges, where the step leads around one, tell nothing.
        lengths = np.linalg.norm(np.diff(path.points, axis=0), axis=1)
        clear = steep & (lengths[:-1] > 100 * STEP) & (lengths[1:] > 100 * STEP)
        for k in np.flatnonzero(clear):
            event = path.events[k]
            if event == "pass":
                passes += 1
                assert eta_i[k] == eta_t[k]
                np.testing.assert_array_equal(before[k], after[k])
                continue
            assert eta_i[k] != eta_t[k], (path.objects[k], event)
            # n d is kept along the surface, whether it refracts or reflects.
            reflects = event == "total internal reflection"
            kept = eta_i[k] * before[k] - (eta_i[k] if reflects else eta_t[k]) * after[k]
            assert np.linalg.norm(np.cross(kept, normals[k])) < 1e-6
            refractions += not reflects
            reflections += reflects
    assert passes > 20
    assert refractions > 300
    assert reflections > 5


def glass(eta, priority=0):
    return scenes.Dielectric(medium=scenes.ConstantMedium(eta=eta), priority=priority)


def cube(name, middle, size, material):
    shape = scenes.Box(position=middle, size=(size, size, size))
    return scenes.SceneObject(name=name, shape=shape, material=material)


DOWN = ((0.1, 3.0, 0.2), (0.0, -1.0, 0.0))


@pytest.mark.parametrize("material", [
    scenes.Lambertian(reflectance=0.5), scenes.Absorber(), scenes.Mirror(),
    scenes.Metal(metal="gold"),
])  # fmt: skip
@pytest.mark.parametrize("opaque_first", [False, True])
@pytest.mark.parametrize("solid", [False, True])
def test_what_is_opaque_hides_the_glass_that_it_touches(material, opaque_first, solid):
    shape = (
        scenes.Box(position=(0, -1, 0), size=(3, 1, 3)) if solid
        else scenes.Rectangle(position=(0, -0.5, 0), size=(3, 3))
    )  # fmt: skip
    base = scenes.SceneObject(name="base", shape=shape, material=material)
    top = cube("glass", (0, 0, 0), 1.0, glass(1.5))
    scene = scenes.Scene(objects=(base, top) if opaque_first else (top, base))
    path = trace_ray(scene, *DOWN, WAVELENGTH_NM)
    event = {"lambertian": "deposit", "absorber": "absorb"}.get(material.type, "mirror")
    assert path.events[:2] == ("refract", event)
    assert path.objects[:2] == ("glass", "base")
    if event == "mirror":
        # It leaves both faces, and comes back through the glass's top.
        assert path.events[2:] == ("refract", "escape")
        assert path.objects[2] == "glass"


def test_solids_of_equal_priority_that_touch_share_one_boundary():
    lower, upper = cube("lower", (0, -0.5, 0), 1.0, glass(1.5)), cube(
        "upper", (0, 0.5, 0), 1.0, glass(2.0)
    )
    for objects in ((lower, upper), (upper, lower)):
        path = trace_ray(scenes.Scene(objects=objects), (0.0, 1.5, 0.0), (0.2, -1, 0.1), 550.0)
        assert path.events == ("refract",) * 3 + ("escape",)
        sines = np.hypot(path.directions[:, 0], path.directions[:, 2])
        expected = sines[0] / np.array([1.0, 2.0, 1.5, 1.0])
        np.testing.assert_allclose(sines, expected, rtol=1e-14)


@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_a_film_of_air_is_air_if_it_is_wide_enough(precision):
    # What is in one place is closer than 2⁻⁴⁰ of the bench's radius, or 2⁻¹⁷ in single precision.
    touch = 2.0 ** (-40 if precision == "float64" else -17)
    for gap, count in ((8.0 * touch, 4), (0.125 * touch, 3)):
        lower = cube("lower", (0, -0.5 - gap, 0), 1.0, glass(1.5))
        upper = cube("upper", (0, 0.5, 0), 1.0, glass(2.0))
        scene = scenes.Scene(objects=(lower, upper))
        path = trace_ray(scene, (0.0, 1.5, 0.0), (0.1, -1, 0.1), 550.0, precision=precision)
        assert path.events == ("refract",) * count + ("escape",)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_contact_knows_no_unit(scale):
    lower = cube("lower", (0, -0.5 * scale, 0), scale, glass(1.5))
    upper = cube("upper", (0, 0.5 * scale, 0), scale, glass(2.0))
    start = (0.0, 1.5 * scale, 0.0)
    path = trace_ray(scenes.Scene(objects=(lower, upper)), start, (0.1, -1, 0.1), 550.0)
    assert path.events == ("refract",) * 3 + ("escape",)
