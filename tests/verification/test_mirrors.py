"""Mirrors and metals: where images are, and what gold leaves of the light."""

import math

import numpy as np
import pytest

import scenes
from sim import analytic, trace_ray
from spectra import conductor

LASER_NM = 632.8
EPS = float(np.finfo(np.float64).eps)


def flat(material, normal, name="mirror"):
    shape = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(2.0, 2.0), normal=normal)
    return scenes.SceneObject(name=name, shape=shape, material=material)


def test_a_flat_mirror_puts_the_image_as_far_behind():
    # Image of p in the plane n · x = 0: p − 2 (n · p) n (Hecht 2017, §5.4.1).
    normal = np.array([2.0, 3.0, 6.0]) / 7.0
    scene = scenes.Scene(objects=(flat(scenes.Mirror(), tuple(normal.tolist())),))
    point = np.array([0.3, 0.5, 0.7])
    image = point - 2.0 * (normal @ point) * normal
    frame = np.stack(scene.objects[0].shape.frame())
    for u, v in np.random.default_rng(3).uniform(-0.9, 0.9, (20, 2)):
        foot = u * frame[0] + v * frame[1]
        path = trace_ray(scene, point, foot - point, LASER_NM)
        assert path.events == ("mirror", "escape")
        assert path.transmittance == 1.0
        way = path.directions[1]
        back = np.linalg.norm(foot - image)
        np.testing.assert_allclose(foot - back * way, image, rtol=0, atol=16.0 * EPS)


def test_a_mirror_keeps_what_its_table_says():
    table = scenes.ReflectanceTable(wavelength_nm=(500.0, 600.0), values=(0.2, 0.8))
    scene = scenes.Scene(objects=(flat(scenes.Mirror(reflectance=table), (0.0, 1.0, 0.0)),))
    for wavelength_nm, expected in ((450.0, 0.2), (520.0, 0.32), (587.5, 0.725), (650.0, 0.8)):
        path = trace_ray(scene, (0.0, 1.0, 0.0), (0.2, -1.0, 0.1), wavelength_nm)
        assert path.transmittance == pytest.approx(expected, rel=4.0 * EPS)


def reflectance(metal, wavelength_nm, theta_i, outside, weights=(1.0, 1.0)):
    """Mean of |r_s|² and |r_p|² with the complex cosine behind (Born & Wolf 1999, §14.2)."""
    index = (metal.eta(wavelength_nm) + 1j * metal.k(wavelength_nm)) / outside
    cos_i = math.cos(theta_i)
    cos_t = np.sqrt(1.0 - (math.sin(theta_i) / index) ** 2)
    r_s = (cos_i - index * cos_t) / (cos_i + index * cos_t)
    r_p = (index * cos_i - cos_t) / (index * cos_i + cos_t)
    return np.average([abs(r_s) ** 2, abs(r_p) ** 2], weights=weights)


def metal_scene(name, theta, outside):
    way = (math.sin(theta), -math.cos(theta), 0.0)
    start = tuple((-0.5 * np.array(way)).tolist())
    laser = scenes.Laser(wavelength_nm=LASER_NM)
    beam = scenes.Beam(position=start, direction=way, flux=3.0, spectrum=laser,
                       profile=scenes.RoundProfile(radius=1e-3))  # fmt: skip
    ambient = scenes.ConstantMedium(eta=outside) if outside != 1.0 else "reference"
    objects = (flat(scenes.Metal(metal=name), (0.0, 1.0, 0.0), "metal"),)
    return scenes.Scene(ambient=ambient, objects=objects, emitters=(beam,))


@pytest.mark.parametrize("outside", [1.0, 1.5])
@pytest.mark.parametrize("theta_deg", [0.0, 45.0, 85.0])
@pytest.mark.parametrize("name", ["gold", "aluminium"])
def test_a_metal_reflects_what_fresnel_says(trace_passes, name, theta_deg, outside):
    theta = math.radians(theta_deg)
    expected = reflectance(conductor(name), LASER_NM, theta, outside)
    scene = metal_scene(name, theta, outside)
    books = trace_passes(scene, photons=200).books[0]
    assert abs(books.residual) < 1e-12
    assert books.escaped == pytest.approx(expected * books.emitted, rel=1e-12)
    assert books.absorbed == pytest.approx((1.0 - expected) * books.emitted, rel=1e-11)
    path = trace_ray(scene, (-0.5 * math.sin(theta), 0.5 * math.cos(theta), 0.0),
                     (math.sin(theta), -math.cos(theta), 0.0), LASER_NM)  # fmt: skip
    assert path.events == ("mirror", "escape")
    assert path.transmittance == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("mirror_first", [False, True])
def test_the_silvered_back_of_a_plate_sees_glass(mirror_first):
    # Gold evaporated onto a plate meets the light in glass: its index there is (n + ik)/1.5.
    theta = math.radians(30.0)
    plate = scenes.SceneObject(
        name="plate", shape=scenes.Box(position=(0, 0.1, 0), size=(1.5, 0.2, 1.5)),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5)),
    )  # fmt: skip
    gold = flat(scenes.Metal(metal="gold"), (0.0, 1.0, 0.0), "gold")
    scene = scenes.Scene(objects=(gold, plate) if mirror_first else (plate, gold))
    path = trace_ray(scene, (0.0, 0.5, 0.0), (math.sin(theta), -math.cos(theta), 0.0), LASER_NM)
    assert path.events == ("refract", "mirror", "refract", "escape")
    assert path.objects[1] == "gold"
    inside = math.asin(math.sin(theta) / 1.5)
    # What comes through the face is more p than s, by Fresnel's transmittances.
    through = 1.0 - np.array(analytic.fresnel_reflectance(math.cos(theta), 1.0, 1.5)).ravel()
    expected = reflectance(conductor("gold"), LASER_NM, inside, 1.5, through)
    assert 1.0 - path.absorptances[1] == pytest.approx(expected, rel=1e-12)
    # And from behind it is a mirror in air.
    behind = trace_ray(scene, (0.0, -0.5, 0.0), (math.sin(theta), math.cos(theta), 0.0), LASER_NM)
    assert behind.events == ("mirror", "escape")
    assert 1.0 - behind.absorptances[0] == pytest.approx(
        reflectance(conductor("gold"), LASER_NM, theta, 1.0), rel=1e-12
    )
