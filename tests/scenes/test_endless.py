import pytest

from scenes import (
    CauchyMedium,
    Environment,
    Mirror,
    NapierianAbsorption,
    Plane,
    Scene,
    SceneError,
    SceneObject,
)

SKY = Environment(radiance=1.0, spectrum="E", name="sky")
PLANE = SceneObject(
    shape=Plane(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0)), material=Mirror()
)
INK = CauchyMedium(
    a=(1.3,), range_nm=(300.0, 900.0), absorption=NapierianAbsorption(coefficient=2.0)
)


def test_light_from_afar_does_not_come_through_an_ambient_that_absorbs() -> None:
    with pytest.raises(SceneError, match=r"ambient: must be a medium that does not absorb, .*sky"):
        Scene(ambient=INK, emitters=(SKY,))
    Scene(ambient=INK)


def test_an_endless_mirror_of_light_from_afar() -> None:
    with pytest.raises(SceneError, match=r"objects\[0\]\.shape: a mirror must be finite"):
        Scene(objects=(PLANE,), emitters=(SKY,))
    Scene(objects=(PLANE,))
