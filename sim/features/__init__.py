"""What a scene requires, and what kernels are compiled for.

`registry` holds the features, each registered by one of the modules below; `plan` judges a scene
by them; `flags` is what kernels ask.
"""

import sim.features.arithmetic
import sim.features.camera
import sim.features.lamps
import sim.features.light
import sim.features.matter
import sim.features.media
import sim.features.polarised
import sim.features.sensors
import sim.features.shapes  # noqa: F401 (importing registers)
from sim.features.flags import Features, LightMode
from sim.features.plan import Decision, FeaturePlan, find_features, judge_features, plan_features
from sim.features.registry import (
    BOUND_UNIT,
    RECORDED_ON,
    Build,
    Cost,
    Feature,
    Subject,
    Verdict,
    needed,
    null,
    register,
    registered,
)

__all__ = [
    "BOUND_UNIT", "RECORDED_ON", "Build", "Cost", "Decision", "Feature", "FeaturePlan", "Features",
    "LightMode", "Subject", "Verdict", "find_features", "judge_features", "needed", "null",
    "plan_features", "register", "registered",
]  # fmt: skip
