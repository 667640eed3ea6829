from collections.abc import Callable

import pytest

import scenes
from scenes import Problem, Scene, SceneError
from spectra import glass

Load = Callable[[str], dict[str, Problem]]

FLOOR = """
[[objects]]
shape = { type = "plane", position = [0, 0, 0], normal = [0, 1, 0] }
material = { type = "lambertian", reflectance = 0.8 }
"""
CAMERA = "[camera]\nposition = [0, 1, 1]\nlook_at = [0, 0, 0]\nfov_deg = 40\n"


def ball(medium: str, name: str = "") -> str:
    named = f'name = "{name}"\n' if name else ""
    return f"""
[[objects]]
{named}shape = {{ type = "sphere", position = [0, 1, 0], radius = 0.5 }}
material = {{ type = "dielectric", medium = {medium} }}
"""


def point(spectrum: str) -> str:
    return f'[[emitters]]\ntype = "point"\nposition = [0, 2, 0]\nflux = 1\nspectrum = {spectrum}\n'


def laser(wavelength_nm: float) -> str:
    return f'{{ type = "laser", wavelength_nm = {wavelength_nm} }}'


def test_what_has_no_name_is_called_by_its_place() -> None:
    scene = scenes.loads(FLOOR + ball('"SF11"', "ball") + point('"E"'))
    assert [one.name for one in scene.objects] == ["objects[0]", "ball"]
    assert [one.name for one in scene.emitters] == ["emitters[0]"]


def test_names_must_be_unique(problems: Load) -> None:
    found = problems(ball('"SF11"', "ball") + FLOOR + ball('"SF11"', "ball"))
    assert list(found) == ["objects[0].name", "objects[2].name"]
    assert found["objects[2].name"].message == "'ball' is used 2 times"


def test_a_dielectric_needs_a_volume(problems: Load) -> None:
    found = problems(
        FLOOR.replace('"lambertian", reflectance = 0.8', '"dielectric", medium="SF11"')
    )
    message = found["objects[0].material.type"].message
    assert message.startswith("a plane encloses no volume")


def test_a_glass_must_cover_the_wavelengths_that_are_used(problems: Load) -> None:
    film = "[film]\nfirst_nm = 350\nlast_nm = 700\n"
    found = problems(film + ball('"SF11"') + point('"E"'))
    # D65, A and E are defined from 360 nm; SF11 is known from 390 nm.
    assert found["objects[0].material.medium"].message.startswith(
        "SF11 is known between 390 and 2500 nm, but the emitters and the film use 360 to"
    )


def test_wavelengths_that_no_emitter_emits_do_not_count() -> None:
    film = "[film]\nfirst_nm = 350\nlast_nm = 700\n"
    scenes.loads(film + ball('"SF11"') + point(laser(589.0)))


def test_wavelengths_that_the_film_does_not_record_do_not_count() -> None:
    scenes.loads(ball('"SF11"') + point(laser(380.0)) + point('"E"'))


def test_without_emitters_the_whole_film_counts(problems: Load) -> None:
    film = "[film]\nfirst_nm = 350\nlast_nm = 700\n"
    assert "objects[0].material.medium" in problems(film + ball('"SF11"'))


def test_problems_between_the_parts_are_found_beside_those_in_a_part(problems: Load) -> None:
    film = "[film]\nfirst_nm = 350\nlast_nm = 700\n"
    wrong = ball('"N-BK8"') + point('"D66"')
    found = problems(film + CAMERA.replace("40", "0") + ball('"SF11"') + wrong + point('"E"'))
    assert sorted(found) == [
        "camera.fov_deg",
        "emitters[0].spectrum",
        "objects[0].material.medium",
        "objects[1].material.medium",
    ]


@pytest.mark.parametrize("ambient", ["reference", "air", "vacuum"])
def test_what_surrounds_the_scene_by_word(ambient: str) -> None:
    assert scenes.loads(f'ambient = "{ambient}"').resolved_ambient() == ambient


