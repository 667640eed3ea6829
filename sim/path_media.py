"""What a path's wavelength makes of the scene's media: once a path, not once a surface."""

import functools
from types import SimpleNamespace

import warp as wp

from sim.features import Features
from sim.optics.dispersion import air_index, cauchy_index, sellmeier_index, tabulated_index
from sim.scene_structs import CAUCHY, SELLMEIER, TABULATED, make_scene_structs

__all__ = ["make_media_functions"]


@functools.cache
def make_media_functions(precision: str, features: Features) -> SimpleNamespace:
    """Device functions that evaluate the media, with only what the scene's media need.

    Returns:
        A namespace with `media_indices(scene, wavelength_nm)`, a vector of the index of every
        medium; then, where features ask for it, of the absorption coefficient [1/m] of every
        medium; then, where they ask for it, the wavelength itself [nm]; and with its type
        `Indices` and the accessors `absorption_of(indices, medium)` and
        `wavelength_of(indices)`.
    """
    structs = make_scene_structs(precision)
    real, scene_type = structs.real, structs.Scene
    count = features.media_count
    length = count
    if features.absorption:
        length += count
    if features.finishes:
        length += 1
    indices_type = wp.types.vector(length=length, dtype=real)
    last = length - 1

    @wp.func
    def media_indices(scene: scene_type, wavelength_nm: real):
        wavelength_um = wavelength_nm * real(1e-3)
        indices = indices_type()
        for medium in range(count):
            row = scene.media[medium]
            n = real(1.0)
            if wp.static(features.sellmeier):
                if row.formula == SELLMEIER:
                    n = sellmeier_index(scene.coefficients, medium, wavelength_um)
            if wp.static(features.cauchy):
                if row.formula == CAUCHY:
                    n = cauchy_index(scene.coefficients, medium, wavelength_um)
            if wp.static(features.tabulated):
                if row.formula == TABULATED:
                    n = tabulated_index(
                        scene.knots_nm, scene.cubics, row.knot_first, row.knot_count,
                        wavelength_nm,
                    )
            if wp.static(features.air_conversion):
                if row.air_power > 0:
                    n *= air_index(wavelength_um)
                elif row.air_power < 0:
                    n /= air_index(wavelength_um)
            indices[medium] = n
            if wp.static(features.absorption):
                alpha = real(0.0)
                if row.loss_count > 0:
                    alpha = tabulated_index(
                        scene.knots_nm, scene.cubics, row.loss_first, row.loss_count,
                        wavelength_nm,
                    )
                indices[count + medium] = alpha
        if wp.static(features.finishes):
            indices[last] = wavelength_nm
        return indices

    @wp.func
    def absorption_of(indices: indices_type, medium: int):
        return indices[count + medium]

    @wp.func
    def wavelength_of(indices: indices_type):
        return indices[last]

    return SimpleNamespace(
        Indices=indices_type,
        media_indices=media_indices,
        absorption_of=absorption_of,
        wavelength_of=wavelength_of,
    )
