"""Draw the paths of rays through a scene, in the colours of their wavelengths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenes.emitters import LocalEmitter
from scenes.materials import Dielectric
from scenes.shapes import Plane
from sim.diagram.outlines import emitter_outline, shape_outline
from sim.diagram.ray_lines import KINDS, DrawnPath, ray_lines
from sim.diagram.view import NAMED_VIEWS, View, choose_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from scenes import Scene

__all__ = ["draw_rays"]

_BACKGROUND = "#14161a"
_FOREGROUND = "#c8ccd4"
_GLASS = "#8fb4d8"
_LAMP = "#ffd27f"
_SENSOR = "#9fd8a0"
_LONGEST_SIDE_IN = 10.0
_DPI = 150
_RAY_WIDTH_PT = 0.9
_POINTS_PER_INCH = 72.0
_STYLES = {"refracted": "solid", "reflected": "dashed", "totally reflected": "dashdot"}
_NORMAL = 0.03  # Length of a surface normal to either side, as a share of the longer side.
_MARGIN = 0.06  # Around everything, as a share of the longer side.
_FARTHEST = 20.0  # What is further out than this many radii of the bench does not count.
_METRES_FROM = 2.0  # A diagram larger than this [m] has its axes in metres.
_EDGE_ON = 0.2  # |cos| of the angle between a plane's normal and the view, below which it is drawn.


def draw_rays(scene: Scene, paths: Sequence[DrawnPath], *, view: str | None = None) -> Figure:
    """Draw a ray diagram.

    Args:
        scene: Its surfaces are outlined, its sensors dashed, and its lamps.
        paths: The paths.
        view: "xy", "xz" or "yz"; None: the view along the paths' direction of least spread.

    Returns:
        The figure; both axes at the same scale.

    Raises:
        KeyError: There is no such view.
    """
    from matplotlib.figure import Figure

    vertices = np.concatenate([*(path.vertices for path in paths), np.empty((0, 3))])
    chosen = choose_view(vertices) if view is None else NAMED_VIEWS[view]
    low, high = _limits(scene, paths, chosen)
    width, height = high - low
    scale = _LONGEST_SIDE_IN / max(width, height)
    size = max(width * scale, 4.0), max(height * scale, 3.0)
    figure = Figure(figsize=size, dpi=_DPI, layout="constrained", facecolor=_BACKGROUND)
    axes = figure.add_subplot(aspect="equal", facecolor=_BACKGROUND)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    _draw_surfaces(axes, scene, chosen)
    _draw_sensors(axes, scene, chosen)
    reach = 2.0 * float(width + height)
    _draw_planes(axes, scene, chosen, reach)
    resolution = _RAY_WIDTH_PT / _POINTS_PER_INCH / scale
    _draw_paths(axes, paths, chosen, reach=reach, resolution=resolution)
    _draw_normals(axes, paths, chosen, _NORMAL * float(max(width, height)))
    _draw_lamps(axes, scene, chosen)
    _label(axes, scene.title, chosen, float(max(width, height)))
    return figure


def _limits(
    scene: Scene, paths: Sequence[DrawnPath], view: View
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Corners (2,), (2,) of what is shown [m]: the solids, and the paths' vertices.

    Vertices much further away than everything else, as where a ray just grazes an endless floor,
    are left out.
    """
    toward = view.toward_viewer
    curves = [shape_outline(item.shape, toward) for item in scene.objects if item.shape.is_closed]
    solids = [curve for curve in curves if curve is not None]
    starts = [path.points[:1] for path in paths]
    near = [one for one in scene.emitters if isinstance(one, LocalEmitter)]
    starts = starts or [np.array([emitter.position]) for emitter in near]
    core = view.project(np.concatenate([*solids, *starts, np.empty((0, 3))]))
    if len(core) == 0:
        return np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    centre = 0.5 * (core.min(axis=0) + core.max(axis=0))
    reach = _FARTHEST * float(np.linalg.norm(core - centre, axis=1).max()) or np.inf
    met = view.project(np.concatenate([*(path.vertices for path in paths), np.empty((0, 3))]))
    seen = np.concatenate([core, met[np.linalg.norm(met - centre, axis=1) <= reach]])
    low, high = seen.min(axis=0), seen.max(axis=0)
    margin = _MARGIN * float((high - low).max()) or 1.0
    return low - margin, high + margin


