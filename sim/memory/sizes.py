"""Sizes that can be told from a scene's description alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenes import Scene

__all__ = ["film_memory", "size_text"]

_SCRATCH = 13
"""Numbers a pixel, while its accuracy is worked out."""


def film_memory(scene: Scene) -> tuple[int, int]:
    """What a film takes while it is exposed, and what comes on top in the end [bytes].

    `sim.image.film` has of each pixel a sample (bands, lamps and the bias), mean and squares, a
    tally of six, and half a number for its radius; in the end there is the standard error.
    """
    film, lamps = scene.film, len(scene.emitters)
    pixels = film.width * film.height
    exposed = 8 * (3 * film.bands + lamps + 1 + 6 + _SCRATCH) + 4
    return pixels * exposed, 8 * pixels * film.bands


def size_text(count: float) -> str:
    """Bytes in words: 660 MB, 4.2 GB."""
    return f"{count / 1e9:.3g} GB" if count >= 1e9 else f"{count / 1e6:.0f} MB"
