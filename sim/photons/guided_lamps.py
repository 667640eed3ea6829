"""Lamps whose photons go where a pilot has found them to be worth most."""

import numpy as np
import numpy.typing as npt

from sim.photons.aiming import View
from sim.photons.guidance import learn_guide
from sim.photons.lamps import Lamps, compile_lamps
from sim.photons.pilot import trace_pilot
from sim.scene_data import CompiledScene

__all__ = ["compile_guided_lamps"]

FloatArray = npt.NDArray[np.float64]

PILOT_PART = 0.08
"""A pilot's photons, in parts of a pass's; but at least, and at most, as many as a density of
32 × 32 cells needs and can use. It does not grow with the passes, so that a picture that was
stopped after some is the one that was asked for no more."""
FEWEST = 4096
MOST = 32768


def compile_guided_lamps(
    compiled: CompiledScene,
    edges_nm: FloatArray,
    photons: int,
    *,
    view: View,
    seed: int,
    max_interactions: int,
    threads: int,
    bounces: int = 0,
) -> Lamps:
    """Lamps for a picture whose photons are those that have met glass.

    What is found depends on the scene, the camera, the seed and the number of photons alone.

    Args:
        compiled: the scene.
        edges_nm: band edges of the film [nm].
        photons: photons of one pass.
        view: what the camera sees.
        seed: the run's seed.
        max_interactions: surfaces that one photon and all its branches may meet.
        threads: CPU threads.
        bounces: off diffuse surfaces, at most; without any, photons that miss glass are wasted.

    Raises:
        scenes.SceneError: no emitter shines inside the film's wavelengths.
    """
    if compiled.features.method.aiming == "unaimed":
        return compile_lamps(compiled, edges_nm, photons, direct=bounces > 0)
    scouts = int(np.clip(PILOT_PART * photons, FEWEST, MOST))
    lamps = compile_lamps(compiled, edges_nm, scouts, view=view, direct=bounces > 0)
    pilot = trace_pilot(
        compiled, lamps, seed=seed, max_interactions=max_interactions, bounces=bounces,
        threads=threads,
    )
    guide = learn_guide(compiled, lamps, pilot, view, direct=False)
    return compile_lamps(compiled, edges_nm, photons, guide=guide)