def _draw_sensors(axes: Axes, scene: Scene, view: View) -> None:
    from matplotlib.patches import Polygon

    for sensor in scene.sensors:
        outline = shape_outline(sensor.shape, view.toward_viewer)
        if outline is not None:
            corners = view.project(outline)
            axes.add_patch(
                Polygon(corners, facecolor="none", edgecolor=_SENSOR, linewidth=1.0, linestyle="--")
            )


def _draw_surfaces(axes: Axes, scene: Scene, view: View) -> None:
    from matplotlib.patches import Polygon

    for item in scene.objects:
        outline = shape_outline(item.shape, view.toward_viewer)
        if outline is not None:
            is_glass = isinstance(item.material, Dielectric)
            face = (*_rgb(_GLASS), 0.15) if is_glass else "none"
            edge = _GLASS if is_glass else _FOREGROUND
            corners = view.project(outline)
            axes.add_patch(Polygon(corners, facecolor=face, edgecolor=edge, linewidth=1.2))


def _draw_planes(axes: Axes, scene: Scene, view: View, reach: float) -> None:
    """Infinite planes are lines, if they are seen nearly edge-on."""
    for item in scene.objects:
        if isinstance(item.shape, Plane):
            normal = view.project(np.array(item.shape.normal))
            if np.linalg.norm(normal) ** 2 > 1.0 - _EDGE_ON**2:
                along = np.array([-normal[1], normal[0]])
                foot = view.project(np.array(item.shape.position))
                ends = (foot + reach * np.array([[-1.0], [1.0]]) * along)
                axes.plot(*ends.T, color=_FOREGROUND, linewidth=1.2)


def _draw_paths(
    axes: Axes, paths: Sequence[DrawnPath], view: View, *, reach: float, resolution: float
) -> None:
    from matplotlib.collections import LineCollection

    for kind in KINDS:
        lines, colours = ray_lines(paths, view, reach=reach, resolution=resolution, kind=kind)
        if len(lines):
            axes.add_collection(
                LineCollection(
                    list(lines), colors=colours, linewidths=_RAY_WIDTH_PT, linestyles=_STYLES[kind]
                )
            )


def _draw_normals(axes: Axes, paths: Sequence[DrawnPath], view: View, length: float) -> None:
    """A thin line through each vertex, along the surface's normal; where many are, one."""
    from matplotlib.collections import LineCollection

    found: dict[tuple[int, ...], list[NDArray[np.float64]]] = {}
    for path in paths:
        if path.normals is not None:
            places, normals = (view.project(part) for part in path.normals)
            for place, normal in zip(places, normals, strict=True):
                cell = tuple(np.round(place / (0.2 * length)).astype(int))
                found.setdefault(cell, [place - length * normal, place + length * normal])
    if found:
        axes.add_collection(
            LineCollection(
                list(found.values()), colors=_FOREGROUND, linewidths=0.6, linestyles="dotted"
            )
        )


def _draw_lamps(axes: Axes, scene: Scene, view: View) -> None:
    from matplotlib.patches import Polygon

    for emitter in scene.emitters:
        if not isinstance(emitter, LocalEmitter):
            continue  # what is infinitely far away has no place in the diagram
        outline = emitter_outline(emitter, view.toward_viewer)
        if outline is None:
            x, y = view.project(np.array(emitter.position))
            axes.plot(x, y, marker="*", markersize=9.0, color=_LAMP)
        else:
            corners = view.project(outline)
            axes.add_patch(Polygon(corners, facecolor="none", edgecolor=_LAMP, linewidth=1.6))


def _label(axes: Axes, title: str, view: View, size_m: float) -> None:
    """Title and axes, in metres or millimetres as fits the size of what is shown."""
    unit, per_metre = ("m", 1.0) if size_m > _METRES_FROM else ("mm", 1e3)
    axes.set_title(title, color=_FOREGROUND)
    axes.set_xlabel(f"{view.labels[0]} [{unit}]", color=_FOREGROUND)
    axes.set_ylabel(f"{view.labels[1]} [{unit}]", color=_FOREGROUND)
    axes.tick_params(colors=_FOREGROUND)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda position, _: f"{position * per_metre:.6g}")
    for spine in axes.spines.values():
        spine.set_color(_FOREGROUND)
        spine.set_alpha(0.4)


def _rgb(colour: str) -> tuple[float, float, float]:
    from matplotlib.colors import to_rgb

    return to_rgb(colour)
