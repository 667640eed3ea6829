"""Tell what a scene requires of the simulator, feature by feature, and what that costs.

Kernels are compiled for what the scene requires and no more. For each feature: whether it is on,
the bound on the error that leaving it out can cause, the time of the kernel with it over that
without it, and why. A feature is left out where its bound is 0, or while the bounds of all that is
left out add up to no more than the tolerance. Last, memory: a run that has less than it will take
refuses to begin.
"""

from __future__ import annotations

import argparse
import functools
import sys
from typing import TYPE_CHECKING

from sim.commands.arguments import add_scene_arguments, load_scene

if TYPE_CHECKING:
    from scenes import Scene
    from sim.canary import CanaryReport
    from sim.features import Decision, FeaturePlan
    from sim.memory.estimate import MemoryEstimate
    from sim.settings import ResolvedSettings

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "what a scene requires of the simulator, and what that costs"

_CHECK_FAILED = 1


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    add_scene_arguments(parser)
    parser.add_argument("--measure", action="store_true",
                        help="measure the times here, on this scene (a minute or two)")
    parser.add_argument("--memory", action="store_true",
                        help="trace some photons, to tell what memory a run takes at its peak")
    parser.add_argument("--check", action="store_true",
                        help="trace 1%% of a pass's photons with the full kernel as well, and"
                             " compare; status 1 if they differ by more than the bounds say")
    parser.add_argument("--tolerance", type=float, default=1e-6, metavar="BOUND",
                        help="that the bounds of what is left out may add up to (default: 1e-6)")
    parser.add_argument("--precision", choices=("float32", "float64"),
                        help="arithmetic of tracing (default: float64 on cpu, else float32)")
    parser.add_argument("--device", default="cpu", help="cpu (default), cuda:0, …")


def run(arguments: argparse.Namespace) -> None:
    """Print the table, and below it what it adds up to."""
    from sim.features import BOUND_UNIT, RECORDED_ON, plan_features
    from sim.interruption import run_interruptibly
    from sim.settings import RenderSettings

    settings = RenderSettings(
        omission_tolerance=arguments.tolerance,
        precision=arguments.precision,
        device=arguments.device,
    )
    scene = load_scene(arguments)
    resolved = settings.resolved(scene)
    plan = plan_features(scene, resolved)
    costs = None
    if arguments.measure:
        costs = run_interruptibly(functools.partial(_measured, plan, scene, resolved))
    print(f"{scene.source_name}: {scene.title}" if scene.title else scene.source_name)
    _print_table(plan, costs)
    off = sum(not one.on for one in plan.decisions)
    print(f"{off} of {len(plan.decisions)} features are left out; their bounds add up to"
          f" {plan.bound:.2g} of the tolerated {plan.tolerance:.2g}")
    print(f"bound: relative, {BOUND_UNIT}")
    where = "measured here, on this scene" if arguments.measure else f"recorded on {RECORDED_ON}"
    print(f"time: of the kernel with the feature ÷ without it, {where}")
    if costs is not None:
        _print_full_kernels(costs)
    print(_memory_text(scene, resolved, traced=arguments.memory))
    if arguments.check:
        _print_canary(run_interruptibly(functools.partial(_checked, scene, resolved)))


def _measured(plan: FeaturePlan, scene: Scene, settings: ResolvedSettings) -> dict[str, float]:
    from sim.device import start_device
    from sim.feature_costs import measure_costs

    return measure_costs(plan, scene, settings, device=start_device(settings.device))


def _checked(scene: Scene, settings: ResolvedSettings) -> CanaryReport | None:
    from sim.canary import choose_kernels
    from sim.device import start_device

    device = start_device(settings.device)
    return choose_kernels(scene, settings, device=device, check=True).canary


def _memory_text(scene: Scene, settings: ResolvedSettings, *, traced: bool) -> str:
    """What a run would take, if photons may be traced for it, and what there is."""
    from sim.interruption import run_interruptibly
    from sim.memory.available import available_memory
    from sim.memory.sizes import film_memory, size_text

    available = available_memory()
    there = "" if available is None else f"; {size_text(available)} are there"
    if not traced and scene.camera is None:
        return f"memory: --memory tells what a run takes{there}"
    if not traced:
        film = size_text(sum(film_memory(scene)))
        return f"memory: the film takes {film}{there}; --memory adds what photons take"

    def foresee() -> MemoryEstimate:
        from sim.memory.prospect import foresee_memory

        return foresee_memory(scene, settings, pictured=scene.camera is not None)

    return f"memory: a run takes about {run_interruptibly(foresee)}{there}"


def _print_table(plan: FeaturePlan, costs: dict[str, float] | None) -> None:
    """One line a feature; its time is the measured one, or with its scene the recorded one."""
    print(f"  {'feature':<20} {'is':<4} {'bound':>7}  {'time':<14} why")
    for one in plan.decisions:
        on = "on" if one.on else "off"
        time = _time(one, costs)
        print(f"  {one.feature.name:<20} {on:<4} {one.bound:>7.2g}  {time:<14} {one.reason}")


def _time(one: Decision, costs: dict[str, float] | None) -> str:
    if costs is not None:
        ratio = costs.get(one.feature.name)
        return "–" if ratio is None else f"{ratio:.2f}"
    cost = one.feature.cost
    return "–" if cost is None else f"{cost.ratio:.2f} ({cost.scene})"


def _print_full_kernels(costs: dict[str, float]) -> None:
    """What compiling for no more than the scene requires is worth."""
    from sim.feature_costs import FULL_KERNELS

    for name in FULL_KERNELS.values():
        if name in costs:
            print(f"{name}: {costs[name]:.2f} of the time of the one that the scene requires")


def _print_canary(report: CanaryReport | None) -> None:
    """What the canary found.

    Raises:
        SystemExit: with status 1, if it breached.
    """
    assert report is not None  # it was sent for
    print(f"canary: {report}")
    if not report.passed:
        sys.exit(_CHECK_FAILED)
