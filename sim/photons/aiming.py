"""What a lamp's photons are aimed at: specular objects, sensors, and receivers where they are seen.

Aiming divides effort, not light: the balance heuristic of `sim.photons.emission` makes every
choice here give the same expected picture. A lens of 12.7 mm half a metre from a lamp fills
1/6203 of the sphere, so the choice decides how long a good picture takes.
"""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

import scenes
from scenes.emitters import DistantEmitter
from sim.photons.lamp_structs import AIM_AREA, AIM_BASE, AIM_CELLS, AIM_CONE
from sim.scene_data import CompiledScene
from sim.sensors.frames import sensor_frame, sensor_half

__all__ = ["Aim", "Guide", "View", "aim_at_sensors", "cells_to_distribution", "plan_photons"]

FloatArray = npt.NDArray[np.float64]

SPECULAR_SHARE = 0.4
RECEIVER_SHARE = 0.5
"""Shares of a lamp's photons aimed at specular objects and at receivers; the rest go as the lamp
radiates. They divide effort, not light: any positive shares give the same expected picture."""

SMALLEST_WEIGHT = 0.05
"""A receiver's weight among the others is the fraction of the picture it fills, but at least this:
what the camera barely sees may still be somebody's measurement."""


UNIFORM_PART = 0.2
"""Part of a receiver's photons spread over all of it; the rest goes where the camera looks."""


SENSOR_SHARE = 0.4
"""Share of a lamp's photons aimed at sensors where the others serve a picture."""

EQUAL_SHARE = 0.4
"""Share of the photons that is divided equally among the emitters, whatever their flux, so that a
faint beam beside a bright lamp is not made of a handful of photons."""


class View(Protocol):
    """What a camera sees of each object: `sim.image.survey.Survey` is one."""

    def density(
        self, prim: int, frame: FloatArray, centre: FloatArray, half: FloatArray, cells: int
    ) -> FloatArray:
        """(cells, cells) how often the parts of a rectangle are seen, along its u and v."""

    def fraction(self, prim: int) -> float:
        """Fraction of the picture in which the object is seen, directly or through glass."""

    def seen_area(self, prim: int) -> float:
        """About how large the part of an object is that is seen [m²]."""

    @property
    def samples(self) -> int:
        """How many samples of the picture see a receiver."""


@dataclass(frozen=True)
class Aim:
    """A target of one lamp, in the local frame.

    Attributes:
        share: its share of the lamp's photons, relative to the other aims'.
        kind: AIM_BASE, AIM_CONE or AIM_AREA.
        centre: (3,) of the sphere or rectangle [m].
        frame: (3, 3) rows u, v, normal of the rectangle.
        half: (2,) half sizes of the rectangle [m].
        radius: of the sphere [m].
        pivot: how far from a spherical lamp's centre the lines of one direction cross [m]: at the
            glass that is aimed at, so that where a photon meets it hardly depends on where on
            the lamp it left. 0: nowhere, they are parallel.
        specular: whether glass is aimed at.
        distribution: of an area's points, or of a cone's directions or a beam's profile once they
            are learned, see `sim.photons.lamp_structs`; empty where it is uniform.
    """

    share: float
    kind: int
    centre: FloatArray
    frame: FloatArray
    half: FloatArray
    radius: float
    pivot: float
    specular: bool
    distribution: FloatArray


@dataclass(frozen=True)
class Guide:
    """How photons are divided among lamps and aims.

    Attributes:
        shares: of each lamp that shines, among all photons.
        aims: of each lamp that shines.
    """

    shares: tuple[float, ...]
    aims: tuple[tuple[Aim, ...], ...]


