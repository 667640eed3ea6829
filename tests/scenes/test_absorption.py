import math

import numpy as np
import pytest

import scenes
from scenes import (
    CoefficientTable,
    ConstantMedium,
    DecadicAbsorption,
    Dielectric,
    ExtinctionAbsorption,
    ExtinctionTable,
    InternalTransmittance,
    NapierianAbsorption,
    SceneError,
    TransmittanceTable,
)
from scenes.absorption import DescribedAbsorption, describe_absorption
from spectra import Absorption, glass, published_absorption

SPHERE = """
length_unit = "{unit}"
[film]
bands = 31
[[objects]]
name = "ball"
shape = {{ type = "sphere", position = [0, 0, 0], radius = {radius} }}
material = {{ type = "dielectric", medium = "N-BK7", absorption = {absorption} }}
"""


def load_ball(absorption: str, *, unit: str = "m", radius: float = 0.01) -> Absorption:
    scene = scenes.loads(SPHERE.format(unit=unit, radius=radius, absorption=absorption))
    material = scene.objects[0].material
    assert isinstance(material, Dielectric)
    resolved = material.resolved()
    assert resolved.dispersion == glass("N-BK7").dispersion
    assert resolved.absorption is not None
    again = scenes.loads(scene.to_toml()).objects[0].material
    assert isinstance(again, Dielectric)
    assert again.resolved().absorption == resolved.absorption
    return resolved.absorption


# Each says of 10 mm that it passes a half at 550 nm: α = ln 2 / 10 mm.
HALF = math.log(2.0) / 0.01
HALVES = {
    "napierian": f'{{ type = "napierian", coefficient = {HALF!r} }}',
    "decadic": f'{{ type = "decadic", coefficient = {math.log10(2.0) / 0.01!r} }}',
    "extinction": f'{{ type = "extinction", k = {HALF * 550e-9 / (4.0 * math.pi)!r} }}',
    "internal transmittance": '{ type = "internal_transmittance", thickness = 0.01,'
    " transmittance = 0.5 }",
}


@pytest.mark.parametrize("kind", HALVES)
def test_all_four_quantities_describe_the_same(kind: str) -> None:
    # Knots between which 1/λ is straightened leave 4e-6 of α; else rounding alone.
    rel = 4e-6 if kind == "extinction" else 1e-15
    assert load_ball(HALVES[kind]).coefficient(550.0) == pytest.approx(HALF, rel=rel)


@pytest.mark.parametrize(
    "absorption",
    [
        '{ type = "napierian", coefficient = { wavelength_nm = [390, 710], values = [0.1, 0.2] } }',
        '{ type = "internal_transmittance", thickness = 10, transmittance = 0.5 }',
        '{ type = "decadic", coefficient = 0.02 }',
    ],
)
def test_coefficients_and_thicknesses_are_in_the_files_unit(absorption: str) -> None:
    in_metres = load_ball(absorption)
    in_millimetres = load_ball(absorption, unit="mm", radius=10.0)
    at = np.array([400.0, 600.0])
    np.testing.assert_allclose(
        in_millimetres.coefficient(at), 1000.0 * in_metres.coefficient(at), rtol=1e-14
    )


def test_an_extinction_coefficient_has_no_unit_and_reaches_as_far_as_the_index() -> None:
    in_metres = load_ball(HALVES["extinction"])
    assert load_ball(HALVES["extinction"], unit="mm", radius=10.0) == in_metres
    assert in_metres.wavelength_range_nm == glass("N-BK7").wavelength_range_nm
    anywhere = ConstantMedium(eta=1.5, absorption=ExtinctionAbsorption(k=1e-6)).resolved()
    assert anywhere.absorption is not None
    assert anywhere.absorption.wavelength_range_nm == (10.0, 1e6)


def test_published_is_what_the_catalogue_knows_of_a_glass() -> None:
    assert load_ball('"published"') == published_absorption("N-BK7")


def test_a_medium_of_the_scene_carries_its_own() -> None:
    absorption = NapierianAbsorption(coefficient=3.0)
    inside = ConstantMedium(eta=1.5, absorption=absorption)
    beside = Dielectric(medium=ConstantMedium(eta=1.5), absorption=absorption)
    assert Dielectric(medium=inside).resolved() == beside.resolved()
    with pytest.raises(SceneError, match="absorption: is given twice"):
        Dielectric(medium=inside, absorption=absorption)


@pytest.mark.parametrize(
    "absorption",
    [
        NapierianAbsorption(coefficient=3.0),
        DecadicAbsorption(coefficient=CoefficientTable(wavelength_nm=(1e2, 1e3), values=(1, 2))),
        ExtinctionAbsorption(k=ExtinctionTable(wavelength_nm=(400.0, 500.0), values=(0.0, 1e-6))),
        InternalTransmittance(
            thickness=0.01,
            transmittance=TransmittanceTable(wavelength_nm=(400.0, 500.0), values=(0.5, 0.9)),
        ),
    ],
)
def test_an_absorption_can_be_described_again(absorption: DescribedAbsorption) -> None:
    resolved = absorption.resolved((400.0, 700.0))
    again = describe_absorption(resolved).resolved((400.0, 700.0))
    assert again.napierian_per_m == resolved.napierian_per_m
    assert again.wavelength_nm == resolved.wavelength_nm


