"""Photons traced past sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.photons.photon_batch import PhotonBatch


@pytest.fixture(scope="session")
def trace_crossings() -> Callable[..., PhotonBatch]:
    """Trace one pass of a scene, its crossings in the batch."""
    return _trace_crossings


def _trace_crossings(
    scene: Any, *, photons: int, pass_index: int = 0, precision: str = "float64", threads: int = 2,
    **options: Any,
) -> PhotonBatch:
    from sim.device import start_device
    from sim.photons.lamps import compile_lamps
    from sim.photons.tracing import trace_photons
    from sim.scene_data import compile_scene
    from sim.sensors.sensor_bank import compile_sensors

    compiled = compile_scene(scene, precision=precision, device=start_device("cpu"))
    lamps = compile_lamps(compiled, scene.film.edges_nm, photons)
    return trace_photons(
        compiled, lamps, seed=3, pass_index=pass_index, max_interactions=64, threads=threads,
        sensors=compile_sensors(compiled), **options,
    )
