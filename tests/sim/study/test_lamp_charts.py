"""What the charts of a lamp promise: its light, up to the sphere's rim and no further."""

import numpy as np
import pytest

import scenes
from sim.errors import SettingsError
from sim.study.lamp_charts import has_extent, make_charts

CENTRE, RADIUS = np.array([0.3, 0.2, -0.1]), 0.4
COMMON = {"flux": 2.0, "spectrum": "E"}
WIDE_SLIT = scenes.SlitProfile(width=2.0, height=1.5)
SPOT_DIRECTION = (0.15, -1.0, -0.05)

LAMPS = {
    "point": scenes.Point(position=(0.1, 1.4, 0.0), **COMMON),
    "wide spot": scenes.Spot(
        position=(0.1, 1.4, 0.0), direction=SPOT_DIRECTION, half_angle_deg=40.0, **COMMON
    ),
    "sphere": scenes.SphereLamp(position=(0.1, 1.4, 0.0), radius=0.3, **COMMON),
    "rectangle": scenes.RectangleLamp(
        position=(0.1, 1.4, 0.0), size=(0.4, 0.2), normal=(0.1, -1.0, 0.2), **COMMON
    ),
    "wide beam": scenes.Beam(
        position=(0.1, 1.4, 0.0), direction=SPOT_DIRECTION,
        profile=scenes.RoundProfile(radius=0.9), **COMMON,
    ),
    "divergent beam": scenes.Beam(
        position=(0.1, 1.4, 0.0), direction=SPOT_DIRECTION, divergence_deg=4.0,
        profile=scenes.RoundProfile(radius=0.9), **COMMON,
    ),
    "wide slit": scenes.Beam(
        position=(0.1, 1.4, 0.0), direction=SPOT_DIRECTION, profile=WIDE_SLIT,
        divergence_deg=4.0, **COMMON,
    ),
}


def sample(chart, count=40):
    """Rays at the middles of count² cells, and the flux of each."""
    edges = np.linspace(0.0, 1.0, count + 1)
    s, t = np.meshgrid(0.5 * (edges[1:] + edges[:-1]), 0.5 * (edges[1:] + edges[:-1]))
    rays = chart.rays(s.ravel(), t.ravel())
    flux = chart.flux * np.tile(np.diff(chart.flux_below(edges)), count) / count
    return rays, flux * rays.intensity


def distance_to_centre(rays):
    offset = CENTRE - rays.origins
    return np.linalg.norm(np.cross(offset, rays.directions), axis=1)


@pytest.mark.parametrize("name", LAMPS)
def test_rays_fill_the_sphere_to_its_rim_and_no_further(name):
    # Chart s = 1 touches the sphere; at s the distance is R sin(π s/2).
    for chart in make_charts(LAMPS[name], CENTRE, RADIUS, 2):
        t = np.linspace(0.0, 1.0, 9)
        for s in (0.0, 0.3, 1.0):
            rays = chart.rays(np.full(9, s), t)
            np.testing.assert_allclose(
                distance_to_centre(rays), RADIUS * np.sin(0.5 * np.pi * s), rtol=1e-8, atol=1e-14
            )
            np.testing.assert_allclose(np.linalg.norm(rays.directions, axis=1), 1.0, rtol=1e-14)