def test_a_scene_under_water() -> None:
    assert scenes.loads('ambient = "water"').resolved_ambient() == glass("water")
    oil = scenes.loads('ambient = { type = "constant", eta = 1.47 }').resolved_ambient()
    assert not isinstance(oil, str)
    assert oil.eta(500.0) == 1.47


def test_an_unknown_surrounding_lists_words_and_glasses(problems: Load) -> None:
    message = problems('ambient = "vaccuum"')["ambient"].message
    assert message.startswith("unknown glass 'vaccuum'; nearest: vacuum")


def test_the_surrounding_must_cover_the_wavelengths_too(problems: Load) -> None:
    found = problems('ambient = "diamond"\n[film]\nfirst_nm = 700\nlast_nm = 800\n')
    assert "diamond is known between 226 and 760 nm" in found["ambient"].message


def test_air_and_vacuum_can_be_converted_only_where_air_is_known(problems: Load) -> None:
    # Ciddor's formula is used from 230 to 1690 nm; sapphire, relative to air, reaches 5000 nm.
    film = "[film]\nfirst_nm = 3000\nlast_nm = 3300\n"
    scenes.loads(film + ball('"sapphire"'))
    scenes.loads('ambient = "air"\n' + film + ball('"sapphire"'))
    assert "ambient" in problems('ambient = "vacuum"\n' + film + ball('"sapphire"'))


def test_a_scene_built_in_python_is_the_scene_of_its_text() -> None:
    built = Scene(
        title="A ball",
        camera=scenes.Camera(position=(0.0, 1.0, 1.0), look_at=(0.0, 0.0, 0.0), fov_deg=40.0),
        objects=(
            scenes.SceneObject(
                shape=scenes.Lens(
                    position=(0.0, 0.0, 0.0),
                    axis=(1.0, 2.0, 3.0),
                    thickness=0.01,
                    aperture=0.05,
                    first=scenes.LensSurface(radius=0.1),
                    second=scenes.LensSurface(curvature=-3.0, conic=-1.0),
                ),
                material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5)),
            ),
        ),
        emitters=(
            scenes.Beam(
                flux=1.0,
                spectrum=scenes.Lines(wavelength_nm=(500.0, 600.0), weights=(1.0, 2.0)),
                position=(0.0, 1.0, 0.0),
                direction=(0.3, -0.2, 0.1),
                profile=scenes.SlitProfile(width=0.001, height=0.02),
            ),
        ),
    )
    assert built.source_text == built.to_toml()
    assert scenes.loads(built.to_toml()).model_dump() == built.model_dump()


def test_a_changed_copy_does_not_claim_its_files_text() -> None:
    scene = scenes.loads(FLOOR, name="floor")
    assert scene.source_text == FLOOR
    assert scene.source_name == "floor"
    assert scene.model_copy().source_text == FLOOR
    changed = scene.model_copy(update={"title": "new"})
    assert changed.source_text == changed.to_toml()


def test_a_scene_can_be_a_key() -> None:
    assert hash(scenes.load("prism")) == hash(scenes.load("prism"))


def test_a_complete_scene_is_renderable() -> None:
    scenes.loads(CAMERA + FLOOR + point('"E"')).require_renderable()


def test_everything_a_picture_lacks_is_said_at_once() -> None:
    with pytest.raises(SceneError) as caught:
        scenes.loads(ball('"SF11"'), name="bench").require_renderable()
    lines = str(caught.value).splitlines()
    assert lines[0] == "bench: 3 problems"
    assert lines[1].strip().startswith("camera: missing; a picture needs a table [camera]")
    assert lines[2].strip().startswith("emitters: missing; a picture needs at least one")
    assert lines[3].strip().startswith("objects: missing; a picture needs at least one")


def test_light_that_the_film_does_not_record_makes_no_picture() -> None:
    scene = scenes.loads(CAMERA + FLOOR + point(laser(1064.0)))
    with pytest.raises(SceneError, match="emitters: none gives light that the film records"):
        scene.require_renderable()
