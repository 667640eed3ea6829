"""What a scene requires of the polarisation of light, and what a user may ask for."""

import pytest

import scenes
from sim.errors import SettingsError
from sim.features import plan_features
from sim.settings import RenderSettings

GLASS = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
ORIGIN = (0.0, 0.0, 0.0)
BALL = (scenes.Sphere(position=ORIGIN, radius=1.0), GLASS)
OTHER_BALL = (scenes.Sphere(position=(3.0, 0.0, 0.0), radius=1.0), GLASS)
SHEET = (
    scenes.Disk(position=(0.0, 2.0, 0.0), normal=(0.0, 1.0, 0.0), radius=1.0),
    scenes.Polariser(axis=(1.0, 0.0, 0.0)),
)
FLOOR = (
    scenes.Plane(position=(0.0, -1.0, 0.0), normal=(0.0, 1.0, 0.0)),
    scenes.Lambertian(reflectance=0.5),
)
MIRROR = (scenes.Rectangle(position=(0.0, 5.0, 0.0), size=(1.0, 1.0)), scenes.Mirror())


def light_of(*objects, lamp=None, **settings):
    """How photons and camera paths are followed."""
    scene = scenes.Scene(
        objects=[scenes.SceneObject(shape=shape, material=what) for shape, what in objects],
        emitters=[
            scenes.Point(
                flux=1.0, spectrum="E", position=(0.0, 3.0, 0.0), polarisation=lamp
            )
        ],
    )
    features = plan_features(scene, RenderSettings(**settings).resolved(scene)).features
    return features.light_of("photons"), features.light_of("camera")


@pytest.mark.parametrize(
    ("objects", "expected"),
    [
        ([FLOOR], ("averaged", "averaged")),
        ([FLOOR, MIRROR], ("averaged", "averaged")),  # it reflects all light alike
        ([FLOOR, BALL], ("s-p", "s-p")),
        ([FLOOR, BALL, OTHER_BALL], ("stokes", "stokes")),
        ([FLOOR, SHEET], ("stokes", "stokes")),
        ([FLOOR, BALL, MIRROR], ("s-p", "stokes")),  # about an axis that the lamp is on
    ],
)
def test_a_scene_gets_what_it_requires(objects, expected):
    assert light_of(*objects) == expected


def test_polarised_lamps_need_stokes_vectors_only_where_there_is_a_surface():
    light = scenes.Polarisation(degree=0.5)
    assert light_of(FLOOR, BALL, lamp=light) == ("stokes", "stokes")
    assert light_of(FLOOR, lamp=light) == ("averaged", "averaged")


@pytest.mark.parametrize("choice", ["averaged", "s-p", "stokes"])
@pytest.mark.parametrize("features", ["required", "all"])
@pytest.mark.parametrize("objects", [[BALL], [BALL, OTHER_BALL]])
def test_a_choice_is_followed(choice, features, objects):
    assert light_of(*objects, polarisation=choice, features=features) == (choice, choice)


def test_everything_is_stokes_vectors():
    assert light_of(BALL, features="all") == ("stokes", "stokes")
    # Without tolerance, not even the roundings may differ.
    assert light_of(BALL, omission_tolerance=0.0) == ("stokes", "stokes")


def test_the_eye_and_what_bounces_come_from_anywhere():
    lens = scenes.Lens(
        position=ORIGIN, axis=(0.0, 1.0, 0.0), thickness=0.2, aperture=0.5,
        first={"radius": 1.0}, second={"radius": -1.0},
    )  # fmt: skip
    assert light_of(FLOOR, (lens, GLASS)) == ("s-p", "stokes")
    assert light_of(FLOOR, (lens, GLASS), bounces=1) == ("stokes", "stokes")


@pytest.mark.parametrize(
    ("objects", "lamp", "name"),
    [([BALL, SHEET], None, r"objects\[1\]"), ([BALL], scenes.Polarisation(), r"emitters\[0\]")],
)
def test_shares_cannot_follow_what_is_slantwise(objects, lamp, name):
    with pytest.raises(SettingsError, match=f"polarisation.*'s-p'.*{name} polarises"):
        light_of(*objects, lamp=lamp, polarisation="s-p")
    assert light_of(*objects, lamp=lamp, polarisation="averaged") == ("averaged", "averaged")
