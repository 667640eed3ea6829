"""What tests of several packages share: small scenes, their photons, and statistics."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from scenes import Scene
    from sim import Picture
    from sim.photons.aiming import Guide
    from sim.photons.energy import EnergyBooks
    from sim.photons.lamps import Lamps

SMALL_SCENE = """\
title = "A small scene: a beam through a ball of glass onto a floor"

[film]
width = 12
height = 8
bands = 4
first_nm = 430
last_nm = 670

[camera]
position = [0.0, 2.0, 4.0]
look_at = [0.0, 0.5, 0.0]
fov_deg = 40.0

[render]
photons = 2000
passes = 2

[[objects]]
name = "ball"
shape = {type = "sphere", position = [0.0, 1.0, 0.0], radius = 0.5}
material = {type = "dielectric", medium = "N-BK7"}

[[objects]]
name = "floor"
shape = {type = "rectangle", position = [0.0, 0.0, 0.0], size = [4.0, 4.0]}
material = {type = "lambertian", reflectance = 0.8}

[[emitters]]
name = "lamp"
type = "beam"
position = [0.0, 3.0, 0.0]
direction = [0.0, -1.0, 0.0]
profile = {type = "round", radius = 0.4}
flux = 1.0
spectrum = "D65"
"""


@pytest.fixture(scope="session")
def small_scene() -> Scene:
    import scenes

    return scenes.loads(SMALL_SCENE, name="small")


@pytest.fixture
def synthetic_picture(small_scene: Scene) -> Picture:
    """A picture of made-up numbers, different in every pixel and band, not all of them in gamut."""
    from sim.image.accuracy import Accuracy
    from sim.image.picture import Picture
    from sim.photons.energy import EnergyBooks
    from sim.settings import RenderSettings
    from spectra.observer import observer

    film = small_scene.film
    shape = (film.height, film.width, film.bands)
    radiance = np.random.default_rng(7).exponential(1e-3, shape)
    radiance[0, 0] = [0.0, 2e-3, 0.0, 0.0]  # One band alone: outside the sRGB gamut.
    radiance[0, 1] = 0.0
    energy = EnergyBooks(
        emitted=1.0, deposited=0.7, absorbed=0.1, escaped=0.15, culled=0.05,
        by_band=((0.25, 0.175, 0.025, 0.0375, 0.0125),) * 4,
    )
    luminance = observer(film.observer).xyz(radiance, film.edges_nm)[..., 1]
    return Picture(
        spectral_radiance=radiance,
        standard_error=0.1 * radiance,
        accuracy=Accuracy(
            luminance=luminance, noise=0.1 * luminance, bias=0.05 * luminance,
            bias_noise=0.03 * luminance, corrected_noise=0.11 * luminance, replicates=4,
        ),
        edges_nm=film.edges_nm,
        energy=energy,
        scene=small_scene,
        settings=RenderSettings(seed=5).resolved(small_scene),
        timings={"trace": 1.5, "gather": 0.5},
    )


class Passes(NamedTuple):
    """Photons of several passes of one scene: every pass is an independent replicate."""

    photons: list[dict[str, Any]]
    books: list[EnergyBooks]
    flux: float  # of the lamps, inside the film's wavelengths [W]

    def sums(self, weigh: Callable[[dict[str, Any]], Any]) -> Any:
        """What `weigh` makes of the photons of each pass, (passes, ...)."""
        return np.array([weigh(one) for one in self.photons])


@pytest.fixture(scope="session")
def trace_passes() -> Callable[..., Passes]:
    """Trace a scene; with `aimed` at what the camera sees, with a `guide` made for its lamps."""
    return _trace_passes


def _trace_passes(
    scene: Scene,
    *,
    photons: int,
    passes: int = 1,
    first_pass: int = 0,
    aimed: bool = False,
    precision: str = "float64",
    max_interactions: int = 256,
    seed: int = 0,
    threads: int = 2,
    method: dict[str, Any] | None = None,
    guide: Callable[[Lamps], Guide] | None = None,
) -> Passes:
    from sim.device import start_device
    from sim.method import Method
    from sim.photons.lamps import compile_lamps
    from sim.photons.tracing import trace_photons
    from sim.scene_data import compile_scene

    compiled = compile_scene(
        scene, precision=precision, device=start_device("cpu"), method=Method(**(method or {}))
    )
    view = _survey(compiled) if aimed else None
    lamps = compile_lamps(compiled, scene.film.edges_nm, photons, view=view)
    if guide is not None:
        lamps = compile_lamps(compiled, scene.film.edges_nm, photons, guide=guide(lamps))
    batches = [
        trace_photons(
            compiled,
            lamps,
            seed=seed,
            pass_index=first_pass + index,
            max_interactions=max_interactions,
            threads=threads,
        )
        for index in range(passes)
    ]
    return Passes([one.to_numpy() for one in batches], [one.books for one in batches], lamps.flux)


def _survey(compiled: Any) -> Any:
    """What the scene's camera sees, as a rendering surveys it."""
    from sim.image.camera import compile_camera
    from sim.image.survey import survey_view

    film = compiled.scene.film
    camera = compile_camera(compiled, compiled.scene.camera, film)
    return survey_view(compiled, camera, 0.5 * float(film.edges_nm[0] + film.edges_nm[-1]))


@pytest.fixture(scope="session")
def assert_mean() -> Callable[..., None]:
    """Assert that replicates average to what is expected, within k standard errors."""
    return _assert_mean


def _assert_mean(replicates: Any, expected: Any, *, k: float = 5.0, slack: Any = 0.0) -> None:
    """Check the mean of (replicates, ...) values.

    With 16 replicates Student's t exceeds 5 by chance once in 6,000 comparisons. `slack` is what
    the expected value itself may be off by.
    """
    values = np.asarray(replicates, dtype=np.float64)
    mean = values.mean(axis=0)
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    off = np.abs(mean - expected)
    allowed = k * error + slack + 1e-12 * np.abs(expected)
    worst = np.unravel_index(np.argmax(off - allowed), off.shape)
    assert np.all(off <= allowed), (
        f"at {worst}: {mean[worst]:.9g} ± {error[worst]:.2g}, "
        f"expected {np.broadcast_to(expected, off.shape)[worst]:.9g}"
    )