def plan_photons(
    compiled: CompiledScene, emitters: list[tuple[Any, float]], view: View | None, *, direct: bool
) -> Guide:
    """Divide photons as well as can be told without having traced any.

    Args:
        compiled: the scene.
        emitters: the lamps that shine, each with its flux [W].
        view: what the camera sees of each object; None: no camera.
        direct: whether what comes straight from a lamp is worth photons; else only glass is.
    """
    aimed = tuple(
        tuple(find_aims(compiled, emitter, view, sensors=direct)) for emitter, _ in emitters
    )
    fluxes = [flux for _, flux in emitters]
    if compiled.features.method.aiming == "unaimed":
        return Guide(tuple(fluxes), aimed)
    if not direct:
        fluxes = [
            flux * flux_to_glass(compiled, emitter, aims)
            for (emitter, flux), aims in zip(emitters, aimed, strict=True)
        ]
    total = sum(fluxes) or 1.0
    equal = EQUAL_SHARE / len(fluxes)
    return Guide(tuple(equal + (1.0 - EQUAL_SHARE) * flux / total for flux in fluxes), aimed)


def aim_at_sensors(
    compiled: CompiledScene, emitters: list[tuple[Any, float]], guide: Guide
) -> Guide:
    """Spare a part of the photons of a guide, made for a picture, for the scene's sensors.

    Args:
        compiled: the scene.
        emitters: the lamps that shine, each with its flux [W].
        guide: how photons are divided for the picture.
    """
    if not compiled.scene.sensors:
        return guide
    even = plan_photons(compiled, emitters, None, direct=True)
    shares = [
        (1.0 - SENSOR_SHARE) * share + SENSOR_SHARE * other
        for share, other in zip(guide.shares, even.shares, strict=True)
    ]
    aims = []
    for (emitter, _), old in zip(emitters, guide.aims, strict=True):
        if isinstance(emitter, scenes.Beam):
            aims.append(old)  # aims itself
            continue
        total = sum(aim.share for aim in old) / (1.0 - SENSOR_SHARE)
        aims.append((*old, *_sensors(compiled, SENSOR_SHARE * total)))
    return Guide(tuple(shares), tuple(aims))


def find_aims(
    compiled: CompiledScene, emitter: Any, view: View | None, *, sensors: bool = True
) -> list[Aim]:
    """Everything worth aiming at, the lamp's own distribution first.

    Args:
        compiled: the scene.
        emitter: one of its emitters.
        view: what the camera sees of each object; None: no camera.
        sensors: whether sensors are worth it.
    """
    if isinstance(emitter, scenes.Beam) or compiled.features.method.aiming == "unaimed":
        return [_base(1.0)]
    found = list(enumerate(compiled.scene.objects))
    # A plane without end cannot be aimed at.
    finite = [(prim, one) for prim, one in found if not isinstance(one.shape, scenes.Plane)]
    measures = sensors and len(compiled.scene.sensors) > 0
    # Without a camera receivers are all there is to see, unless there are sensors.
    unseen = SMALLEST_WEIGHT if measures else 1.0
    specular = [one for _, one in finite if scenes.is_specular(one.material)]
    receivers = [
        (prim, one, unseen if view is None else max(view.fraction(prim), SMALLEST_WEIGHT))
        for prim, one in finite
        if isinstance(one.material, scenes.Lambertian)
    ]
    total = sum(weight for _, _, weight in receivers) + float(measures)
    aims = [_base(1.0 - SPECULAR_SHARE - RECEIVER_SHARE)]
    aims += [_cone(SPECULAR_SHARE / len(specular), compiled, one, emitter) for one in specular]
    for prim, one, weight in receivers:
        share = RECEIVER_SHARE * weight / total
        if isinstance(one.shape, scenes.Rectangle):
            aims.append(_area(share, compiled, prim, view))
        else:
            aims.append(_cone(share, compiled, one, emitter))
    return aims + (_sensors(compiled, RECEIVER_SHARE / total) if measures else [])


def flux_to_glass(compiled: CompiledScene, emitter: Any, aims: tuple[Aim, ...]) -> float:
    """About how much of a lamp's flux meets glass that can be aimed at, as a fraction.

    Args:
        compiled: the scene.
        emitter: the lamp.
        aims: what its photons are aimed at.
    """
    if isinstance(emitter, scenes.Beam):
        return 1.0
    total = 0.0
    for aim in (one for one in aims if one.specular):
        if isinstance(emitter, DistantEmitter):
            total += (aim.radius / compiled.bounding_radius) ** 2
            continue
        offset = aim.centre - compiled.to_local(emitter.position)
        distance = max(float(np.linalg.norm(offset)), aim.radius)
        part = 0.5 * (1.0 - np.sqrt(1.0 - (aim.radius / distance) ** 2))  # Ω/4π of its cone
        if isinstance(emitter, scenes.RectangleLamp):
            part *= 4.0 * max(float(offset @ emitter.frame()[2]) / distance, 0.0)
        elif isinstance(emitter, scenes.Spot):
            part /= np.sin(0.5 * np.radians(emitter.half_angle_deg)) ** 2
        total += part
    return float(min(total, 1.0))


