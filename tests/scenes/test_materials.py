import numpy as np
import pytest

from scenes import Lambertian, ReflectanceTable, SceneError


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


@pytest.mark.parametrize("reflectance", [-0.1, 1.0001, float("nan")])
def test_a_reflectance_that_creates_energy_or_is_none(reflectance: float) -> None:
    with pytest.raises(SceneError, match="reflectance: must be"):
        Lambertian(reflectance=reflectance)


def test_a_table_of_uneven_columns() -> None:
    with pytest.raises(SceneError, match=r"values: must have as many numbers .* \(2\), has 1"):
        ReflectanceTable(wavelength_nm=(400.0, 500.0), values=(0.0,))
