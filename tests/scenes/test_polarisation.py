"""How light vibrates where it starts, against Born & Wolf 1999, §1.4.2 eq. (45)."""

import numpy as np
import pytest

from scenes import Beam, Point, Polarisation, RoundProfile, SceneError, loads


@pytest.mark.parametrize(
    ("fields", "stokes"),
    [
        ({}, (1.0, 0.0, 0.0)),
        ({"angle_deg": 45.0}, (0.0, 1.0, 0.0)),
        ({"angle_deg": -45.0}, (0.0, -1.0, 0.0)),
        ({"angle_deg": 90.0, "degree": 0.25}, (-0.25, 0.0, 0.0)),
        ({"ellipticity_deg": 45.0}, (0.0, 0.0, 1.0)),
        ({"ellipticity_deg": -45.0, "angle_deg": 12.0}, (0.0, 0.0, -1.0)),
        ({"angle_deg": 15.0, "ellipticity_deg": 15.0}, (0.75, 0.75 / 3**0.5, 0.5)),
        ({"degree": 0.0}, (0.0, 0.0, 0.0)),
    ],
)
def test_stokes_vectors(fields: dict[str, float], stokes: tuple[float, float, float]) -> None:
    # P (cos 2χ cos 2ψ, cos 2χ sin 2ψ, sin 2χ)
    np.testing.assert_allclose(Polarisation(**fields).stokes(), stokes, rtol=0, atol=4e-16)


def test_angles_are_counted_from_up_as_seen_across_the_ray() -> None:
    reference = Polarisation(up=(1.0, 2.0, 0.0)).reference((1.0, 0.0, 0.0))
    np.testing.assert_allclose(reference, [0.0, 1.0, 0.0], atol=1e-15)
    reference = Polarisation().reference((0.0, -1.0, 0.0))  # down: from −z
    np.testing.assert_allclose(reference, [0.0, 0.0, -1.0], atol=1e-15)


@pytest.mark.parametrize(
    "fields", [{"degree": 1.1}, {"degree": -0.1}, {"ellipticity_deg": 46.0}, {"up": (0, 0, 0)}]
)
def test_light_that_is_none(fields: dict[str, object]) -> None:
    with pytest.raises(SceneError, match=f"{next(iter(fields))}: must"):
        Polarisation(**fields)  # type: ignore[arg-type]


def test_up_along_the_light() -> None:
    light = Polarisation(up=(1.0, 0.0, 0.0))
    with pytest.raises(SceneError, match=r"polarisation\.up: must be a direction not parallel"):
        Beam(
            flux=1.0, spectrum="E", position=(0, 0, 0), direction=(1, 0, 0),
            profile=RoundProfile(radius=0.01), polarisation=light,
        )  # fmt: skip
    # A point shines everywhere: there is always some ray along `up`, and nothing to refuse.
    assert Point(flux=1.0, spectrum="E", position=(0, 0, 0), polarisation=light).axis is None


def test_a_file_may_polarise_its_lamps() -> None:
    scene = loads(
        """
        title = "polarised"
        [[emitters]]
        type = "point"
        position = [0, 0, 0]
        flux = 1.0
        spectrum = "E"
        polarisation = {angle_deg = 30, degree = 0.5}
        """
    )
    light = scene.emitters[0].polarisation
    assert light is not None
    assert (light.angle_deg, light.degree, light.up) == (30.0, 0.5, None)
