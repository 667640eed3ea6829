"""Where a lamp's photons are worth most: learned from a pilot, and without bias.

A picture's noise is the sum, over its photons, of flux² times a weight that says how much the eye
minds it where the photon lands. With photons drawn at density Q, the pilot estimates what that sum
would be at another density Q': Σ m Q/Q', m being flux² times weight of a pilot's photon. That is
convex in the number of photons of each target, and least where every target's last photon takes
away as much; for cells that exclude each other, where their numbers go with the square root of
the second moment. The photons that come of it carry the lamp's radiation over their own density,
as all photons do: a bad pilot costs noise, never light.

References:
    Vorba et al. (2014), "On-line learning of parametric mixture models for light transport
    simulation", ACM Trans. Graph. 33(4): guiding particles by what earlier ones have brought.
    Douc et al. (2007), "Adaptive importance sampling in general mixture classes", ESAIM: P&S 11:
    mixture weights of least variance.
    CIE 15:2004 §8.2.1: lightness goes with the cube root of luminance.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

import scenes
from sim.photons.aiming import Aim, Guide, View, cells_to_distribution
from sim.photons.lamp_structs import AIM_AREA, AIM_BASE, AIM_CELLS, AIM_CONE, BEAM
from sim.photons.lamps import Lamps
from sim.photons.photon_maps import INDIRECT_WIDTH
from sim.photons.pilot import Pilot, Shots
from sim.scene_data import CompiledScene

__all__ = ["learn_guide"]

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_CELLS = int(AIM_CELLS)

DARKEST = 0.02
"""Irradiance, in parts of the picture's mean, below which noise is minded no more."""

UNIFORM_PART = 0.25
"""Part of a target's photons that stays uniform over its square."""

BASE_PART = 0.03
"""Least part of a lamp's photons that go as it radiates: no photon carries more than 33 of them."""

LEAST_PART = 0.02
"""A receiver aimed at for less than this part of a lamp's photons is not aimed at."""

EQUAL_PART = 0.1
"""Part of all photons that is divided equally among the lamps."""

LEAST_GAIN = 1.15
"""A learned density must promise this many times fewer photons; else the square stays even, and
the points in it stay as well spread as they are."""

LEAST_TO_LEARN = 0.2
"""A target with less than this part of a lamp's photons keeps its even density: two streams that
crowd the same place are not spread as well as one."""

_ROUNDS = 12


def learn_guide(
    compiled: CompiledScene, lamps: Lamps, pilot: Pilot, view: View, *, direct: bool
) -> Guide:
    """Divide photons so that the picture has the least noise.

    Args:
        compiled: the scene.
        lamps: the pilot's lamps.
        pilot: what the pilot's photons have brought.
        view: what the camera sees.
        direct: whether what comes straight from a lamp counts.
    """
    moment = _second_moments(compiled, pilot, view, direct=direct)
    beams = lamps.data.emitters.numpy()["kind"] == BEAM
    learners = [
        _Learner(aims, shots, moment[shots.rows], beam=bool(beam))
        for aims, shots, beam in zip(lamps.aims, pilot.shots, beams, strict=False)
    ]
    total = float(pilot.photons)
    for _ in range(_ROUNDS):
        wanted = [learner.wanted() for learner in learners]
        scale = sum(float(np.sum(one)) for one in wanted)
        for learner, counts in zip(learners, wanted, strict=True):
            if counts.sum() > 0.0:
                learner.counts = total * counts / scale
                learner.learn_cells()
    useful = np.array([one.counts.sum() if len(one.moment) else 0.0 for one in learners])
    shares = np.full(len(useful), 1.0 / len(useful))
    if useful.sum() > 0.0:
        shares = EQUAL_PART * shares + (1.0 - EQUAL_PART) * useful / useful.sum()
    return Guide(tuple(shares.tolist()), tuple(learner.aims() for learner in learners))


