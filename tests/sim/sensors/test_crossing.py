"""Which photons a sensor counts, how often, and where."""

import numpy as np
import pytest

import scenes
from scenes.frames import rotation_matrix

PHOTONS = 4000
ROTATION_DEG = (13.0, 27.0, 41.0)
"""No coordinate of the box's faces is a round number: heights are as rounding leaves them."""

HALF = 0.05
"""Half the box's size [m]."""
CENTRE = np.array([0.37, -0.21, 0.83])
AXIS = rotation_matrix(ROTATION_DEG)[:, 2]
"""Normal of one face; the beam comes from there."""

BOX = scenes.SceneObject(
    name="box",
    shape=scenes.Box(position=tuple(CENTRE), size=(2 * HALF,) * 3, rotation_deg=ROTATION_DEG),
    material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5)),
)
REFLECTANCE = 0.04
"""((1.5 − 1)/(1.5 + 1))²."""

WALL = scenes.SceneObject(
    name="wall",
    shape=scenes.Rectangle(
        position=tuple(CENTRE - 4 * HALF * AXIS), size=(1.0, 1.0), normal=tuple(AXIS)
    ),
    material=scenes.Absorber(),
)


def beam(tilt=0.0):
    direction = -np.cos(tilt) * AXIS + np.sin(tilt) * rotation_matrix(ROTATION_DEG)[:, 0]
    return scenes.Beam(
        position=tuple(CENTRE - 5 * HALF * direction), direction=tuple(direction), flux=1.0,
        spectrum=scenes.SpectrumTable(wavelength_nm=(400.0, 700.0), values=(1.0, 1.0)),
        profile=scenes.RoundProfile(radius=0.4 * HALF),
    )


def ray_sensor(name, height, *, sides="front", turned=False):
    """A sensor across the axis, at a height above the box's centre in half sizes."""
    place = tuple(CENTRE + height * HALF * AXIS)
    normal = tuple(-AXIS if turned else AXIS)
    shape = scenes.Rectangle(position=place, size=(2 * HALF, 2 * HALF), normal=normal)
    return scenes.RaySensor(name=name, shape=shape, sides=sides)


HEIGHTS = {
    "before": 2.0, "entrance": 1.0, "middle": 0.0, "exit": -1.0, "behind": -2.0, "wall": -4.0
}


def scene_of(sensors, lamp=None, objects=(BOX, WALL)):
    film = scenes.Film(first_nm=425.0, last_nm=675.0, bands=6)
    return scenes.Scene(objects=objects, emitters=(lamp or beam(),), sensors=sensors, film=film)


@pytest.fixture(scope="module", params=["float64", "float32"])
def through(request, trace_crossings):
    """Rays by the name of their sensor: fronts to the beam, backs to the beam, and both."""
    kinds = {
        "front": {}, "back": {"turned": True}, "both": {"sides": "both"},
    }
    sensors = tuple(
        ray_sensor(f"{name} {kind}", height, **options)
        for name, height in HEIGHTS.items() for kind, options in kinds.items()
    )
    batch = trace_crossings(scene_of(sensors), photons=PHOTONS, precision=request.param)
    rays = batch.crossings.rays
    return {
        one.name: {key: column[rays["sensor"] == row] for key, column in rays.items()}
        for row, one in enumerate(sensors)
    }, batch


def straight(rays):
    """Those that have only been refracted so far."""
    return {name: column[(rays["history"] >> 10) & 1023 == 0] for name, column in rays.items()}


@pytest.mark.parametrize("name", list(HEIGHTS))
def test_what_goes_through_counts_once(through, name):
    # Every photon of the beam enters the box and leaves it straight on, at normal incidence.
    rays = straight(through[0][f"{name} front"])
    assert len(rays["flux"]) == PHOTONS
    # Flush with a face counts what arrives at it, which has not passed it yet.
    passed = {"before": 0, "entrance": 0, "middle": 1, "exit": 1, "behind": 2, "wall": 2}[name]
    assert np.all(rays["history"] & 1023 == passed)
    expected = (1.0 - REFLECTANCE) ** passed
    assert rays["flux"].sum() == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("name", list(HEIGHTS))
def test_fronts_and_backs_add_up_to_both(through, name):
    front, back, both = (through[0][f"{name} {kind}"] for kind in ("front", "back", "both"))
    assert len(front["flux"]) + len(back["flux"]) == len(both["flux"])
    assert both["flux"].sum() == pytest.approx(front["flux"].sum() + back["flux"].sum(), rel=1e-12)
    # The beam goes against the axis.
    assert np.all(front["direction"] @ AXIS < 0.0)
    assert np.all(back["direction"] @ AXIS > 0.0)
    assert (len(back["flux"]) > 0) == (name in {"before", "entrance", "middle"})


def test_reflected_light_arrives_at_the_back_of_what_it_left_only_beyond(through):
    # What the entrance reflects leaves it, and has not arrived there: nothing outside the glass
    # comes back to it. Inside, the exit sends R (1 − R) back to it, and that (1 − R) R³ more.
    rays = through[0]["entrance back"]
    inner = REFLECTANCE * (1.0 - REFLECTANCE) * (1.0 + REFLECTANCE**2)
    assert rays["flux"].sum() == pytest.approx(inner, rel=0.02)  # beyond, roulette
    outer = through[0]["before back"]["flux"].sum()
    expected = REFLECTANCE + (1.0 - REFLECTANCE) * inner
    assert outer == pytest.approx(expected, rel=0.02)


