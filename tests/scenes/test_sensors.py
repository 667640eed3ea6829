"""Sensors in scene files: what is taken, and what is refused with which words."""

import pytest

import scenes
from scenes.sensors import MAX_BINS

RECTANGLE = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0))

FILE = """\
length_unit = "mm"

[film]
bands = 7

[[sensors]]
name = "screen"
type = "irradiance"
shape = {type = "rectangle", position = [0, 0, 10], size = [20, 30], normal = [0, 0, -2]}
pixels = [4, 6]

[[sensors]]
type = "rays"
shape = {type = "disk", position = [0, 0, 0], normal = [0, 1, 0], radius = 5}
sides = "both"
"""


def test_a_file_may_hold_both_kinds():
    scene = scenes.loads(FILE)
    screen, rays = scene.sensors
    assert isinstance(screen, scenes.IrradianceSensor)
    assert isinstance(rays, scenes.RaySensor)
    assert (screen.name, rays.name) == ("screen", "sensors[1]")
    assert screen.shape.size == (0.02, 0.03)  # metres
    assert screen.shape.normal == (0.0, 0.0, -1.0)
    assert (screen.sides, rays.sides) == ("front", "both")
    assert screen.bands_of(scene.film) == 7
    assert screen.bins_of(scene.film) == 4 * 6 * 7
    assert scenes.loads(scene.to_toml()).sensors == scene.sensors


def test_bands_may_be_the_sensors_own():
    sensor = scenes.IrradianceSensor(shape=RECTANGLE, bands=3, pixels=(5, 2))
    assert sensor.bins_of(scenes.Film(bands=11)) == 30


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ('type = "irradiance"', "sensors[0].shape: missing"),
        ('type = "irradiance"\nshape = {type = "sphere", position = [0, 0, 0], radius = 1}',
         "sensors[0].shape.type: unknown type 'sphere'; allowed: disk, rectangle"),
        ('type = "flux"', "sensors[0].type: unknown type 'flux'; allowed: irradiance, rays"),
        ('type = "rays"\nmax_rays = 0', "sensors[0].max_rays: must be greater than 0, is 0"),
        ('type = "irradiance"\npixels = [0, 3]', "sensors[0].pixels[0]: must be at least 1, is 0"),
        ('type = "rays"\nsides = "back"', "sensors[0].sides: must be 'front' or 'both'"),
        ('type = "rays"\npixels = [3, 3]', "unknown key 'pixels'"),
    ],
)
def test_what_is_wrong_is_named(table, words):
    with pytest.raises(scenes.SceneError) as refused:
        scenes.loads(f"[[sensors]]\n{table}\n")
    assert words in str(refused.value)


def test_names_are_unique():
    one = scenes.RaySensor(name="one", shape=RECTANGLE)
    with pytest.raises(scenes.SceneError, match=r"sensors\[1\].name: 'one' is used 2 times"):
        scenes.Scene(sensors=(one, one))


def test_more_bins_than_fit_are_refused_where_most_of_them_are():
    small = scenes.IrradianceSensor(name="small", shape=RECTANGLE, pixels=(8, 8))
    rows = MAX_BINS // (1024 * 31)
    large = scenes.IrradianceSensor(name="large", shape=RECTANGLE, pixels=(1024, rows))
    scenes.Scene(sensors=(large,))
    with pytest.raises(scenes.SceneError) as refused:
        scenes.Scene(sensors=(small, large))
    (problem,) = refused.value.problems
    assert problem.path == "sensors[1].pixels"
    assert f"at most {MAX_BINS} bins" in problem.message


def test_a_measurement_needs_a_sensor_and_light():
    with pytest.raises(scenes.SceneError) as refused:
        scenes.Scene().require_measurable()
    assert [one.path for one in refused.value.problems] == ["emitters", "sensors"]
    lamp = scenes.Point(position=(0.0, 1.0, 0.0), flux=1.0, spectrum="E")
    sensor = scenes.RaySensor(shape=RECTANGLE)
    scenes.Scene(sensors=(sensor,), emitters=(lamp,)).require_measurable()
