"""Light through a mask: as the mask's cells say, in photons, in shadow rays and to the eye."""

import numpy as np
import pytest

import scenes
import sim

MASK = ((0.0, 1.0, 0.5), (0.25, 0.0, 1.0))
"""Rows from the top; who looks into the light sees it like this."""

CELLS = np.array(MASK)
FLUX = 2.0
SETTINGS = {"photons": 20_000, "passes": 1, "radius": 0.02}
FILM = {"first_nm": 500, "last_nm": 600, "bands": 2}
PER_NM = 1.0 / (830.0 - 360.0)


def screen(size):
    return scenes.SceneObject(
        name="screen",
        shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=size, normal=(0.0, 0.0, 1.0)),
        material=scenes.Lambertian(reflectance=1.0),
    )


def beam(divergence_deg=0.0, distance=1.0):
    """A beam along −z, its profile 3 by 2, upright: who looks into it sees +x on the left."""
    profile = scenes.SlitProfile(width=0.3, height=0.2, mask=scenes.Mask(values=MASK))
    return scenes.Beam(
        position=(0.0, 0.0, distance), direction=(0.0, 0.0, -1.0), profile=profile, flux=FLUX,
        spectrum="E", divergence_deg=divergence_deg,
    )


def lamp(**fields):
    return scenes.RectangleLamp(
        position=(0.0, 0.0, 0.05), size=(0.3, 0.2), normal=(0.0, 0.0, -1.0), flux=FLUX,
        spectrum="E", mask=scenes.Mask(values=MASK), **fields,
    )


def picture(objects, emitter, camera, *, size, **settings):
    scene = scenes.Scene(
        objects=objects, emitters=(emitter,), camera=camera,
        film=scenes.Film(width=size[0], height=size[1], **FILM),
    )
    return sim.render(scene, sim.RenderSettings(**(SETTINGS | settings)))


def front(height, **fields):
    """A camera at z = 1 in whose picture of z = 0 `height` metres fill a column."""
    fov_deg = 2.0 * np.degrees(np.arctan(0.5 * height))
    return scenes.Camera(
        position=(0.0, 0.0, 1.0), look_at=(0.0, 0.0, 0.0), fov_deg=fov_deg, **fields
    )


@pytest.mark.parametrize("direct_light", ["lamps", "photons"])
def test_a_collimated_beam_throws_its_mask_on_the_screen(direct_light):
    # One pixel for each cell; a kernel of 0.02 m about its middle, 0.05 m from the edges, reaches
    # into no other but from the pixel's rim: with shadow rays there is no kernel.
    found = picture(
        (screen((1.0, 1.0)),), beam(), front(0.2), size=(3, 2), direct_light=direct_light,
        photons=200_000, passes=4,
    )
    # E = Φ τ / ∫ τ dA, L = E/π; on the screen, from the front, left and right are exchanged.
    expected = FLUX * CELLS[:, ::-1] / (CELLS.sum() * 0.01) / np.pi * PER_NM
    blur = 0.0 if direct_light == "lamps" else 0.15 * expected.max()
    np.testing.assert_allclose(
        found.spectral_radiance[..., 0], expected, rtol=1e-6 if blur == 0.0 else 0.03, atol=blur
    )
    assert found.energy.emitted == pytest.approx(FLUX * 200.0 * PER_NM, rel=1e-6)


@pytest.mark.parametrize(
    "emitter",
    # The narrower of profile and cone is sampled: the cone here, the profile there.
    [beam(2.0, distance=0.3), beam(30.0, distance=0.4), lamp()],
    ids=["narrow cone", "wide cone", "lamp"],
)
def test_shadow_rays_and_photons_agree_on_what_comes_through(assert_mean, emitter):
    view = front(0.16)
    board = (screen((0.5, 0.5)),)
    by_photons, by_rays = (
        np.array([
            picture(
                board, emitter, view, size=(6, 4), seed=seed, direct_light=how,
                photons=40_000, radius=0.01,
            ).spectral_radiance[..., 0]
            for seed in range(12)
        ])
        for how in ("photons", "lamps")
    )  # fmt: skip
    brightest = by_rays.mean(axis=0).max()
    # The kernel's bias is r²/12 of the curvature, here below 1 % where the light changes over 5 cm.
    assert_mean((by_photons - by_rays) / brightest, 0.0, slack=0.01)
    assert by_rays.mean(axis=0).min() < 0.97 * brightest


def test_the_camera_sees_the_mask_upright():
    emitter = scenes.RectangleLamp(
        position=(0.0, 0.0, 0.0), size=(0.3, 0.2), normal=(0.0, 0.0, 1.0), flux=FLUX,
        spectrum="E", mask=scenes.Mask(values=MASK),
    )
    behind = screen((0.5, 0.5)).model_copy(
        update={"shape": scenes.Disk(position=(0.0, 0.0, 2.0), normal=(0.0, 0.0, 1.0), radius=1.0)}
    )
    found = picture((behind,), emitter, front(0.2), size=(3, 2), passes=2, photons=100)
    expected = FLUX * CELLS / (CELLS.sum() * 0.01) / np.pi * PER_NM
    np.testing.assert_allclose(found.spectral_radiance[..., 0], expected, rtol=1e-6)


def test_a_pilot_learns_behind_a_mask_without_bias(assert_mean):
    # A lens behind the mask makes photons of it: with their density learned, the flux is the same.
    lens = scenes.SceneObject(
        name="plate", shape=scenes.Box(position=(0.0, 0.0, 0.5), size=(0.4, 0.4, 0.02)),
        material=scenes.Dielectric(medium=scenes.ConstantMedium(eta=1.5)),
    )  # fmt: skip
    # Of each cell the camera sees the plate's transmittance (1 − R)/(1 + R), R = 0.04, of what
    # comes without it, and a part R² of that from between plate and screen: none of it is black.
    black = scenes.SceneObject(
        name="screen", shape=screen((1.0, 1.0)).shape,
        material=scenes.Lambertian(reflectance=0.5),
    )  # fmt: skip
    view = scenes.Camera(
        position=(0.0, 0.25, 0.4), look_at=(0.0, 0.0, 0.0), up=(0.0, 1.0, 0.0), fov_deg=12.0
    )
    found = [
        picture((black, lens), beam(), view, size=(2, 2), seed=seed, photons=20_000, radius=0.01)
        for seed in range(8)
    ]
    deposited = np.array([one.energy.deposited for one in found])
    flux = FLUX * 200.0 * PER_NM
    transmittance = 0.96 / 1.04
    assert_mean(deposited / flux, transmittance, slack=1e-3)
    assert all(abs(one.energy.residual) < 1e-12 for one in found)
