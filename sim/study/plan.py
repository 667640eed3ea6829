"""How much a study spends: what a quick one and a full one measure, and how often."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sim.study.axes import axes
from sim.study.setup import ResultKind, Setup

__all__ = [
    "CENTRE",
    "FULL",
    "QUICK",
    "Plan",
    "Point",
    "make_points",
    "photon_scale",
    "turns_of_points",
    "work_of",
]

CENTRE = "centre"
"""Axis and value of the point that all axes share."""


@dataclass(frozen=True)
class Plan:
    """What a study spends; times in CPU-seconds, of which two cores give about 1.7 a second.

    Attributes:
        quick: whether axes have their few values or all.
        replicates: independent runs of each point.
        rows: of the picture that are exposed, evenly spread.
        cells: bins a side of the receiver's window.
        bands: of the bins.
        points_s: for the points.
        mesh_s, bins_s, picture_s: for the references.
        largest_scale: the centre's photons as a multiple of the scene's, at most.
        axes: names of those that are measured; None: all.
    """

    quick: bool
    replicates: int
    rows: int
    cells: int
    bands: int
    points_s: float
    mesh_s: float
    bins_s: float
    picture_s: float
    largest_scale: float = 1.0
    axes: tuple[str, ...] | None = None


QUICK = Plan(
    quick=True, replicates=4, rows=10, cells=16, bands=4,
    points_s=105.0, mesh_s=15.0, bins_s=35.0, picture_s=35.0,
)
FULL = Plan(
    quick=False, replicates=8, rows=32, cells=16, bands=8,
    points_s=1200.0, mesh_s=100.0, bins_s=350.0, picture_s=350.0,
)


@dataclass(frozen=True)
class Point:
    """One value of one axis.

    Attributes:
        axis: its name, or `CENTRE`.
        value: its name.
        setup: what is run.
        results: what is measured.
    """

    axis: str
    value: str
    setup: Setup
    results: tuple[ResultKind, ...]


def make_points(centre: Setup, plan: Plan, results: tuple[ResultKind, ...]) -> list[Point]:
    """The centre, and every value of every axis that changes one of the results."""
    points = [Point(CENTRE, CENTRE, centre, results)]
    for axis in axes():
        asked = tuple(one for one in axis.results if one in results)
        if not asked or (plan.axes is not None and axis.name not in plan.axes):
            continue
        points += [
            Point(axis.name, value, setup, asked)
            for value, setup in axis.vary(centre, plan.quick).items()
            if setup != centre
        ]
    return points


def photon_scale(plan: Plan, work: float, runs: int, fixed: float, seconds: float) -> float:
    """The centre's photons as a multiple of the scene's: a power of 2, so that time suffices.

    Args:
        plan: what may be spent.
        work: of all points' photons, in those of the centre.
        runs: number of points.
        fixed: CPU time of a run whatever its photons, which is the camera's.
        seconds: CPU time of the photons of one run, with the scene's number of them.
    """
    scale = plan.largest_scale
    free = plan.points_s / plan.replicates - runs * fixed
    while scale > 1 / 64 and work * seconds * scale > free:
        scale /= 2.0
    return scale


def work_of(points: list[Point]) -> float:
    """The photons of all points, in those of the first one."""
    total = points[0].setup.photons_total
    return sum(_size(point, total) for point in points)


def _size(point: Point, total: int) -> float:
    # A mesh takes about as long as a run; bins alone take less than bins and a picture.
    size = point.setup.photons_total / total if point.setup.photons_total else 1.0
    return size if "picture" in point.results else 0.5 * size


def turns_of_points(replicates: int, points: list[Point]) -> Iterator[tuple[int, Point]]:
    """All runs: every point once, then every point again, so that no axis has the quiet hour."""
    for replicate in range(replicates):
        for point in points:
            if replicate == 0 or point.setup.estimator != "mesh":
                yield replicate, point