def test_places_are_on_the_sensor_and_on_the_ray(through):
    rays = through[0]["middle front"]
    tolerance = 1e-12 if rays["wavelength_nm"].dtype == np.float64 else 1e-6
    height = (rays["position"] - CENTRE) @ AXIS
    np.testing.assert_allclose(height, 0.0, atol=tolerance)
    np.testing.assert_allclose(rays["direction"] @ AXIS, -1.0, rtol=tolerance)


def test_the_wall_gets_what_its_sensor_counts(through):
    rays, batch = through
    assert rays["wall front"]["flux"].sum() == pytest.approx(batch.books.absorbed, rel=1e-6)


def test_lots_are_even_and_no_two_rays_share_one(through):
    lots = np.concatenate([rays["lot"] for rays in through[0].values()])
    lot, times = np.unique(lots, return_counts=True)
    # All sensors that one segment crosses share its lot; n²/2⁵⁴ pairs of segments by accident.
    assert len(lot) > 2 * PHOTONS
    assert times.max() <= 2 * len(HEIGHTS)
    # Of 53 bits, the last one set in half of them: with 24, what is kept of more than 2²⁴ rays for
    # each place there is could not be thinned further, since their lots are zero.
    odd = np.mean((lot * 2.0**53) % 2.0)
    assert abs(odd - 0.5) < 5.0 * 0.5 / np.sqrt(len(lot))
    # Kolmogorov–Smirnov: beyond 1.95/√n with probability 1e-3.
    n = len(lot)
    assert np.abs(lot - (np.arange(n) + 0.5) / n).max() < 1.95 / np.sqrt(n)


def test_bins_are_as_who_looks_at_the_front_sees_them(trace_crossings):
    # A slit beam onto one cell: up is the height, and u = up × normal is to the right of who
    # looks along −normal.
    place = scenes.Rectangle(
        position=(0.0, 0.0, 0.0), size=(0.4, 0.3), normal=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0)
    )
    sensor = scenes.IrradianceSensor(name="cells", shape=place, pixels=(4, 3), bands=3)
    spectrum = scenes.SpectrumTable(wavelength_nm=(510.0, 590.0), values=(1.0, 1.0))
    lamp = scenes.Beam(
        position=(0.15, 0.1, 1.0), direction=(0.0, 0.0, -1.0), flux=2.0, spectrum=spectrum,
        profile=scenes.SlitProfile(width=0.1, height=0.1),
    )
    flux = trace_crossings(scene_of((sensor,), lamp, ()), photons=PHOTONS).crossings.flux
    expected = np.zeros((3, 4, 3))
    expected[0, 3, 1] = 2.0  # top row, last column, 500 to 600 nm of 400 to 700
    np.testing.assert_allclose(flux.reshape(3, 4, 3), expected, rtol=1e-9)


def test_nothing_counts_beyond_the_edge_or_behind_what_stops_it(trace_crossings):
    disk = scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=0.1)
    square = scenes.Rectangle(position=(0.0, -0.5, 0.0), size=(0.2, 0.2))
    below = scenes.Rectangle(position=(0.0, -2.0, 0.0), size=(4.0, 4.0))
    sensors = tuple(
        scenes.RaySensor(name=name, shape=shape)
        for name, shape in (("disk", disk), ("square", square), ("hidden", below))
    )
    floor = WALL.model_copy(
        update={"shape": scenes.Rectangle(position=(0.0, -1.0, 0.0), size=(4.0, 4.0))}
    )
    lamp = scenes.Beam(
        position=(0.0, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=1.0, spectrum="E",
        profile=scenes.SlitProfile(width=0.4, height=0.4),
    )
    # A box aside keeps the kernel that of the other scenes here.
    batch = trace_crossings(scene_of(sensors, lamp, (floor, BOX)), photons=16384)
    rays = batch.crossings.rays
    share = [rays["flux"][rays["sensor"] == row].sum() / batch.books.emitted for row in range(3)]
    # Areas over that of the beam; a low-discrepancy sequence is off by less than 1/√n.
    assert share[0] == pytest.approx(np.pi / 16.0, abs=16384**-0.5)
    assert share[1] == pytest.approx(0.25, abs=16384**-0.5)
    assert share[2] == 0.0
    radii = np.hypot(*(rays["position"][rays["sensor"] == 0][:, [0, 2]].T))
    assert radii.max() <= 0.1


def test_threads_and_full_slots_change_nothing(trace_crossings):
    sensors = (
        ray_sensor("rays", 2.0, sides="both"),
        scenes.IrradianceSensor(name="bins", shape=ray_sensor("", -2.0).shape, pixels=(8, 8)),
        *(ray_sensor(f"more {k}", 1.5, sides="both") for k in range(30)),
    )
    one, other = (
        trace_crossings(scene_of(sensors), photons=1000, threads=threads, range_size=256).crossings
        for threads in (1, 2)
    )
    np.testing.assert_array_equal(one.flux, other.flux)
    for name, column in one.rays.items():
        np.testing.assert_array_equal(column, other.rays[name])
    # 31 sensors keep each photon twice: more than the 24 that a pass has slots for at first.
    assert len(one.rays["lot"]) > 31 * 1000
