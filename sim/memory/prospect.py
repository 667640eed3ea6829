"""What a run of a scene would take, without the run: its kernels are compiled, its lamps aimed."""

import numpy as np

import scenes
from sim.canary import choose_kernels
from sim.device import start_device
from sim.image.camera import compile_camera
from sim.image.survey import survey_view
from sim.launch import load_kernels
from sim.memory.estimate import MemoryEstimate, estimate_memory
from sim.photons.lamps import compile_lamps
from sim.render import compile_lamps_for, kernels_of
from sim.settings import ResolvedSettings

__all__ = ["foresee_memory"]


def foresee_memory(
    scene: scenes.Scene, settings: ResolvedSettings, *, pictured: bool
) -> MemoryEstimate:
    """What rendering or, without a picture, measuring a scene would take at its peak.

    Raises:
        SceneError: there is nothing to render or to measure.
    """
    if pictured:
        scene.require_renderable()
    else:
        scene.require_measurable()
    device = start_device(settings.device)
    compiled = choose_kernels(scene, settings, device=device).compiled
    kernels = kernels_of(settings.precision, compiled.features)
    load_kernels(kernels, device=device, threads=settings.threads)
    edges_nm = np.asarray(scene.film.edges_nm, dtype=np.float64)
    if not pictured:
        lamps = compile_lamps(compiled, edges_nm, settings.photons)
    else:
        assert scene.camera is not None  # require_renderable has seen to it
        camera = compile_camera(compiled, scene.camera, scene.film)
        survey = survey_view(compiled, camera, float(0.5 * (edges_nm[0] + edges_nm[-1])))
        lamps = compile_lamps_for(compiled, survey, settings)
    return estimate_memory(compiled, lamps, settings, pictured=pictured)
