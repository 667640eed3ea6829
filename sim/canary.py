"""The canary: does what is left out of the kernels change the photons more than its bound says?

Some photons, 1 % of a pass, are traced with the kernel that the scene requires and with the full
one, from the same sample points, and compared in pairs. A breach means that a feature is wrongly
off, or its bound wrong: the run goes on with the full kernel, and says so.

- Where all that is left out has a bound of exactly 0, photons must be equal deposit by deposit:
  bit by bit, or to rounding where instructions come in another order.
- Else they are compared photon by photon: the flux that each object gets, and the flux times the
  place where it arrives, over the scene's diameter. What differs, added up over photons and
  divided by the emitted flux, must not pass the sum of the bounds.

A rendering pays seconds for compiling a second kernel, so it keeps a canary only where it leaves
out something with a bound above 0. Absent shapes and the like need none: the tests hold them, and
``nephroid explain --check`` sends the canary for any scene.
"""

import dataclasses
import logging
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import scenes
from sim.features import FeaturePlan, plan_features
from sim.launch import load_kernels
from sim.photons.lamps import compile_lamps
from sim.photons.photon_batch import PhotonBatch
from sim.photons.photon_path import make_trace_photons
from sim.photons.tracing import BRANCH_THRESHOLD, trace_photons
from sim.scene_data import CompiledScene, compile_scene
from sim.settings import ResolvedSettings

__all__ = ["CanaryReport", "KernelChoice", "choose_kernels", "send_canary"]

SHARE = 0.01
"""Of a pass's photons."""

_LEAST_PHOTONS = 1000

_ROUNDING = {"float64": 1e-12, "float32": 1e-5}
"""Relative: what another order of instructions may change along a path."""

_ROULETTE = 1e-2
"""Roulette that falls out differently counts this part of the bound at most: it is played for
less where the two kernels do not follow the same branches."""

FloatArray = npt.NDArray[np.float64]

_log = logging.getLogger("nephroid")


@dataclass(frozen=True)
class CanaryReport:
    """What the canary found.

    Attributes:
        photons: how many were traced twice.
        difference: between the kernels, in the unit of `sim.features.registry`; infinite where
            equal photons were called for and did not even meet the same surfaces.
        allowed: what it may be.
    """

    photons: int
    difference: float
    allowed: float

    @property
    def passed(self) -> bool:
        """Whether what is left out does no more than it is said to."""
        return self.difference <= self.allowed

    def __str__(self) -> str:
        return (
            f"{self.photons} photons differ by {self.difference:.2g} from those of the full"
            f" kernel; allowed: {self.allowed:.2g}"
        )


@dataclass(frozen=True)
class KernelChoice:
    """What a run traces with, and why.

    Attributes:
        compiled: the scene, compiled for the features that are on.
        plan: every feature's decision.
        canary: what it found, if it was sent.
    """

    compiled: CompiledScene
    plan: FeaturePlan
    canary: CanaryReport | None = None

    def report(self) -> dict[str, Any]:
        """What pictures carry of it, ready for JSON."""
        canary = None
        if self.canary is not None:
            canary = {**dataclasses.asdict(self.canary), "passed": self.canary.passed}
            if np.isinf(self.canary.difference):
                canary["difference"] = "other surfaces"  # JSON has no infinity
        return {**self.plan.report(), "canary": canary}


def choose_kernels(
    scene: scenes.Scene, settings: ResolvedSettings, *, device: str, check: bool = False
) -> KernelChoice:
    """Compile `scene` for what it requires; for everything if the canary breaches.

    Args:
        scene: with emitters, if a canary is to be sent.
        settings: of the rendering.
        device: where it runs.
        check: send the canary even where nothing is left out with a bound above rounding.
    """
    plan = plan_features(scene, settings)
    compiled = compile_scene(
        scene, precision=settings.precision, device=device, features=plan.features
    )
    # What can change the last digits alone is held by tests, as what can change nothing is.
    bound = plan.bound if plan.bound > 10.0 * _ROUNDING[settings.precision] else 0.0
    if not (check or bound > 0.0):
        return KernelChoice(compiled, plan)
    full_plan = plan.complete("the canary breached")
    full = compile_scene(
        scene, precision=settings.precision, device=device, features=full_plan.features
    )
    report = send_canary(compiled, full, settings, bound=bound)
    if report.passed:
        return KernelChoice(compiled, plan, report)
    _log.warning("nephroid: warning: canary: %s; using the full kernel", report)
    return KernelChoice(full, full_plan, report)


