"""What made a reading."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenes import Scene
    from sim.photons.energy import EnergyBooks
    from sim.settings import ResolvedSettings

__all__ = ["Origin", "measured_text"]


def measured_text(flux: float, error: float, media: tuple[str, ...]) -> str:
    """A flux with its error, if that is known, and where it was measured."""
    spread = "" if math.isnan(error) else f" ± {error:.2g}"
    return f"{flux:.6g}{spread} W in {', '.join(media)}"


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
