"""Light on meshes: the picture of a faceted box is the box's, and no watt is lost."""

import math

import numpy as np
import pytest

import scenes
import sim
from sim.photons.energy import BOOK_COLUMNS
from sim.photons.lamps import compile_lamps
from sim.photons.tracing import trace_photons
from sim.scene_data import compile_scene

FACES = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
HALVES = (0.25, 0.125, 0.1875)


def box_file(path, halves, cells=1):
    """A box as an OBJ file, its faces cut into `cells` by `cells` squares of two triangles."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * halves
    points, lines = [], []
    for face in FACES:
        a, b, _, d = (corners[int(i) - 1] for i in face.split())
        u, v = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, 1, cells + 1))
        first = len(points) + 1
        grid = a + u.ravel()[:, None] * (b - a) + v.ravel()[:, None] * (d - a)
        points += grid.tolist()
        for j in range(cells):
            for i in range(cells):
                k = first + j * (cells + 1) + i
                beyond = k + cells + 1
                lines += [f"f {k} {k + 1} {beyond + 1}", f"f {k} {beyond + 1} {beyond}"]
    path.write_text("\n".join([*(f"v {x!r} {y!r} {z!r}" for x, y, z in points), *lines]))
    return str(path)


def test_the_picture_of_a_box_of_triangles_is_that_of_the_box(tmp_path) -> None:
    # Six patches of 32 coplanar triangles each: the same photons on the same faces, gathered over
    # the same discs, cut off at the same edges. Positions differ by rounding, and the kernel is
    # continuous: only a photon at an edge could change sides.
    place = {"position": (0.0, 0.125, 0.0), "rotation_deg": (0.0, 30.0, 0.0)}
    size = tuple(2.0 * half for half in HALVES)
    shapes = (
        scenes.Box(size=size, **place),
        scenes.Mesh(file=box_file(tmp_path / "box.obj", HALVES, cells=4), **place),
    )
    pictures = []
    for shape in shapes:
        scene = scenes.Scene(
            film=scenes.Film(width=24, height=16, first_nm=500, last_nm=600, bands=2),
            camera=scenes.Camera(position=(0.4, 0.9, 0.9), look_at=(0.0, 0.1, 0.0), fov_deg=26.0),
            objects=(
                scenes.SceneObject(
                    name="block", shape=shape, material=scenes.Lambertian(reflectance=0.5)
                ),
            ),
            emitters=(scenes.Point(position=(0.3, 1.0, 0.5), flux=1.0, spectrum="E"),),
        )
        settings = sim.RenderSettings(
            photons=20_000, passes=1, radius=0.05, direct_light="photons", threads=1
        )
        pictures.append(sim.render(scene, settings).spectral_radiance)
    exact, mesh = pictures
    assert np.count_nonzero(exact) > 0.2 * exact.size
    np.testing.assert_allclose(mesh, exact, rtol=1e-9, atol=1e-9 * exact.max())


def test_every_watt_through_glass_of_triangles_is_booked_and_none_slips_out(tmp_path) -> None:
    # A lamp in the middle of a bumpy solid of glass with smooth normals, in a black box of
    # triangles: whatever is emitted ends on that box, for nothing absorbs and nothing is open.
    waves = [
        scenes.Wave(amplitude=0.03, period=0.21, direction_deg=20.0),
        scenes.Wave(amplitude=0.02, period=0.13, direction_deg=110.0),
    ]
    glass = scenes.HeightField(
        position=(0.0, 0.0, 0.0), size=(0.4, 0.4), waves=waves, cells=(24, 24), depth=0.2
    )
    room = scenes.Mesh(
        position=(0.0, 0.0, 0.0), file=box_file(tmp_path / "room.obj", (1.0, 1.0, 1.0), cells=4)
    )
    scene = scenes.Scene(
        objects=(
            scenes.SceneObject(
                name="glass", shape=glass, material=scenes.Dielectric(medium="SF11")
            ),
            scenes.SceneObject(name="room", shape=room, material=scenes.Absorber()),
        ),
        emitters=(scenes.Point(position=(0.0, -0.1, 0.0), flux=7.0, spectrum="E"),),
    )
    edges_nm = np.linspace(400.0, 700.0, 4)
    compiled = compile_scene(scene)
    batch = trace_photons(
        compiled, compile_lamps(compiled, edges_nm, 20_000), seed=1, pass_index=0,
        max_interactions=256, threads=2,
    )
    books = dict(zip(BOOK_COLUMNS, batch.books.totals, strict=True))
    assert books["escaped"] == 0.0
    assert books["deposited"] == 0.0
    # As in test_energy_books: N ε/2 in the worst case.
    total = math.fsum(value for key, value in books.items() if key != "emitted")
    assert total == pytest.approx(books["emitted"], rel=1e-12)
    assert books["absorbed"] > 0.95 * books["emitted"]
