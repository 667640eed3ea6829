"""What one point of a study is: a scene, and everything that decides its result and its cost."""

from __future__ import annotations

import dataclasses
from typing import Any, Literal, TypeAlias

import scenes
from sim.method import DEFAULT_METHOD, Method
from sim.settings import ResolvedSettings

__all__ = ["RESULTS", "Estimator", "ResultKind", "SeedSource", "Setup"]

ResultKind: TypeAlias = Literal["bins", "picture"]
"""What is compared: irradiance on a flat receiver, or the picture."""

Estimator: TypeAlias = Literal["bins", "gather", "mesh"]
"""How the receiver's irradiance is found: exact bins, the picture's gather, or a caustic mesh."""

RESULTS: tuple[ResultKind, ...] = ("bins", "picture")


@dataclasses.dataclass(frozen=True)
class Setup:
    """One way to simulate a scene.

    Attributes:
        scene: what is simulated.
        settings: with nothing left open but one of the two radii; its seed is not used.
        method: how light is followed.
        estimator: how irradiance on the receiver is found.
        mesh_cells: cells a side, where that is by a mesh.
    """

    scene: scenes.Scene
    settings: ResolvedSettings
    method: Method = DEFAULT_METHOD
    estimator: Estimator = "bins"
    mesh_cells: int = 16

    def with_settings(self, **changes: Any) -> Setup:
        """The same with other settings."""
        return dataclasses.replace(self, settings=dataclasses.replace(self.settings, **changes))

    def with_radius(self, factor: float) -> Setup:
        """The same with a multiple of its gather radius."""
        settings = self.settings
        if settings.radius is not None:
            return self.with_settings(radius=factor * settings.radius)
        assert settings.radius_pixels is not None  # resolved settings have one of the two
        return self.with_settings(radius_pixels=factor * settings.radius_pixels)

    def with_method(self, **changes: Any) -> Setup:
        """The same with light followed in another way."""
        return dataclasses.replace(self, method=dataclasses.replace(self.method, **changes))

    def with_scene(self, scene: scenes.Scene) -> Setup:
        """The same in another scene."""
        return dataclasses.replace(self, scene=scene)

    @property
    def photons_total(self) -> int:
        """Photons of all passes."""
        if self.estimator == "mesh":
            return 0
        return int(self.settings.photons or 0) * int(self.settings.passes or 0)


class SeedSource:
    """Hands out seeds, none of them twice: estimates and references share no random number."""

    def __init__(self, first: int = 0) -> None:
        self._next = first

    def take(self) -> int:
        """A seed that nothing else has."""
        seed = self._next
        self._next += 1
        return seed
