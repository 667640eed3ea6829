"""Distributions over cells: of a spectrum's segments, and of the cells of a square. Device side.

Reference:
    Chen & Asau (1974), "On generating random variates from an empirical distribution", AIIE
    Transactions 6, 163: a guide table.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.photons.lamp_structs import AIM_CELLS, make_lamp_structs

__all__ = ["make_cell_functions"]


@functools.cache
def make_cell_functions(precision: str) -> SimpleNamespace:
    """Device functions of distributions over cells: of a target's square, and of a mask."""
    structs = make_lamp_structs(precision)
    real, emitter_type = structs.real, structs.Emitter

    @wp.func
    def locate(
        cdf: wp.array(dtype=real), guide: wp.array(dtype=int), first: int, count: int, u: real
    ):
        """Which of `count` cells the distribution function reaches u in, and how far into it.

        The guide names the cell for every multiple of 1/count, and the rest is a step or two
        (Chen & Asau 1974): fewer unforeseeable branches than a bisection has.
        """
        cell = int(guide[first + int(u * real(count))])
        while cdf[first + cell + 1] <= u:
            cell += 1
        low = cdf[first + cell]
        return cell, (u - low) / (cdf[first + cell + 1] - low)

    @wp.func
    def invert_cells(cdf: wp.array(dtype=real), guide: wp.array(dtype=int), first: int, u: real):
        """Cell, and coordinate in [0, 1) of the side, where the distribution reaches u."""
        cell, inside = locate(cdf, guide, first, AIM_CELLS, u)
        return cell, (real(cell) + inside) * real(wp.static(1.0 / AIM_CELLS))

    @wp.func
    def invert_square(
        cdf: wp.array(dtype=real), guide: wp.array(dtype=int), first: int, u0: real, u1: real
    ):
        """Point of the unit square where the distribution reaches (u0, u1)."""
        cell, s = invert_cells(cdf, guide, first, u0)
        row = first + (cell + 1) * (AIM_CELLS + 1)
        _j, t = invert_cells(cdf, guide, row, u1)
        return s, t

    @wp.func
    def cell_density(cdf: wp.array(dtype=real), first: int, s: real, t: real):
        """Density at (s, t) of the unit square, relative to a uniform one."""
        cells = int(AIM_CELLS)
        i = wp.clamp(int(s * real(wp.static(float(AIM_CELLS)))), 0, cells - 1)
        j = wp.clamp(int(t * real(wp.static(float(AIM_CELLS)))), 0, cells - 1)
        row = first + (i + 1) * (cells + 1)
        along_u = cdf[first + i + 1] - cdf[first + i]
        along_v = cdf[row + j + 1] - cdf[row + j]
        return along_u * along_v * real(wp.static(float(AIM_CELLS * AIM_CELLS)))

    @wp.func
    def through_mask(
        cdf: wp.array(dtype=real), guide: wp.array(dtype=int), emitter: emitter_type, u0: real,
        u1: real,
    ):
        """Point of the unit square, as densely as light comes through the emitter's mask."""
        i, s = locate(cdf, guide, emitter.first_mask, emitter.mask_columns, u0)
        row = emitter.first_mask + emitter.mask_columns + 1 + i * (emitter.mask_rows + 1)
        j, t = locate(cdf, guide, row, emitter.mask_rows, u1)
        s = (real(i) + s) / real(emitter.mask_columns)
        return s, (real(j) + t) / real(emitter.mask_rows)

    @wp.func
    def mask_cell(emitter: emitter_type, s: real, t: real):
        """Where (s, t) is: place in the distribution of columns, and in that of its column."""
        i = wp.clamp(int(s * real(emitter.mask_columns)), 0, emitter.mask_columns - 1)
        j = wp.clamp(int(t * real(emitter.mask_rows)), 0, emitter.mask_rows - 1)
        column = emitter.first_mask + emitter.mask_columns + 1 + i * (emitter.mask_rows + 1)
        return emitter.first_mask + i, column + j

    @wp.func
    def mask_density(cdf: wp.array(dtype=real), emitter: emitter_type, s: real, t: real):
        """Density of `through_mask` at (s, t), relative to a uniform one."""
        along, across = mask_cell(emitter, s, t)
        share = (cdf[along + 1] - cdf[along]) * (cdf[across + 1] - cdf[across])
        return share * real(emitter.mask_columns) * real(emitter.mask_rows)

    @wp.func
    def before_mask(cdf: wp.array(dtype=real), emitter: emitter_type, s: real, t: real):
        """The numbers that `through_mask` turns into (s, t)."""
        along, across = mask_cell(emitter, s, t)
        x = s * real(emitter.mask_columns) - real(along - emitter.first_mask)
        y = t * real(emitter.mask_rows)
        y -= wp.floor(y)
        u0 = cdf[along] + x * (cdf[along + 1] - cdf[along])
        return u0, cdf[across] + y * (cdf[across + 1] - cdf[across])

    return SimpleNamespace(
        locate=locate, invert_square=invert_square, cell_density=cell_density,
        through_mask=through_mask, mask_density=mask_density, before_mask=before_mask,
    )  # fmt: skip