def expected_flux(name):
    """Share of the lamp's light on the sphere, all of which it sees."""
    lamp = LAMPS[name]
    offset = CENTRE - np.asarray(lamp.position)
    d2, sin2 = offset @ offset, RADIUS**2 / (offset @ offset)
    solid = 0.5 * (1.0 - np.sqrt(1.0 - sin2))  # Ω/4π
    if name == "wide spot":
        return solid / np.sin(0.5 * np.radians(lamp.half_angle_deg)) ** 2
    if name == "wide beam":
        return (RADIUS / lamp.profile.radius) ** 2
    if name in ("divergent beam", "wide slit"):
        # The shadow of a slanted beam is larger by 1/cos; over the cone ⟨1/cos θ⟩ ≈ 1 + α²/4.
        tilt = 1.0 + 0.25 * np.radians(lamp.divergence_deg) ** 2
        slit = WIDE_SLIT.width * WIDE_SLIT.height
        profile = slit if name == "wide slit" else np.pi * lamp.profile.radius**2
        return np.pi * RADIUS**2 / profile * tilt
    if name == "rectangle":
        # From a small Lambertian source the sphere gets cos θ R²/d² (all above its horizon).
        u, v, n = lamp.frame()
        s, t = np.meshgrid(*(np.linspace(-0.5, 0.5, 401)[:-1] + 0.5 / 400,) * 2)
        place = s[..., None] * lamp.size[0] * u + t[..., None] * lamp.size[1] * v
        way = offset - place
        r2 = np.sum(way**2, axis=-1)
        return float(np.mean((way @ n) / np.sqrt(r2) * RADIUS**2 / r2))
    if name == "sphere":
        # Φ/(4π) dω of light along ω fills a disk of radius r evenly, and a disk of radius R, at the
        # distance d sin θ, takes the area of their overlap from it.
        theta = (np.arange(4000) + 0.5) * 0.5 * np.pi / 4000
        overlap = overlap_of_disks(np.sqrt(d2) * np.sin(theta), lamp.radius, RADIUS)
        each = 2.0 * np.pi * np.sin(theta) * (0.5 * np.pi / 4000)
        return float(np.sum(each * overlap)) / (4.0 * np.pi * np.pi * lamp.radius**2)
    return solid


def overlap_of_disks(distance, r1, r2):
    """Area that two disks share: two segments (zero or the smaller disk where they do not cut)."""
    def segment(radius, other):
        reach = (distance**2 + radius**2 - other**2) / (2.0 * distance)
        angle = np.arccos(np.clip(reach / radius, -1.0, 1.0))
        return radius**2 * (angle - np.sin(angle) * np.cos(angle))

    return segment(r1, r2) + segment(r2, r1)


@pytest.mark.parametrize("name", LAMPS)
def test_flux_is_the_lamps_on_the_sphere(name):
    charts = make_charts(LAMPS[name], CENTRE, RADIUS, 2)
    total = sum(float(sample(chart)[1].sum()) for chart in charts)
    # Midpoints of 40² cells: (1/40)²/24 of second derivatives of order 10. The slit's tilt is
    # expanded to α² = 5e-3.
    assert total == pytest.approx(expected_flux(name), rel=3e-4)


def test_rays_of_a_glowing_sphere_start_from_it():
    charts = make_charts(LAMPS["sphere"], CENTRE, RADIUS, 2)
    offsets = []
    for chart in charts:
        rays, _ = sample(chart, 10)
        aside = rays.origins - np.asarray(LAMPS["sphere"].position)
        np.testing.assert_allclose(np.sum(aside * rays.directions, axis=1), 0.0, atol=1e-15)
        lengths = np.linalg.norm(aside, axis=1)
        np.testing.assert_allclose(lengths, lengths[0], rtol=1e-12)
        offsets.append((lengths[0] / LAMPS["sphere"].radius) ** 2)
    assert max(offsets) < 1.0
    assert np.mean(offsets) == pytest.approx(0.5, rel=1e-12)  # evenly over the disk: ⟨r²⟩ = 1/2


def test_rays_of_a_beam_start_on_its_profile():
    for name in ("wide beam", "divergent beam", "wide slit"):
        beam = LAMPS[name]
        u, v, n = beam.frame()
        for chart in make_charts(beam, CENTRE, RADIUS, 2):
            offset = sample(chart)[0].origins - np.asarray(beam.position)
            np.testing.assert_allclose(offset @ n, 0.0, atol=1e-14)
            if name == "wide slit":
                assert np.all(np.abs(offset @ u) < 1.0)
                assert np.all(np.abs(offset @ v) < 0.75)
            else:
                assert np.all(np.hypot(offset @ u, offset @ v) < 0.9)


