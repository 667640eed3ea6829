"""Pass 1 as a picture: the stored photons themselves, where the camera would see them.

Each is a dot of the colour of its wavelength, so that one sees what the map holds before any of it
is gathered: how dense photons lie, and how far a spectrum is spread.

Reference:
    Turnbull, "Physically Correct Refractive Effects", figure "Photon Mapping Pass 1".
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import scenes
from sim.canary import choose_kernels
from sim.device import start_device
from sim.image.camera import compile_camera
from sim.image.survey import survey_view
from sim.line_of_sight import in_sight
from sim.photons.tracing import trace_photons
from sim.render import compile_lamps_for
from sim.settings import RenderSettings
from spectra import encode_srgb, wavelength_to_srgb

__all__ = ["picture_photons"]

FloatArray = npt.NDArray[np.float64]

_DOT = 0.6
"""How far the median pixel that has photons is brought to full brightness."""


def picture_photons(
    scene: scenes.Scene, settings: RenderSettings | None = None
) -> npt.NDArray[np.uint8]:
    """Draw the photons that the first pass stores.

    A photon is drawn where the camera's pinhole sees its place through glass as if there were
    none, and nothing opaque is in the way. A pixel's dots add up, brightness b to 1 − exp(−b).

    Args:
        scene: with a camera, at least one emitter, and at least one diffuse object.
        settings: as for `sim.render.render`; passes are not used.

    Returns:
        Encoded sRGB, shape (height, width, 3), row 0 on top.

    Raises:
        scenes.SceneError: the scene lacks something that a picture needs.
        DeviceError: the device does not exist.
    """
    scene.require_renderable()
    plan = (settings or RenderSettings()).resolved(scene)
    device = start_device(plan.device)
    compiled = choose_kernels(scene, plan, device=device).compiled
    assert scene.camera is not None  # require_renderable has seen to it
    camera = compile_camera(compiled, scene.camera, scene.film)
    edges_nm = scene.film.edges_nm
    survey = survey_view(compiled, camera, float(0.5 * (edges_nm[0] + edges_nm[-1])))
    batch = trace_photons(
        compiled,
        compile_lamps_for(compiled, survey, plan),
        seed=plan.seed,
        pass_index=0,
        max_interactions=plan.max_interactions,
        threads=plan.threads,
        store_direct=plan.direct_light == "photons",
        bounces=plan.bounces,
    )
    photons = batch.to_numpy()
    pixel = _pixels_of(scene, photons["position"])
    inside = np.flatnonzero(pixel >= 0)
    seen = inside[in_sight(compiled, scene.camera.position, photons["position"][inside])]
    dots = _dots(photons["wavelength_nm"][seen], photons["flux"][seen])
    return _developed(scene.film, pixel[seen], dots)


def _pixels_of(scene: scenes.Scene, points: FloatArray) -> npt.NDArray[np.int64]:
    """Number of the pixel that each of (n, 3) world points [m] falls on; −1 outside."""
    assert scene.camera is not None
    film = scene.film
    right, up, backward = scene.camera.frame()
    line = points - np.asarray(scene.camera.position)
    ahead = -(line @ backward)
    scale = 0.5 * film.height / np.tan(0.5 * np.radians(scene.camera.fov_deg))
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.floor(0.5 * film.width + scale * (line @ right) / ahead)
        y = np.floor(0.5 * film.height - scale * (line @ up) / ahead)
    inside = (ahead > 0.0) & (x >= 0) & (x < film.width) & (y >= 0) & (y < film.height)
    column, row = np.where(inside, x, 0).astype(np.int64), np.where(inside, y, 0).astype(np.int64)
    return np.where(inside, row * film.width + column, -1)


def _dots(wavelength_nm: FloatArray, flux: FloatArray) -> FloatArray:
    """(n, 3) what each photon adds to the channels of its pixel, on a scale of its own."""
    dots: FloatArray = wavelength_to_srgb(wavelength_nm) ** 2.2 * flux[:, None]
    return dots


def _developed(
    film: scenes.Film, pixel: npt.NDArray[np.int64], dots: FloatArray
) -> npt.NDArray[np.uint8]:
    """Encoded sRGB of the sums of the dots."""
    size = film.width * film.height
    sums = np.stack([np.bincount(pixel, dots[:, k], size) for k in range(3)], axis=-1)
    level = sums.max(axis=-1)
    if np.any(level > 0.0):
        sums *= -np.log(1.0 - _DOT) / np.median(level[level > 0.0])
    return encode_srgb(1.0 - np.exp(-sums)).reshape(film.height, film.width, 3)
