import numpy as np
import pytest

from scenes import Disk, Plane, Polariser, Rectangle, SceneError, SceneObject, Sphere

ORIGIN = (0.0, 0.0, 0.0)


def test_the_absorbing_axis_lies_in_the_sheet_and_across_the_axis() -> None:
    sheet = Polariser(axis=(1.0, 1.0, 5.0))
    absorbing = sheet.absorbing_axis((0.0, 0.0, 1.0))
    np.testing.assert_allclose(absorbing, np.array([-1.0, 1.0, 0.0]) / 2**0.5, atol=1e-15)


@pytest.mark.parametrize(
    "shape",
    [
        Rectangle(position=ORIGIN, size=(1.0, 1.0)),
        Disk(position=ORIGIN, normal=(0.0, 1.0, 0.0), radius=1.0),
        Plane(position=ORIGIN, normal=(0.0, 1.0, 0.0)),
    ],
)
def test_a_polariser_is_a_sheet(shape: Rectangle | Disk | Plane) -> None:
    assert SceneObject(shape=shape, material=Polariser(axis=(1, 0, 0))).shape is shape
    with pytest.raises(SceneError, match=r"material\.axis: is perpendicular to the sheet"):
        SceneObject(shape=shape, material=Polariser(axis=(0, 2, 0)))


def test_a_polariser_is_no_solid() -> None:
    ball = Sphere(position=ORIGIN, radius=1.0)
    with pytest.raises(SceneError, match=r"shape\.type: .* a sphere is none; allowed: rectangle"):
        SceneObject(shape=ball, material=Polariser(axis=(1, 0, 0)))