@pytest.mark.parametrize(
    ("profile", "share"),
    [
        (scenes.RoundProfile(radius=0.1), 1.0),  # all of a narrow beam
        (scenes.SlitProfile(width=0.1, height=0.2), 1.0),
        (scenes.SlitProfile(width=4.0, height=0.2), 0.2),  # a rectangle of 2R by the height
    ],
)
def test_a_beam_narrower_than_the_sphere_is_taken_as_it_is(profile, share):
    way = CENTRE - np.array([0.1, 1.4, 0.0])
    beam = scenes.Beam(position=(0.1, 1.4, 0.0), direction=tuple(way), profile=profile, **COMMON)
    (chart,) = make_charts(beam, CENTRE, RADIUS, 2)
    assert chart.flux == pytest.approx(share, rel=1e-6)
    rays, flux = sample(chart)
    assert flux.sum() == pytest.approx(share, rel=1e-6)
    lit = rays.origins - np.asarray(beam.position)
    v = beam.frame()[1]
    assert np.abs(lit @ v).max() < 0.1 + 1e-12


def test_a_beam_that_passes_by_has_no_chart():
    beam = scenes.Beam(
        position=(2.0, 1.4, 0.0), direction=(0, -1, 0), profile=scenes.RoundProfile(radius=0.1),
        **COMMON,
    )
    assert list(make_charts(beam, CENTRE, RADIUS, 2)) == []


def test_a_narrow_spot_is_taken_whole_and_one_that_misses_in_part_is_cut():
    lamp = LAMPS["wide spot"]
    way = tuple(CENTRE - np.asarray(lamp.position))
    narrow = lamp.model_copy(update={"direction": tuple(np.array(way) / np.linalg.norm(way)),
                                     "half_angle_deg": 3.0})
    (chart,) = make_charts(narrow, CENTRE, RADIUS, 2)
    rays, flux = sample(chart)
    assert flux.sum() == pytest.approx(1.0, rel=1e-12)
    angles = np.degrees(np.arccos(rays.directions @ np.array(narrow.direction)))
    assert 2.9 < angles.max() < 3.0
    partly = lamp.model_copy(update={"direction": (0.6, -0.8, 0.0), "half_angle_deg": 20.0})
    (chart,) = make_charts(partly, CENTRE, RADIUS, 2)
    rays, flux = sample(chart, 100)
    lit = rays.intensity > 0.0
    assert 0.1 < lit.mean() < 0.9
    np.testing.assert_array_equal(
        rays.directions @ np.array(partly.direction) > np.cos(np.radians(20.0)), lit
    )
    # Φ dω/(2π (1 − cos h)) where it is lit: the same rays, weighed as those of a point.
    (of_point,) = make_charts(LAMPS["point"], CENTRE, RADIUS, 2)
    all_lit = sample(of_point, 100)[1]
    expected = np.sum(all_lit[lit]) * 2.0 / (1.0 - np.cos(np.radians(20.0)))
    assert flux.sum() == pytest.approx(expected, rel=1e-12)


def test_from_within_the_sphere_all_directions_count():
    (chart,) = make_charts(scenes.Point(position=tuple(CENTRE), **COMMON), CENTRE, RADIUS, 2)
    rays, flux = sample(chart)
    assert flux.sum() == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(flux @ rays.directions, 0.0, atol=1e-3)


def test_a_glowing_sphere_that_overlaps_is_refused():
    lamp = scenes.SphereLamp(position=(0.3, 0.7, -0.1), radius=0.2, **COMMON)
    with pytest.raises(SettingsError, match="does not overlap"):
        make_charts(lamp, CENTRE, RADIUS, 2)


def test_what_has_an_extent():
    assert [name for name, lamp in LAMPS.items() if has_extent(lamp)] == [
        "sphere", "rectangle", "divergent beam", "wide slit",
    ]