class _Learner:
    """One lamp: how many photons each of its targets gets, and where in its square.

    `counts` (targets,) are photons; `cells` (targets, cells²) densities relative to uniform ones.
    """

    def __init__(
        self, aims: tuple[Aim, ...], shots: Shots, moment: FloatArray, *, beam: bool
    ) -> None:
        self.old = aims
        # Only a cone's square and a beam's profile can have a density of their own.
        self.learns = [beam or aim.kind == AIM_CONE for aim in aims]
        # What is worth nothing, and what the lamp does not emit, teaches nothing.
        taught = (moment > 0.0) & (shots.density.sum(axis=1) > 0.0)
        density = shots.density[taught]
        self.total = density.sum(axis=1)
        self.moment = moment[taught]
        self.counts = np.array([aim.share for aim in aims])
        self.counts *= len(moment) / self.counts.sum()
        # Of each target, per photon.
        self.each = density / self.counts
        place = np.clip((shots.square[taught] * _CELLS).astype(np.int64), 0, _CELLS - 1)
        self.cell: IntArray = place[..., 0] * _CELLS + place[..., 1]
        self.cells = np.ones((len(aims), _CELLS**2))

    def parts(self) -> FloatArray:
        """(photons, targets) density of each target at each photon."""
        rows = np.arange(len(self.old))
        found: FloatArray = self.counts * self.each * self.cells[rows, self.cell]
        return found

    def wanted(self) -> FloatArray:
        """Photons of each target, but for a factor: n √(Σ m Q p / Q'²) (Douc et al. 2007)."""
        parts = self.parts()
        mixed = parts.sum(axis=1)
        pull = (self.moment * self.total / mixed**2) @ parts
        found: FloatArray = np.sqrt(self.counts * pull)
        return found

    def learn_cells(self) -> None:
        """Cells' densities, with the square root of the second moment that is each target's."""
        parts = self.parts()
        share = parts * (self.moment * self.total / parts.sum(axis=1))[:, None]
        for k in np.flatnonzero(self.learns):
            found = np.bincount(self.cell[:, k], share[:, k], _CELLS**2)
            self.cells[k] = _density(found)

    def aims(self) -> tuple[Aim, ...]:
        """The lamp's aims as learned; its base always among them."""
        shares = self.counts / self.counts.sum()
        kept = [
            k for k, aim in enumerate(self.old) if aim.kind != AIM_AREA or shares[k] >= LEAST_PART
        ]
        total = sum(shares[k] for k in kept)
        found = []
        for k in kept:
            share = shares[k] / total
            if len(kept) > 1:
                share *= 1.0 - BASE_PART
                share += BASE_PART if self.old[k].kind == AIM_BASE else 0.0
            found.append(self._aim(k, max(share, 1e-3)))
        return tuple(found)

    def _aim(self, k: int, share: float) -> Aim:
        """Aim number k with a share, and with its cells if they are worth it."""
        aim, cells = self.old[k], self.cells[k]
        if np.all(cells == 1.0) or share < LEAST_TO_LEARN:
            return replace(aim, share=share)
        square = cells.reshape(_CELLS, _CELLS) / _CELLS**2
        return replace(aim, share=share, distribution=cells_to_distribution(square))


def _density(moment: FloatArray) -> FloatArray:
    """Density of the cells, relative to a uniform one, for their second moments; all 1: even."""
    square = np.pad(moment.reshape(_CELLS, _CELLS), 1, mode="edge")
    # A cell knows little from its few photons: its neighbours speak for it.
    smooth = sum(
        weight_i * weight_j * square[i : i + _CELLS, j : j + _CELLS]
        for i, weight_i in enumerate((0.25, 0.5, 0.25))
        for j, weight_j in enumerate((0.25, 0.5, 0.25))
    )
    smooth = np.asarray(smooth).ravel()
    root = np.sqrt(smooth)
    even = np.ones(_CELLS**2)
    if root.sum() == 0.0:
        return even
    density = UNIFORM_PART + (1.0 - UNIFORM_PART) * root / root.mean()
    if np.sum(smooth) < LEAST_GAIN * np.sum(smooth / density):
        return even
    return np.asarray(density)


def _second_moments(
    compiled: CompiledScene, pilot: Pilot, view: View, *, direct: bool
) -> FloatArray:
    """(photons,) sum of flux² times weight over each photon's deposits."""
    deposits = pilot.deposits
    seen, light = np.zeros(len(pilot.photon)), np.zeros(len(pilot.photon))
    for prim in np.unique(deposits["object"]).tolist():
        on = np.flatnonzero(deposits["object"] == prim)
        position, flux = deposits["position"][on], deposits["flux"][on]
        seen[on], light[on] = _seen_and_lit(compiled, prim, position, flux, view)
    looked_at = seen * np.divide(deposits["flux"], light, out=np.zeros_like(light), where=light > 0)
    if looked_at.sum() <= 0.0:
        return np.zeros(pilot.photons)
    # Σ v Φ/E is the number of samples there, so that this is the mean of what they see.
    mean = float(np.sum(looked_at * light) / np.sum(looked_at))
    weight = seen * (light + DARKEST * mean) ** (-4.0 / 3.0)
    if not direct:
        bounced = deposits["bounces"] > 0
        weight = weight * ((deposits["refractions"] + deposits["reflections"] > 0) | bounced)
        # As many more photons share the wider disc of what has bounced.
        weight = weight * np.where(bounced, INDIRECT_WIDTH**-2.0, 1.0)
    moments: FloatArray = np.bincount(
        pilot.photon, weight * deposits["flux"] ** 2, pilot.photons
    )
    return moments


def _seen_and_lit(
    compiled: CompiledScene, prim: int, position: FloatArray, flux: FloatArray, view: View
) -> tuple[FloatArray, FloatArray]:
    """At each deposit on an object: samples of the view, and flux, each per area [1/m²]."""
    shape = compiled.scene.objects[prim].shape
    if not isinstance(shape, scenes.Rectangle):
        area = view.seen_area(prim)
        if area <= 0.0:
            return np.zeros(len(flux)), np.ones(len(flux))
        samples = view.fraction(prim) * view.samples / area
        return np.full(len(flux), samples), np.full(len(flux), flux.sum() / area)
    frame, half = np.stack(shape.frame()), 0.5 * np.asarray(shape.size)
    centre = compiled.to_local(shape.position)
    inside = (position - centre) @ frame[:2].T / half
    place = np.clip((0.5 * (inside + 1.0) * _CELLS).astype(np.int64), 0, _CELLS - 1)
    cell = place[:, 0] * _CELLS + place[:, 1]
    area = float(4.0 * half[0] * half[1]) / _CELLS**2
    samples = view.density(prim, frame, centre, half, _CELLS).ravel() / area
    lit = np.bincount(cell, flux, _CELLS**2) / area
    return samples[cell], lit[cell]
