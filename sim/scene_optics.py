"""The optics of a scene as device arrays: media, mirrors and metals, by formulas and tables."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.device_arrays import struct_array
from sim.optics.dispersion import DISPERSION_COEFFICIENTS
from sim.precision import precision_types
from sim.scene_media import Finish, SceneMedia
from sim.scene_structs import CAUCHY, SELLMEIER, TABULATED, make_scene_structs
from spectra import Cauchy, Sellmeier, Tabulated

__all__ = ["fill_optics"]

FloatArray = npt.NDArray[np.float64]

_FAR_NM = 1e9


def fill_optics(
    data: Any, media: SceneMedia, precision: str, device: str, *, disperses: bool
) -> None:
    """Fill the arrays of media and finishes, and the knots and cubics that their tables share.

    Args:
        data: the device-side Scene struct.
        media: what the scene is made of.
        precision: what the kernels compute with.
        device: where the arrays live.
        disperses: whether kernels tell wavelengths apart at all.
    """
    structs = make_scene_structs(precision)
    tables = _Tables()
    coefficients = np.zeros((len(media.media), DISPERSION_COEFFICIENTS))
    rows = []
    for i, medium in enumerate(media.media):
        formula, index_table = medium.dispersion, (0, 0)
        if isinstance(formula, Sellmeier):
            kind, count = SELLMEIER, len(formula.b)
            coefficients[i, 0 : 2 * count : 2] = formula.b
            coefficients[i, 1 : 2 * count : 2] = formula.c_um2
        elif isinstance(formula, Cauchy):
            kind = CAUCHY
            coefficients[i, : len(formula.a)] = formula.a
        else:
            assert isinstance(formula, Tabulated)
            kind = TABULATED
            index_table = tables.add(np.asarray(formula.knots_nm), formula.coefficients)
        loss_table = (0, 0)
        if medium.absorption is not None:
            absorption = medium.absorption
            loss_table = tables.add_lines(absorption.wavelength_nm, absorption.napierian_per_m)
        varies, tints = media.varies[i] and disperses, media.tints[i] and disperses
        rows.append(
            (int(kind), *index_table, media.air_powers[i], *loss_table, int(varies), int(tints))
        )
    finishes = [_finish_row(tables, one, disperses=disperses) for one in media.finishes]
    data.media = struct_array(structs.Medium, rows, device)
    data.finishes = struct_array(structs.Finish, finishes, device)
    types = precision_types(precision)
    data.coefficients = wp.array(coefficients.astype(types.dtype), dtype=types.real, device=device)
    knots, cubics = tables.arrays()
    data.knots_nm = wp.array(knots.astype(types.dtype), dtype=types.real, device=device)
    data.cubics = wp.array(cubics.astype(types.dtype), dtype=types.real, device=device)


def _finish_row(tables: "_Tables", material: Finish, *, disperses: bool) -> tuple[Any, ...]:
    """Row of a Finish."""
    if isinstance(material, scenes.Metal):
        metal = material.resolved()
        return (
            *tables.add_lines(metal.knots_nm, metal.eta_knots),
            *tables.add_lines(metal.knots_nm, metal.k_knots),
            int(disperses),
        )
    reflectance = material.reflectance
    if isinstance(reflectance, float):
        return (*tables.add_lines((), (reflectance,)), 0, 0, 0)
    table = tables.add_lines(reflectance.wavelength_nm, reflectance.values)
    return (*table, 0, 0, int(disperses and material.is_coloured))


class _Tables:
    """Piecewise cubics one after the other, in the arrays that kernels read."""

    def __init__(self) -> None:
        """Start empty."""
        self._knots: list[FloatArray] = []
        self._cubics: list[FloatArray] = []
        self._count = 0

    def add(self, knots: FloatArray, cubics: FloatArray) -> tuple[int, int]:
        """Add (n,) knots and (n − 1, 4) cubics; return the first knot's place, and n."""
        first = self._count
        self._knots.append(knots)
        self._cubics.append(np.vstack([cubics, np.zeros(4)]))
        self._count += len(knots)
        return first, len(knots)

    def add_lines(
        self, knots: Sequence[float] | FloatArray, values: Sequence[float] | FloatArray
    ) -> tuple[int, int]:
        """Add a table that is linear between its knots, and constant beyond them.

        Without knots, it is the one value everywhere.
        """
        x = np.concatenate([[0.0], np.asarray(knots, dtype=np.float64), [_FAR_NM]])
        y = np.concatenate([values[:1], values if len(knots) else [], values[-1:]])
        cubics = np.zeros((len(x) - 1, 4))
        cubics[:, 2] = np.diff(y) / np.diff(x)
        cubics[:, 3] = y[:-1]
        return self.add(x, cubics)

    def arrays(self) -> tuple[FloatArray, FloatArray]:
        """(n,) knots and (n, 4) cubics of all tables, and one more that nothing reads."""
        knots: FloatArray = np.concatenate([*self._knots, np.zeros(1)])
        cubics: FloatArray = np.vstack([*self._cubics, np.zeros((1, 4))])
        return knots, cubics
