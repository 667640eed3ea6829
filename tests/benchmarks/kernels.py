"""What compiling for no more than a scene requires is worth: the full kernels' time over theirs."""

from history import Measure, median_measure

import scenes
from sim.device import start_device
from sim.feature_costs import FULL_KERNELS, measure_costs
from sim.features import plan_features
from sim.settings import RenderSettings


def compare(name: str, repetitions: int) -> list[Measure]:
    """CPU time of the full kernels over that of the specialised ones, on one thread.

    Args:
        name: of a gallery scene.
        repetitions: each is a median of several runs in turn.
    """
    scene = scenes.load(name)
    settings = RenderSettings(threads=2).resolved(scene)
    plan = plan_features(scene, settings)
    device = start_device("cpu")
    found = [
        measure_costs(plan, scene, settings, device=device, each=False)
        for _ in range(repetitions)
    ]
    return [
        median_measure(
            f"{kernel} kernel: full over specialised, CPU time", name,
            [costs[key] for costs in found], ">= 1",
        )
        for kernel, key in FULL_KERNELS.items()
        if all(key in costs for costs in found)
    ]
