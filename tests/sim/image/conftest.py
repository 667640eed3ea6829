"""A darkroom: the photons of a scene, and films exposed to them by any camera."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import scenes


class Darkroom:
    """The steps of a rendering, one by one, so that a test sees the photons a film is made from."""

    def __init__(
        self,
        scene: scenes.Scene,
        *,
        photons: int,
        radius: float,
        passes: int = 1,
        precision: str = "float64",
        direct_light: str = "photons",
    ) -> None:
        from sim.device import start_device
        from sim.photons.lamps import compile_lamps
        from sim.photons.photon_map import build_photon_map
        from sim.photons.photon_maps import PhotonMaps
        from sim.photons.receivers import compile_receivers
        from sim.photons.tracing import trace_photons
        from sim.scene_data import compile_scene

        self.scene = scene
        self.edges_nm = np.asarray(scene.film.edges_nm)
        self.compiled = compile_scene(scene, precision=precision, device=start_device("cpu"))
        self.lamps = compile_lamps(self.compiled, self.edges_nm, photons)
        self.receivers = compile_receivers(self.compiled, self.lamps, self.edges_nm)
        self.radius = radius
        self.direct = direct_light == "lamps"
        self.batches = [
            trace_photons(
                self.compiled, self.lamps, seed=0, pass_index=i, max_interactions=64, threads=2,
                store_direct=direct_light == "photons",
            )
            for i in range(passes)
        ]
        self.maps = [
            PhotonMaps(build_photon_map(self.compiled, batch, self.receivers, radius, threads=2))
            for batch in self.batches
        ]
        self.photons = [batch.to_numpy() for batch in self.batches]

    def create_film(
        self, *, width: int = 1, height: int = 1, passes: int = 1, radius_scale: float = 1.0
    ) -> Any:
        """An unexposed film of the scene's bands."""
        from sim.image.film import create_film

        lamps = len(self.lamps.spectra)
        return create_film(
            self.edges_nm, lamps, self.compiled.device, passes=passes,
            radius_scale=np.full((height, width), radius_scale, dtype=np.float32),
        )

    def expose(self, film: Any, camera: scenes.Camera, pass_index: int = 0) -> None:
        """Expose a film to one pass."""
        from sim.image.camera import compile_camera
        from sim.image.film import expose
        from sim.image.sight import compose_lights

        size = self.scene.film.model_copy(update={"width": film.width, "height": film.height})
        expose(
            film,
            self.compiled,
            compile_camera(self.compiled, camera, size),
            compose_lights(
                self.compiled.precision, self.maps[pass_index], self.receivers, self.lamps,
                direct=self.direct,
            ),
            seed=0,
            pass_index=pass_index,
            threads=2,
        )

    def look(self, position: Any, direction: Any, pass_index: int = 0) -> Any:
        """Radiance of each band along one ray: one pixel, a ten-millionth of a radian wide."""
        position, direction = np.asarray(position, float), np.asarray(direction, float)
        up = (1.0, 0.0, 0.0) if abs(direction[0]) < 0.5 else (0.0, 1.0, 0.0)
        camera = scenes.Camera(
            position=tuple(position), look_at=tuple(position + direction), up=up, fov_deg=6e-6
        )
        film = self.create_film()
        self.expose(film, camera, pass_index)
        return film.radiance()[0, 0]


@pytest.fixture(scope="session")
def darkroom() -> type[Darkroom]:
    """The class `Darkroom`."""
    return Darkroom
