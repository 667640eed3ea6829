"""The bound on what a small change of an index can do: against Snell and Fresnel themselves."""

import numpy as np
import pytest

import scenes
from sim.features import Subject, find_features, judge_features
from sim.features.boundary_error import boundary_error, path_error, relative_variations
from spectra import Cauchy, Medium, Tabulated

AMBIENT = Medium("reference", Cauchy((1.0,)), (0.0, 1e9), "", "air")


def branches(eta, s):
    """Refracted angle [rad] (NaN: none) and unpolarised reflectance, at incidence of sine s.

    sinθ_t = η s; R_s, R_p as in Born & Wolf (1999), §1.5.2 eq. 21.
    """
    x = eta * s
    total = x >= 1.0
    c_i = np.sqrt(1.0 - s * s)
    c_t = np.sqrt(np.where(total, 0.0, 1.0 - x * x))
    r_s = (eta * c_i - c_t) / (eta * c_i + c_t)
    r_p = (c_i - eta * c_t) / (c_i + eta * c_t)
    reflectance = np.where(total, 1.0, 0.5 * (r_s**2 + r_p**2))
    return np.where(total, np.nan, np.arcsin(np.minimum(x, 1.0))), reflectance


def sines(eta):
    """Incidences, dense where light grazes and next to the critical angle."""
    fine = np.geomspace(1e-14, 1.0, 4001)[:-1]
    critical = min(1.0, 1.0 / eta)
    near = np.concatenate([1.0 - fine, critical * (1.0 - fine), critical * (1.0 + fine)])
    return near[(near >= 0.0) & (near < 1.0)]


@pytest.mark.parametrize("eta", [0.3, 0.55, 0.67, 0.9, 0.99, 1.01, 1.1, 1.5, 1.8, 2.4, 3.5])
@pytest.mark.parametrize("variation", [1e-10, 1e-7, 1e-4])
def test_no_ray_changes_by_more_than_the_bound(eta, variation):
    s = sines(eta)
    angle, reflectance = branches(eta, s)
    angle_2, reflectance_2 = branches(eta * (1.0 + variation), s)
    changes = np.abs(reflectance_2 - reflectance)
    turned = np.abs(angle_2 - angle)
    changes = np.maximum(changes, np.where(np.isnan(turned), 0.0, turned))
    bound = boundary_error(eta, variation)
    # 1 − x² of x rounded to 1e-16 is off by some 1e-16, its root by 1e-8 of the worst ray.
    assert changes.max() <= bound + 2e-8
    # And it is no idle one: √Δ is what the worst ray does, out of the denser medium.
    if eta > 1.0:
        assert changes.max() >= 0.05 * bound


def test_the_worst_case_needs_contrast():
    assert boundary_error(1.0, 1e-9) == np.inf
    assert boundary_error(1.5, 1e-9) == boundary_error(1.0 / 1.5, 1e-9)
    assert path_error(1.5, 1e-9) > boundary_error(1.5, 1e-9)
    assert path_error(1.5, 0.0) == 0.0


def subject_of(*media, film=None):
    ball = scenes.Sphere(position=(0.0, 0.0, 0.0), radius=1.0)
    material = scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5))
    item = scenes.SceneObject(shape=ball, material=material)
    scene = scenes.Scene(objects=[item], film=film or scenes.Film())
    return Subject(scene, (AMBIENT, *media), (0,) * (1 + len(media)))


def test_variations_are_those_over_the_films_range():
    # n = 1.5 + 0.01 µm²/λ² over 395 to 705 nm.
    medium = Medium("flint", Cauchy((1.5, 0.01)), (300.0, 900.0), "", "air")
    ((eta, variation),) = relative_variations(subject_of(medium))
    n = 1.5 + 0.01 / np.array([0.395, 0.705]) ** 2
    assert eta == pytest.approx(n[1], rel=1e-14)
    assert variation == pytest.approx(n[0] / n[1] - 1.0, rel=1e-12)


def test_no_knot_of_a_table_is_missed():
    # A spike that no even sampling would find.
    table = Tabulated((395.0, 500.001, 500.002, 500.003, 705.0), (1.5, 1.5, 1.6, 1.5, 1.5))
    medium = Medium("table", table, (395.0, 705.0), "", "air")
    ((_, variation),) = relative_variations(subject_of(medium))
    assert variation == pytest.approx(0.1 / 1.5, rel=1e-12)


def test_media_that_may_touch_are_held_against_each_other():
    # A flint in a liquid of nearly its index: next to that, its dispersion decides everything.
    liquid = scenes.ConstantMedium(eta=1.6)
    flint = scenes.CauchyMedium(a=(1.599, 1e-4), range_nm=(300.0, 900.0))
    shape = scenes.Sphere(position=(0.0, 0.0, 0.0), radius=1.0)

    def subject(gap):
        objects = [
            scenes.SceneObject(shape=shape, material=scenes.Dielectric(medium=liquid)),
            scenes.SceneObject(
                shape=shape.model_copy(update={"position": (2.0 + gap, 0.0, 0.0)}),
                material=scenes.Dielectric(medium=flint),
            ),
        ]
        media = (AMBIENT, liquid.resolved(), flint.resolved())
        return Subject(scenes.Scene(objects=objects), media, (0, 0, 0))

    apart, touching = (relative_variations(subject(gap)) for gap in (1.0, 0.0))
    assert len(apart) == 2
    assert touching[:2] == apart
    eta, variation = touching[2]
    n = 1.599 + 1e-4 / np.array([0.395, 0.705]) ** 2
    assert eta == pytest.approx(n[0] / 1.6, rel=1e-14)
    assert variation == pytest.approx(n[0] / n[1] - 1.0, rel=1e-9)


def test_what_has_no_index_in_the_films_range_is_not_known():
    table = Medium("table", Tabulated((500.0, 600.0), (1.5, 1.4)), (500.0, 600.0), "", "air")
    subject = subject_of(table)
    assert relative_variations(subject) is None
    plan = judge_features(subject, tolerance=0.5)
    assert plan.features.dispersion


def test_dispersion_is_left_out_where_its_bound_is_tolerated():
    def judged(spread, tolerance):
        table = Tabulated((395.0, 705.0), (1.5, 1.5 + spread))
        subject = subject_of(Medium("table", table, (395.0, 705.0), "", "air"))
        return judge_features(subject, tolerance=tolerance)

    # 8 boundaries of √Δ (π/2 + 2√2 (1 + m²)/√(m² − 1)) = 9.79 √Δ at m = 1.5, and some Δ.
    bound = 8.0 * 9.79 * np.sqrt(1e-10 / 1.5)
    assert judged(1e-10, 1e-2).bound == pytest.approx(bound, rel=2e-3)
    assert not judged(1e-10, 1e-2).features.dispersion
    assert judged(1e-10, 1e-6).features.dispersion  # refused at the default tolerance
    # … and what remains is the rounding of Stokes vectors, which a ball does not need.
    assert judged(1e-10, 1e-6).bound <= 1e-11
    assert judged(1e-2, 0.5).features.dispersion
    assert find_features(
        subject_of().scene, [AMBIENT, Medium("c", Cauchy((1.5,)), (1.0, 1e9), "", "air")], [0, 0]
    ).dispersion is False
