"""Values that are allowed but look like slips: a warning with the guess, on the field's path."""

import warnings

import pytest

import scenes
from sim.cli import main

BENCH = """
{head}
[camera]
position = [{camera}, 0, 0]
look_at = [0, 0, 0]
fov_deg = {fov}
{exposure}

[[objects]]
shape = {{ type = "prism", position = [0, 0, 0], apex_deg = {apex}, base = {base}, {length} }}
material = {{ type = "dielectric", medium = {medium} }}

[[emitters]]
type = "point"
position = [{camera}, 0, 0]
flux = 1
spectrum = {spectrum}
"""
SOUND = {
    "head": "", "camera": 1.0, "fov": 40, "apex": 60, "base": 0.05, "medium": '"N-BK7"',
    "spectrum": '"sodium"', "exposure": "",
}  # fmt: skip
SELLMEIER = (
    '{{ type = "sellmeier", b = [1.03961212, 0.231792344, 1.01046945],'
    " c_um2 = [{}], range_nm = [400, 700] }}"
)


def bench(**changed) -> str:
    values = {**SOUND, **changed}
    return BENCH.format(**values, length=f"length = {values['base']}")


def doubts(**changed) -> dict[str, str]:
    """What is said of a bench, by path."""
    text = bench(**changed)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scenes.loads(text)
    assert all(one.category is scenes.SceneWarning for one in caught)
    return {one.message.doubt.path: str(one.message) for one in caught}


def test_a_sound_bench_raises_no_doubt() -> None:
    assert doubts() == {}
    assert doubts(head='length_unit = "mm"', base=50, camera=1000) == {}


@pytest.mark.parametrize("name", scenes.gallery())
def test_the_gallery_raises_no_doubt(name) -> None:
    scenes.load(name)  # warnings are errors here


@pytest.mark.parametrize(
    ("changed", "path", "guess"),
    [
        # 500 mm, divided by 1000 twice and more; 50 mm written without the unit; 0.05 m in mm.
        ({"base": 5e-5, "camera": 1e-3}, "objects[0].shape", "did you mean 0.0829 m?"),
        ({"base": 50, "camera": 100}, "objects[0].shape", 'millimetres, length_unit = "mm"?'),
        (
            {"base": 0.05, "camera": 1, "head": 'length_unit = "mm"'},
            "objects[0].shape",
            'did you mean metres, length_unit = "m"?',
        ),
        ({"camera": 1000}, "camera.position", "the unit of the other lengths"),
        # π/4, π/3 to four digits, and a field of view that is no round angle.
        ({"fov": 0.7853981633974483}, "camera.fov_deg", "did you mean 45?"),
        ({"apex": 1.0472}, "objects[0].shape.apex_deg", "did you mean 60?"),
        ({"fov": 0.6}, "camera.fov_deg", "did you mean 34.4?"),
        (
            {"spectrum": '{ type = "laser", wavelength_nm = 5893 }', "medium": '"air"'},
            "emitters[0].spectrum.wavelength_nm",
            "did you mean 589.3, from ångströms?",
        ),
        (
            {"exposure": "exposure = { shutter_s = 125, f_number = 8 }"},
            "camera.exposure.shutter_s",
            "did you mean 0.008?",
        ),
        (
            {"medium": '{ type = "constant", eta = 0.6593 }'},
            "objects[0].material.medium.eta",
            "did you mean 1.517?",
        ),
        # N-BK7 with the roots of its C: 0.0775 is √0.0060; n_d is 1.64 then, and V_d 4.
        (
            {"medium": SELLMEIER.format("0.0774642, 0.1414, 10.1765")},
            "objects[0].material.medium.c_um2",
            "did you mean [0.0060007, 0.019994, 103.561], C squared?",
        ),
    ],
)
def test_a_slip_is_told_with_a_guess(changed, path, guess) -> None:
    found = doubts(**changed)
    assert list(found) == [path]
    assert found[path].startswith(f"{path}: value ")
    assert found[path].endswith(guess) or guess in found[path]


def test_who_states_the_unit_is_believed() -> None:
    assert doubts(base=50, camera=100, head='length_unit = "m"') == {}
    assert doubts(base=5e-5, camera=1e-3, head='length_unit = "m"') == {}


