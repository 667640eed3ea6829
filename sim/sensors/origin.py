"""What made a reading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenes import Scene
    from sim.photons.energy import EnergyBooks
    from sim.settings import ResolvedSettings

__all__ = ["Origin"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Origin:
    """The run that measured, all that it takes to measure again.

    Attributes:
        scene: The scene.
        settings: The settings, with the passes that there were.
        energy: Where the emitted flux went [W].
    """

    scene: Scene
    settings: ResolvedSettings
    energy: EnergyBooks
