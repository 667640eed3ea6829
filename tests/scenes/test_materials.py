import numpy as np
import pytest

import scenes
from scenes import Lambertian, Mirror, ReflectanceTable, SceneError


def test_a_constant_reflectance_has_the_shape_of_the_wavelengths() -> None:
    np.testing.assert_array_equal(Lambertian(reflectance=0.5).reflectance_at([400.0, 700.0]), 0.5)
    assert Lambertian(reflectance=1.0).reflectance_at(500.0).shape == ()


def test_a_table_is_linear_between_its_entries_and_constant_beyond() -> None:
    table = ReflectanceTable(wavelength_nm=(400.0, 500.0), values=(0.0, 1.0))
    material = Lambertian(reflectance=table)
    wavelength_nm = [300.0, 400.0, 425.0, 500.0, 900.0]
    np.testing.assert_allclose(
        material.reflectance_at(wavelength_nm), [0.0, 0.0, 0.25, 1.0, 1.0], atol=1e-15
    )


@pytest.mark.parametrize("material", [Lambertian, Mirror])
@pytest.mark.parametrize("reflectance", [-0.1, 1.0001, float("nan")])
def test_a_reflectance_that_creates_energy_or_is_none(
    material: type[Lambertian | Mirror], reflectance: float
) -> None:
    with pytest.raises(SceneError, match="reflectance: must be"):
        material(reflectance=reflectance)


def test_a_mirror_is_ideal_unless_it_says_otherwise() -> None:
    np.testing.assert_array_equal(Mirror().reflectance_at([400.0, 700.0]), 1.0)
    table = ReflectanceTable(wavelength_nm=(400.0, 500.0), values=(0.0, 1.0))
    assert Mirror(reflectance=table).reflectance_at(450.0) == 0.5


@pytest.mark.parametrize(
    "material", ['{ type = "mirror" }', '{ type = "conductor", metal = "gold" }']
)
@pytest.mark.parametrize(
    "shape",
    [
        '{ type = "plane", position = [0, 0, 0], normal = [0, 1, 0] }',
        '{ type = "sphere", position = [0, 0, 0], radius = 1 }',
    ],
)
def test_open_and_closed_shapes_may_be_mirrors(shape: str, material: str) -> None:
    scene = scenes.loads(f"[[objects]]\nshape = {shape}\nmaterial = {material}")
    assert scenes.loads(scene.to_toml()).model_dump() == scene.model_dump()


def test_a_table_of_uneven_columns() -> None:
    with pytest.raises(SceneError, match=r"values: must have as many numbers .* \(2\), has 1"):
        ReflectanceTable(wavelength_nm=(400.0, 500.0), values=(0.0,))
