"""The gallery's benches, by single rays: lines and colours meet where the scenes' comments say."""

import numpy as np
import pytest

import scenes
from scenes import Beam, Rectangle
from sim.device import start_device
from sim.scene_data import compile_scene
from sim.single_ray import trace_compiled_rays

LINES_NM = (404.6563, 435.8328, 546.0735, 576.9598, 579.0663)


def rays_through(name, origins, directions, wavelengths_nm):
    start_device("cpu")
    return trace_compiled_rays(
        compile_scene(scenes.load(name)), np.array(origins, dtype=np.float64),
        np.array(directions, dtype=np.float64), np.array(wavelengths_nm, dtype=np.float64),
        max_interactions=12,
    )  # fmt: skip


def foci_mm(name, last_vertex_mm, wavelengths_nm):
    """Where rays near the axis, from the middle of the bars, cross it behind the lens [mm]."""
    count = len(wavelengths_nm)
    paths = rays_through(
        name, [[-0.1, 0.0, 0.0]] * count, [[0.1, 1e-5, 0.0]] * count, wavelengths_nm
    )
    found = []
    for path in paths:
        assert set(path.events[:-1]) == {"refract"}
        point, way = path.points[-2], path.directions[-1]
        found.append(1e3 * (point[0] - way[0] * point[1] / way[1]) - last_vertex_mm)
    return found


# Stated to 0.1 mm; the height of 10 µm above the axis moves a focus by (1e-5/0.05)² of 0.3 m, which
# is far less than that.
FOCI = {
    "singlet": (8.0, {404.7: 275.1, 435.8: 282.2, 486.1: 291.3, 550.0: 300.0, 587.6: 304.0,
                      656.3: 310.0, 700.0: 313.2}),
    "achromat": (17.0, {404.7: 304.6, 435.8: 301.8, 486.1: 300.1, 550.0: 300.0, 587.6: 300.3,
                        656.3: 301.2, 700.0: 301.9}),
}  # fmt: skip


@pytest.mark.parametrize("name", FOCI)
def test_colours_come_to_the_foci_that_the_scene_states(name):
    last_vertex_mm, stated = FOCI[name]
    assert foci_mm(name, last_vertex_mm, list(stated)) == pytest.approx(
        list(stated.values()), abs=0.07
    )


def test_the_singlets_hyperboloids_leave_no_aberration_but_colour():
    # All rays of 550 nm from a focus of a hyperboloid of conic constant -n² meet in one point. The
    # radii are written to 0.1 µm of 50 mm, the conic to 1e-6: errors of 1e-6 of 0.3 m, and a
    # transverse one of that times the slope, 0.05.
    heights = np.linspace(-0.016, 0.016, 9)
    origins = [[-0.1, 0.0, 0.0]] * len(heights)
    directions = [[0.1, height, 0.0] for height in heights]
    paths = rays_through("singlet", origins, directions, [550.0] * len(heights))
    assert {path.objects[-1] for path in paths} == {"screen"}
    assert max(abs(path.points[-1][1]) for path in paths) < 1e-6


def test_the_spectroscope_draws_each_line_sharp_and_in_its_place():
    scene = scenes.load("spectroscope")
    screen = next(one.shape for one in scene.objects if one.name == "screen")
    slit = scene.emitters[0]
    assert isinstance(screen, Rectangle)
    assert isinstance(slit, Beam)
    angles = np.radians(np.linspace(-3.5, 3.5, 9))
    directions = [[np.cos(angle), 0.0, np.sin(angle)] for angle in angles]
    across, middle = screen.frame()[0], np.array(screen.position)
    places = []
    for line_nm in LINES_NM:
        paths = rays_through(
            "spectroscope", [slit.position] * len(angles), directions, [line_nm] * len(angles)
        )
        assert {path.objects[-1] for path in paths} == {"screen"}
        hits = np.array([(path.points[-1] - middle) @ across for path in paths])
        assert np.ptp(hits) < 1e-4  # "the lens's errors add 0.1"
        places.append(hits.mean())
    from_violet = 1e3 * np.abs(np.array(places) - places[0])
    assert from_violet[-1] == pytest.approx(39.0, abs=0.5)
    assert from_violet[-1] - from_violet[-2] == pytest.approx(0.22, abs=0.005)
    # The image of the slit, twice as wide, on a screen inclined by 34.9°.
    width_mm = 2.0 * 0.25 / np.cos(np.radians(34.9))
    assert width_mm == pytest.approx(0.6, abs=0.02)
    assert (np.diff(from_violet)[:3] > 5.0 * width_mm).all()