def _base(share: float) -> Aim:
    """The lamp's own distribution."""
    return Aim(
        share, int(AIM_BASE), np.zeros(3), np.eye(3), np.zeros(2), 0.0, 0.0, False, np.zeros(0)
    )


def _cone(share: float, compiled: CompiledScene, item: scenes.SceneObject, emitter: Any) -> Aim:
    """The cone around an object's bounding sphere, from a lamp; wide enough for all of the lamp."""
    assert not isinstance(item.shape, scenes.Plane)
    centre, radius = item.shape.bounding_sphere()
    pivot = 0.0
    if isinstance(emitter, scenes.SphereLamp):
        distance = float(np.linalg.norm(np.subtract(centre, emitter.position)))
        radius, pivot = _from_sphere(radius, emitter.radius, distance)
    return Aim(
        share,
        int(AIM_CONE),
        compiled.to_local(centre),
        np.eye(3),
        np.zeros(2),
        radius,
        pivot,
        scenes.is_specular(item.material),
        np.zeros(0),
    )


def _from_sphere(radius: float, lamp: float, distance: float) -> tuple[float, float]:
    """Radius of the cone that holds every line from a spherical lamp to a sphere, and its pivot.

    A line that passes the lamp's centre at h, the sphere at r - h at the most, crosses the
    pivot's sphere of radius D in the direction asin((r - h)/D) + asin(h/D), which is widest for
    h = -R. Parallel lines (no pivot) need asin((r + R)/D); so does a lamp that is too near.
    """
    if distance <= radius + lamp:
        return radius + lamp, 0.0
    widest = np.arcsin((radius + lamp) / distance) - np.arcsin(lamp / distance)
    return float(distance * np.sin(widest)), distance


def _area(share: float, compiled: CompiledScene, prim: int, view: View | None) -> Aim:
    """A rectangle, its points as dense as the camera's pixels are there."""
    shape = compiled.scene.objects[prim].shape
    assert isinstance(shape, scenes.Rectangle)
    frame, half = np.stack(shape.frame()), 0.5 * np.asarray(shape.size)
    centre = compiled.to_local(shape.position)
    cells = int(AIM_CELLS)
    density = np.full((cells, cells), 1.0 / cells**2)
    if view is not None:
        seen = view.density(prim, frame, centre, half, cells)
        if seen.sum() > 0.0:
            density = UNIFORM_PART * density + (1.0 - UNIFORM_PART) * seen / seen.sum()
    distribution = cells_to_distribution(density)
    return Aim(share, int(AIM_AREA), centre, frame, half, 0.0, 0.0, False, distribution)


def _sensors(compiled: CompiledScene, share: float) -> list[Aim]:
    """The scene's sensors, all parts of each alike; a disk by the square around it."""
    even = cells_to_distribution(np.full((int(AIM_CELLS), int(AIM_CELLS)), 1.0 / AIM_CELLS**2))
    return [
        Aim(
            share / len(compiled.scene.sensors), int(AIM_AREA),
            compiled.to_local(sensor.shape.position), sensor_frame(sensor), sensor_half(sensor),
            0.0, 0.0, False, even,
        )
        for sensor in compiled.scene.sensors
    ]


def cells_to_distribution(density: FloatArray) -> FloatArray:
    """Distribution function of cells: of the rows, then of the cells in each row."""
    rows = density.sum(axis=1)
    return np.concatenate([_cumulated(line) for line in (rows, *(density / rows[:, None]))])


def _cumulated(shares: FloatArray) -> FloatArray:
    """0, the running sums of `shares`, and at the end exactly 1."""
    sums = np.concatenate([[0.0], np.cumsum(shares)])
    sums[-1] = 1.0
    return sums