@pytest.mark.parametrize(
    ("absorption", "path", "message"),
    [
        ('{ type = "napierian", coefficient = -1 }', "coefficient", "at least 0, is -1"),
        ('{ type = "decadic", coefficient = 1e40 }', "coefficient", "at most 1e"),
        ('{ type = "extinction", k = -1e-6 }', "k", "at least 0, is -1e-06"),
        ('{ type = "extinction", k = 101 }', "k", "at most 100"),
        (
            '{ type = "extinction", k = { wavelength_nm = [1e2, 5e2, 1e3], values = [0, -1, 0] } }',
            "k.values[1]",
            "at least 0, is -1",
        ),
        (
            '{ type = "napierian", coefficient = { wavelength_nm = [390, 710], values = [1] } }',
            "coefficient.values",
            "at least 2 elements",
        ),
        (
            '{ type = "napierian", coefficient = { wavelength_nm = [710, 390], values = [1, 1] } }',
            "coefficient.wavelength_nm[1]",
            "strictly increasing",
        ),
        (
            '{ type = "internal_transmittance", thickness = 0.01, transmittance = 0 }',
            "transmittance",
            "greater than 0, is 0",
        ),
        (
            '{ type = "internal_transmittance", thickness = 0, transmittance = 0.5 }',
            "thickness",
            "greater than 0, is 0",
        ),
        ('{ type = "internal_transmittance", transmittance = 0.5 }', "thickness", "missing"),
        ('{ type = "absorbance", coefficient = 1 }', "type", "unknown type 'absorbance'"),
        ("{ coefficient = 1 }", "type", "missing; required, one of: decadic, extinction"),
    ],
)
def test_absorptions_that_are_none_are_told_by_their_field(
    absorption: str, path: str, message: str
) -> None:
    with pytest.raises(SceneError) as caught:
        load_ball(absorption)
    (problem,) = caught.value.problems
    assert problem.path == f"objects[0].material.absorption.{path}"
    assert message in problem.message


@pytest.mark.parametrize(
    ("medium", "absorption", "message"),
    [
        ("diamond", "published", "nothing is published of diamond; allowed: 'published' for N-BK7"),
        ("air", "published", "nothing is published of air"),
        (ConstantMedium(eta=1.5), "published", "of a medium of the scene's own"),
        ("N-BK7", "publishd", "must be 'published', or a table"),
        ("N-BK7", 0.5, 'must be a string, or a table with a key "type"'),
    ],
)
def test_words_that_stand_for_no_absorption(
    medium: object, absorption: object, message: str
) -> None:
    with pytest.raises(SceneError, match="absorption: .*" + message):
        Dielectric(medium=medium, absorption=absorption)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("material", "path"),
    [
        (
            'medium = "N-BK7", absorption = { type = "decadic", coefficient = TABLE }',
            "objects[0].material.absorption",
        ),
        (
            'medium = { type = "constant", eta = 1.5,'
            ' absorption = { type = "napierian", coefficient = TABLE } }',
            "objects[0].material.medium.absorption",
        ),
    ],
)
def test_a_table_that_does_not_cover_the_wavelengths_used(material: str, path: str) -> None:
    text = """
        film = { first_nm = 405, last_nm = 695, bands = 30 }
        ambient = AMBIENT
        [[objects]]
        shape = { type = "sphere", position = [0, 0, 0], radius = 1 }
        material = { type = "dielectric", MATERIAL }
    """.replace("MATERIAL", material)
    narrow = "{ wavelength_nm = [410, 700], values = [1, 1] }"
    wide = "{ wavelength_nm = [400, 700], values = [1, 1] }"
    scenes.loads(text.replace("TABLE", wide).replace("AMBIENT", '"air"'))
    with pytest.raises(SceneError) as caught:
        scenes.loads(text.replace("TABLE", narrow).replace("AMBIENT", '"air"'))
    (problem,) = caught.value.problems
    assert problem.path == path
    assert "known between 410 and 700 nm, but the emitters and the film use 400" in problem.message


def test_a_table_of_the_ambient_medium_that_does_not_cover_the_wavelengths_used() -> None:
    absorption = NapierianAbsorption(
        coefficient=CoefficientTable(wavelength_nm=(500.0, 600.0), values=(1.0, 1.0))
    )
    with pytest.raises(SceneError, match=r"ambient\.absorption: the absorption is known between"):
        scenes.Scene(ambient=ConstantMedium(eta=1.3, absorption=absorption))
