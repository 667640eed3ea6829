"""Paths as coloured line segments, merged where they cannot be told apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sim.diagram.view import View
from spectra.srgb import wavelength_to_srgb

__all__ = ["KINDS", "DrawnPath", "Kind", "ray_lines"]

Kind: TypeAlias = Literal["refracted", "reflected", "totally reflected"]
"""What happened to a ray at the start of a segment; as it left its lamp, it counts as refracted."""

KINDS: tuple[Kind, ...] = ("refracted", "reflected", "totally reflected")

_NEARLY_WHITE = 0.3  # Share of its strongest channel that a mixture needs in its weakest.


@dataclass(frozen=True, eq=False)
class DrawnPath:
    """One path to draw.

    Attributes:
        points: Its vertices in order, shape (n, 3) [m].
        wavelength_nm: Its wavelength [nm].
        escapes: Whether it leaves the scene, so that of its last segment only the direction is
            of interest.
        kinds: Of each segment; () stands for refraction all the way.
        normals: Of the surfaces at the vertices that have one: places and unit vectors, each
            (k, 3).
        strength: How bright it is drawn, 0 to 1.
    """

    points: NDArray[np.float64]
    wavelength_nm: float
    escapes: bool = False
    kinds: tuple[Kind, ...] = ()
    normals: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
    strength: float = 1.0

    def is_kind(self, kind: Kind) -> NDArray[np.bool_]:
        """(n − 1,) which of the segments are of this kind."""
        kinds = self.kinds or ("refracted",) * (len(self.points) - 1)
        return np.array([one == kind for one in kinds], dtype=np.bool_)

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The points that are on something: all but the far end of a path that escapes."""
        return self.points[:-1] if self.escapes else self.points


def ray_lines(
    paths: Sequence[DrawnPath],
    view: View,
    *,
    reach: float,
    resolution: float,
    kind: Kind = "refracted",
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Segments to draw. Those that coincide become one, in the sum of their colours.

    So white light is white until something parts its colours, and not the colour drawn last.

    Args:
        paths: The paths.
        view: How they are seen.
        reach: Length [m] of the last segment of a path that escapes.
        resolution: Segments whose ends are closer than this [m] coincide.
        kind: Segments of this kind only.

    Returns:
        Segments (n, 2, 2) [m], and their encoded sRGB, (n, 3), 0 to 1.
    """
    from scipy.spatial import KDTree

    polylines = [view.project(_with_long_end(path, reach)) for path in paths]
    segments = [
        np.stack([line[:-1], line[1:]], axis=1)[path.is_kind(kind)]
        for path, line in zip(paths, polylines, strict=True)
    ]
    every = np.concatenate([*segments, np.empty((0, 2, 2))])
    if len(every) == 0:
        return every, np.empty((0, 3))
    colours = wavelength_to_srgb(np.array([path.wavelength_nm for path in paths]))
    counts = [len(part) for part in segments]
    colour_of = np.repeat(colours, counts, axis=0)
    strength_of = np.repeat([path.strength for path in paths], counts)
    near = KDTree(every.reshape(-1, 4)).query_ball_point(every.reshape(-1, 4), resolution)
    balance = _white_balance(paths)
    is_drawn = np.zeros(len(every), dtype=np.bool_)
    kept, mixed, strength = [], [], []
    for first, group in enumerate(near):
        if not is_drawn[first]:
            members = [index for index in group if not is_drawn[index]]
            is_drawn[members] = True
            kept.append(first)
            alone = len(members) == 1
            strength.append(strength_of[members].max())
            mixed.append(colour_of[first] if alone else colour_of[members].sum(axis=0) * balance)
    colour = np.array(mixed)
    colour /= np.maximum(colour.max(axis=1, keepdims=True), 1.0)
    return every[kept], colour * np.array(strength)[:, None]


def _white_balance(paths: Sequence[DrawnPath]) -> NDArray[np.float64]:
    """Factors (3,) that make all wavelengths together white, if they are nearly so anyway."""
    every_nm = np.array(sorted({path.wavelength_nm for path in paths}))
    total: NDArray[np.float64] = wavelength_to_srgb(every_nm).sum(axis=0)
    if total.min() < _NEARLY_WHITE * total.max():
        return np.ones(3)
    balance: NDArray[np.float64] = total.mean() / total
    return balance


def _with_long_end(path: DrawnPath, reach: float) -> NDArray[np.float64]:
    """The path's points; if it escapes, its last segment leads out of the picture."""
    if not path.escapes or len(path.points) < 2:
        return path.points
    last = path.points[-1] - path.points[-2]
    end = path.points[-2] + last / np.linalg.norm(last) * reach
    return np.concatenate([path.points[:-1], end[None]])
