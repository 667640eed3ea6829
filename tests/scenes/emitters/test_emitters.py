import numpy as np
import pytest

from scenes import Beam, Point, RectangleLamp, RoundProfile, SceneError, SlitProfile, Spot

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
