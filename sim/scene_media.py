"""What a scene is made of: which media there are, where, and on which footing their indices are."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import scenes
from scenes.media import REFERENCE_MEDIA
from spectra import Medium, air_index
from spectra.arrays import FloatArray
from spectra.dispersion import require_in_range

__all__ = ["Finish", "SceneMedia", "collect_media", "require_known", "varies_with_wavelength"]


Finish = scenes.Mirror | scenes.Metal | scenes.Lambertian
"""What the surface of an opaque object can be, if it reflects."""


def varies_with_wavelength(medium: Medium, air_power: int) -> bool:
    """Whether a medium's index or what it absorbs depends on the wavelength.

    Air disperses too, and is a factor of the indices that are converted: to `air_power`.
    """
    return medium.is_dispersive or air_power != 0 or medium.is_tinted


@dataclass(frozen=True)
class SceneMedia:
    """The media and the finishes of a scene.

    Attributes:
        media: the media, the ambient one first.
        medium_of: of each object, the row of its medium; 0 if it has none.
        air_powers: of each medium, the power of the index of air that its index is multiplied by.
        finishes: the mirrors, the metals and the diffuse surfaces.
        finish_of: of each object, the row of its finish; 0 if it has none.
    """

    media: tuple[Medium, ...]
    medium_of: tuple[int, ...]
    air_powers: tuple[int, ...]
    finishes: tuple[Finish, ...]
    finish_of: tuple[int, ...]

    @property
    def tints(self) -> tuple[bool, ...]:
        """Of each medium, whether what it absorbs depends on the wavelength."""
        return tuple(one.is_tinted for one in self.media)

    @property
    def varies(self) -> tuple[bool, ...]:
        """Of each medium, whether its index or what it absorbs depends on the wavelength."""
        return tuple(map(varies_with_wavelength, self.media, self.air_powers))


def collect_media(scene: scenes.Scene) -> SceneMedia:
    """What `scene` is made of, each medium and finish once."""
    ambient = _ambient_medium(scene)
    media, medium_of = [ambient], []
    finishes: list[Finish] = []
    finish_of = []
    for item in scene.objects:
        row, finish = 0, 0
        if isinstance(item.material, scenes.Dielectric):
            medium = item.material.resolved()
            if medium not in media:
                media.append(medium)
            row = media.index(medium)
        elif isinstance(item.material, Finish):
            if item.material not in finishes:
                finishes.append(item.material)
            finish = finishes.index(item.material)
        medium_of.append(row)
        finish_of.append(finish)
    return SceneMedia(
        tuple(media), tuple(medium_of), tuple(_air_powers(scene, media)),
        tuple(finishes), tuple(finish_of),
    )


def _air_powers(scene: scenes.Scene, media: list[Medium]) -> list[int]:
    """Of each medium, the power of the index of air that brings all to one footing."""
    if scene.ambient == "reference":
        return [0] * len(media)
    # Any other ambient: all indices on one footing, relative to the ambient's own reference.
    powers = []
    for medium in media:
        if medium.relative_to == media[0].relative_to:
            powers.append(0)
        else:
            powers.append(1 if medium.relative_to == "air" else -1)
    return powers


def _ambient_medium(scene: scenes.Scene) -> Medium:
    """What surrounds the objects; index 1 for air, vacuum, and each index's own reference."""
    ambient = scene.resolved_ambient()
    if isinstance(ambient, Medium):
        return ambient
    if ambient in REFERENCE_MEDIA:
        return REFERENCE_MEDIA[ambient]
    return replace(REFERENCE_MEDIA["air"], name=ambient)


def require_known(
    scene: scenes.Scene, media: Sequence[Medium], wavelengths_nm: FloatArray, *, has_air: bool
) -> None:
    """Make sure that everything a scene is made of is known at some wavelengths.

    Args:
        scene: the scene, for its metals.
        media: its media, the ambient one first.
        wavelengths_nm: (n,) the wavelengths [nm].
        has_air: whether indices are converted by that of air.

    Raises:
        WavelengthOutOfRange: an index or an absorption coefficient is not known at one of them.
    """
    for medium in reversed(media):  # those of the objects first
        medium.eta(wavelengths_nm)
        if medium.absorption is not None:
            known_nm, what = medium.absorption.wavelength_range_nm, "absorption coefficient"
            require_in_range(wavelengths_nm, medium.name, known_nm, quantity=what)
    for item in scene.objects:
        if isinstance(item.material, scenes.Metal):
            item.material.resolved().eta(wavelengths_nm)
    if has_air:
        air_index(wavelengths_nm)
