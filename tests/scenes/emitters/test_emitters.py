from typing import Any

import numpy as np
import pytest

from scenes import (
    Beam,
    Environment,
    Point,
    RectangleLamp,
    RoundProfile,
    SceneError,
    SlitProfile,
    Spot,
    Sun,
)

ORIGIN = (0.0, 0.0, 0.0)


def test_a_slit_stands_upright_about_its_beam() -> None:
    profile = SlitProfile(width=0.001, height=0.02)
    beam = Beam(flux=1.0, spectrum="E", position=ORIGIN, direction=(5, 0, 0), profile=profile)
    u, v, n = beam.frame()
    np.testing.assert_array_equal(n, [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(v, [0.0, 1.0, 0.0])
    np.testing.assert_array_equal(u, [0.0, 0.0, -1.0])


def test_a_round_beam_has_a_frame_in_every_direction() -> None:
    profile = RoundProfile(radius=0.01)
    beam = Beam(flux=1.0, spectrum="E", position=ORIGIN, direction=(0, -1, 0), profile=profile)
    assert abs(np.linalg.det(np.array(beam.frame()))) == pytest.approx(1.0, abs=1e-15)


def test_a_slit_whose_height_runs_along_the_beam() -> None:
    profile = SlitProfile(width=0.001, height=0.02, up=(1.0, 0.0, 0.0))
    with pytest.raises(SceneError, match=r"profile\.up: must be a direction not parallel"):
        Beam(flux=1.0, spectrum="E", position=ORIGIN, direction=(1, 0, 0), profile=profile)


def test_a_rectangular_lamp_has_the_frame_of_a_rectangle() -> None:
    lamp = RectangleLamp(
        flux=1.0, spectrum="A", position=ORIGIN, size=(0.1, 0.2), normal=(0.0, -1.0, 0.0)
    )
    u, v, n = lamp.frame()
    np.testing.assert_array_equal(n, [0.0, -1.0, 0.0])
    np.testing.assert_array_equal(np.cross(u, v), n)


@pytest.mark.parametrize("flux", [0.0, -1.0, float("nan"), float("inf")])
def test_a_flux_that_is_none(flux: float) -> None:
    with pytest.raises(SceneError, match="flux: must be"):
        Point(flux=flux, spectrum="E", position=ORIGIN)


@pytest.mark.parametrize("half_angle_deg", [0.0, 181.0])
def test_a_cone_that_is_none(half_angle_deg: float) -> None:
    with pytest.raises(SceneError, match="half_angle_deg: must be"):
        Spot(
            flux=1.0,
            spectrum="E",
            position=ORIGIN,
            direction=(1, 0, 0),
            half_angle_deg=half_angle_deg,
        )


@pytest.mark.parametrize("divergence_deg", [-0.1, 90.0])
def test_a_divergence_that_is_none(divergence_deg: float) -> None:
    with pytest.raises(SceneError, match="divergence_deg: must be"):
        Beam(
            flux=1.0,
            spectrum="E",
            position=ORIGIN,
            direction=(1, 0, 0),
            profile=RoundProfile(radius=0.01),
            divergence_deg=divergence_deg,
        )


def test_a_suns_radiance_makes_its_irradiance() -> None:
    sun = Sun(direction=(0.0, -2.0, 0.0), irradiance=1000.0, spectrum="E")
    # E = L ∫ cosθ dω over the disk, in rings: independent of the closed form π L sin²θ.
    theta = np.radians(0.2666) * (np.arange(2000) + 0.5) / 2000
    cosines = 2.0 * np.pi * np.sum(np.sin(theta) * np.cos(theta)) * np.radians(0.2666) / 2000
    assert sun.full_radiance * cosines == pytest.approx(1000.0, rel=1e-6)
    assert sun.direction == (0.0, -1.0, 0.0)


def test_light_from_all_around_comes_in_through_the_whole_of_a_sphere() -> None:
    sky = Environment(radiance=3.0, spectrum="E")
    # Every point of its area 4π R² has the irradiance π L.
    assert sky.flux_through(2.0) == pytest.approx(4.0 * np.pi * 2.0**2 * np.pi * 3.0, rel=1e-14)


@pytest.mark.parametrize(
    ("kind", "fields", "problem"),
    [
        (Sun, {"irradiance": 0.0}, "irradiance: must be"),
        (Sun, {"irradiance": 1.0, "half_angle_deg": 90.0}, "half_angle_deg: must be"),
        (Sun, {"irradiance": 1.0, "half_angle_deg": 0.0}, "half_angle_deg: must be"),
        (Sun, {"irradiance": 1.0, "flux": 1.0}, "flux: unknown key"),
        (Environment, {"radiance": -1.0}, "radiance: must be"),
        (Environment, {"radiance": 1.0, "visible": 1}, "visible: must be"),
    ],
)
def test_light_from_afar_that_cannot_be(
    kind: type[Sun | Environment], fields: dict[str, Any], problem: str
) -> None:
    direction = {"direction": (0.0, -1.0, 0.0)} if kind is Sun else {}
    with pytest.raises(SceneError, match=problem):
        kind(spectrum="E", **direction, **fields)
