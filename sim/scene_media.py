"""The media of a scene: which there are, where, and on which footing their indices are."""

from dataclasses import replace

import scenes
from scenes.media import REFERENCE_MEDIA
from spectra import Medium

__all__ = ["collect_media"]


def collect_media(scene: scenes.Scene) -> tuple[list[Medium], list[int], list[int]]:
    """Media in use (the ambient one first), each object's medium, and each one's air power."""
    ambient = _ambient_medium(scene)
    media, medium_of = [ambient], []
    for item in scene.objects:
        if isinstance(item.material, scenes.Dielectric):
            medium = item.material.resolved()
            if medium not in media:
                media.append(medium)
            medium_of.append(media.index(medium))
        else:
            medium_of.append(0)
    if scene.ambient == "reference":
        return media, medium_of, [0] * len(media)
    # Any other ambient: all indices on one footing, relative to the ambient's own reference.
    powers = []
    for medium in media:
        if medium.relative_to == ambient.relative_to:
            powers.append(0)
        else:
            powers.append(1 if medium.relative_to == "air" else -1)
    return media, medium_of, powers


def _ambient_medium(scene: scenes.Scene) -> Medium:
    """What surrounds the objects; index 1 for air, vacuum, and each index's own reference."""
    ambient = scene.resolved_ambient()
    if isinstance(ambient, Medium):
        return ambient
    if ambient in REFERENCE_MEDIA:
        return REFERENCE_MEDIA[ambient]
    return replace(REFERENCE_MEDIA["air"], name=ambient)