def send_canary(
    required: CompiledScene, full: CompiledScene, settings: ResolvedSettings, *, bound: float
) -> CanaryReport:
    """Trace the same photons with both kernels, and compare them in pairs.

    Args:
        required: the scene, compiled for what it requires.
        full: the scene, compiled for everything.
        settings: of the rendering.
        bound: the sum of the bounds of what `required` leaves out.
    """
    photons = max(_LEAST_PHOTONS, round(SHARE * settings.photons))
    edges_nm = np.asarray(required.scene.film.edges_nm, dtype=np.float64)
    direct = settings.direct_light == "photons"
    lamps = compile_lamps(required, edges_nm, photons, direct=direct or settings.bounces > 0)
    kernels = [make_trace_photons(one.precision, one.features) for one in (required, full)]
    load_kernels(kernels, device=required.device, threads=settings.threads)
    threshold = min(BRANCH_THRESHOLD, _ROULETTE * bound) if bound > 0.0 else BRANCH_THRESHOLD
    batches = [
        trace_photons(
            one,
            lamps,
            seed=settings.seed,
            pass_index=0,
            max_interactions=settings.max_interactions,
            threads=settings.threads,
            store_direct=direct,
            bounces=settings.bounces,
            range_size=1,
            branch_threshold=threshold,
            by_band=False,  # each photon is a range of its own, and has a row of books
        )
        for one in (required, full)
    ]
    diameter = 2.0 * required.bounding_radius
    compare = _difference_of_photons if bound > 0.0 else _difference_of_deposits
    allowed = bound + _ROUNDING[required.precision]
    return CanaryReport(photons, compare(batches[0], batches[1], diameter), allowed)


def _difference_of_deposits(one: PhotonBatch, other: PhotonBatch, diameter: float) -> float:
    """The most that any deposit differs from its partner, relative; infinite without one."""
    if not np.array_equal(one.deposits, other.deposits):
        return float("inf")
    left, right = one.to_numpy(), other.to_numpy()
    exact = ("object", "face", "side", "refractions", "reflections", "bounces", "dispersed")
    if not all(np.array_equal(left[name], right[name]) for name in (*exact, "emitter")):
        return float("inf")
    if len(one) == 0:
        return 0.0
    return max(
        float(np.max(np.abs(left["position"] - right["position"]))) / diameter,
        float(np.max(np.abs(left["direction"] - right["direction"]))),
        float(np.max(np.abs(left["wavelength_nm"] / right["wavelength_nm"] - 1.0))),
        float(np.max(np.abs(left["flux"] / right["flux"] - 1.0))),
    )


def _difference_of_photons(one: PhotonBatch, other: PhotonBatch, diameter: float) -> float:
    """What the emitted photons' deposits and books differ by, summed, over the emitted flux."""
    objects = 1 + max(int(batch.to_numpy()["object"].max(initial=0)) for batch in (one, other))
    flux, moment = (
        a - b for a, b in zip(_sums(one, objects), _sums(other, objects), strict=True)
    )
    emitted = one.books.emitted
    if emitted == 0.0:
        return 0.0
    displaced = float(np.sum(np.linalg.norm(moment, axis=0))) / diameter
    books = [np.array(batch.books.totals) for batch in (one, other)]
    misplaced = max(float(np.sum(np.abs(flux))), float(np.sum(np.abs(books[0] - books[1]))))
    return max(misplaced, displaced) / emitted


def _sums(batch: PhotonBatch, objects: int) -> tuple[FloatArray, FloatArray]:
    """Of every emitted photon and object: flux, and flux times place, in the local frame."""
    photons = batch.to_numpy()
    rows = np.repeat(np.arange(len(batch.deposits)), batch.deposits) * objects + photons["object"]
    size = len(batch.deposits) * objects
    flux: FloatArray = np.bincount(rows, photons["flux"], size).astype(np.float64)
    places = (photons["position"] - batch.origin).T
    moments = [np.bincount(rows, photons["flux"] * place, size) for place in places]
    return flux, np.stack(moments).astype(np.float64)
