"""What the extremes share: single rays by the full kernel, so that all compile one a precision."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import scenes

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.ray_path import RayPath

EPS = {"float64": float(np.finfo(np.float64).eps), "float32": float(np.finfo(np.float32).eps)}


@pytest.fixture(params=["float64", "float32"])
def precision(request: pytest.FixtureRequest) -> str:
    name: str = request.param
    return name


@pytest.fixture(scope="session")
def eps() -> dict[str, float]:
    """Spacing of the numbers at 1, by the precision's name."""
    return EPS


@dataclass(frozen=True)
class _Follow:
    """Rays through a few objects, by the kernel that is compiled for everything but one thing.

    Indices are taken as they are: the formula of air, which would convert them, ends at 1.69 µm.
    """

    def __call__(
        self,
        objects: Any,
        origins: Any,
        directions: Any,
        wavelengths_nm: Any = 550.0,
        *,
        precision: str = "float64",
        ambient: Any = "reference",
        **options: Any,
    ) -> list[RayPath]:
        from sim.device import start_device
        from sim.features import Features
        from sim.scene_data import compile_scene
        from sim.scene_media import collect_media
        from sim.single_ray import trace_compiled_rays

        scene = scenes.Scene(objects=tuple(objects), ambient=ambient)
        compiled = compile_scene(
            scene,
            precision=precision,
            device=start_device("cpu"),
            features=Features(
                media_count=len(collect_media(scene).media), air_conversion=False
            ),
        )
        starts, ways, waves = (
            np.asarray(a, dtype=np.float64) for a in (origins, directions, wavelengths_nm)
        )
        count = max(len(np.atleast_2d(starts)), len(np.atleast_2d(ways)), waves.size)
        return trace_compiled_rays(
            compiled,
            np.array(np.broadcast_to(starts, (count, 3))),
            np.array(np.broadcast_to(ways, (count, 3))),
            np.array(np.broadcast_to(waves, (count,))),
            **options,
        )


@pytest.fixture(scope="session")
def follow() -> Callable[..., list[RayPath]]:
    """`follow(objects, origins, directions, wavelengths_nm=550, *, precision, …)`."""
    return _Follow()


@pytest.fixture(scope="session")
def solid() -> Callable[..., scenes.SceneObject]:
    """`solid(shape, eta)`: an object of a constant index, or of a medium."""

    def make(shape: Any, medium: Any, name: str = "solid") -> scenes.SceneObject:
        if isinstance(medium, float):
            medium = scenes.ConstantMedium(eta=medium)
        return scenes.SceneObject(
            name=name, shape=shape, material=scenes.Dielectric(medium=medium)
        )

    return make