def test_one_of_two_alike_in_another_unit_is_told() -> None:
    ball = '[[objects]]\nshape = {{ type = "sphere", position = [{}, 0, 0], radius = {} }}\n'
    text = "".join(
        ball.format(*one) + 'material = { type = "absorber" }\n' for one in ((0, 1.5), (9, 0.0015))
    )
    with pytest.warns(scenes.SceneWarning, match=r"^objects\[1\]\.shape\.radius: value 0\.0015 .*"):
        scenes.loads(text)


def told_of(text) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scenes.loads(text)
    return [str(one.message) for one in caught]


THING = '[[objects]]\nshape = {{ {} }}\nmaterial = {{ type = "absorber" }}\n'


def test_the_sides_of_one_thing_may_be_a_thousand_times_one_another() -> None:
    pane = THING.format('type = "box", position = [0, 0, 0], size = [1.0, 1.0, 0.001]')
    assert told_of(pane) == []


def lenslets(count, size) -> str:
    return "".join(
        THING.format(f'type = "sphere", position = [{k}, 0, 0], radius = {size}')
        for k in range(count)
    )


def test_tiny_things_in_stated_millimetres_are_believed_beside_larger_ones() -> None:
    # 300 lenslets of 50 µm on a holder of 400 mm; alone, they are 0.05 m.
    head = 'length_unit = "mm"\n'
    holder = THING.format('type = "box", position = [0, -5, 0], size = [400, 1, 1]')
    assert told_of(head + lenslets(300, 0.025) + holder) == []
    assert all('length_unit = "m"' in one for one in told_of(head + lenslets(2, 0.025)))


def test_of_many_slips_of_a_kind_three_are_told() -> None:
    told = told_of(lenslets(300, 2.5e-5))
    assert [one.split(":")[0] for one in told] == [f"objects[{k}].shape" for k in range(3)]
    assert [one.endswith(" (and 297 more such)") for one in told] == [False, False, True]
    assert len(told_of(lenslets(3, 2.5e-5))) == 3
    assert "more such" not in told_of(lenslets(3, 2.5e-5))[-1]


LAMP = """
[[emitters]]
type = "{}"
position = [0, 0, 0]
direction = [0, 0, 1]
flux = 1
spectrum = "E"
half_angle_deg = {}
"""


@pytest.mark.parametrize(
    ("lamp", "given", "guess"),
    [
        ("spot", 0.262, None),  # 15° in radians to three digits, as one value in a hundred is
        ("spot", 0.2618, "15"),
        ("spot", 1.571, "90"),
        ("spot", 3.1416, "180"),
        ("spot", 3.2289, None),  # 185°, which no cone can have
    ],
)
def test_radians_are_told_by_four_digits_within_the_fields_range(lamp, given, guess) -> None:
    told = told_of(LAMP.format(lamp, given))
    expected = [] if guess is None else [f"did you mean {guess}?"]
    assert [one[one.index("did") :] for one in told] == expected


def test_a_field_of_view_is_guessed_within_its_range() -> None:
    assert doubts(fov=2.618)["camera.fov_deg"].endswith("did you mean 150?")
    assert doubts(fov=3.1416) == {}


@pytest.mark.parametrize(
    ("given", "guess"),
    [("0.55", "micrometres; did you mean 550 nm?"), ("5.5e-7", "metres; did you mean 550 nm?")],
)
def test_a_wavelength_in_another_unit_is_an_error_with_a_guess(given, guess) -> None:
    with pytest.raises(scenes.SceneError, match=guess.replace("?", r"\?")):
        scenes.loads(f"[film]\nfirst_nm = {given}")


def test_a_command_tells_each_on_a_line_of_stderr(tmp_path, capfd) -> None:
    path = tmp_path / "bench.toml"
    path.write_text(bench(fov=0.7854), encoding="utf-8")
    assert main(["explain", str(path)]) == 0
    lines = capfd.readouterr().err.splitlines()
    assert lines == [
        "warning: camera.fov_deg: value 0.7854 (0.7854 radians are 45 degrees); did you mean 45?"
    ]
