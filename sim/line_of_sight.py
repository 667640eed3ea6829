"""Whether one point can be seen from another, glass left out of account."""

import functools
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.features import Features
from sim.scene_data import CompiledScene
from sim.scene_structs import DIELECTRIC
from sim.transport import make_transport

__all__ = ["in_sight"]

NEAR = 1.0 - 1e-6
"""What is as far as this part of the way is the surface that the point lies on."""

MOST_FACES = wp.constant(64)


@functools.cache
def make_look_straight(precision: str, features: Features) -> Any:
    """Kernel: 1 for each point that no opaque surface hides from the eye."""
    transport = make_transport(precision, features)
    real, vec3, intersect = transport.real, transport.vec3, transport.intersect
    scene_type, free_ray = transport.Scene, transport.free_ray

    @wp.kernel(module="unique", enable_backward=False)
    def look_straight(
        scene: scene_type, eye: vec3, points: wp.array(dtype=vec3), out_seen: wp.array(dtype=int)
    ):
        i = wp.tid()
        line = points[i] - eye
        left = wp.length(line) * real(NEAR)
        ray = free_ray(eye, wp.normalize(line))
        seen = int(1)
        for _face in range(MOST_FACES):
            hit = intersect(scene, ray)
            if hit.prim < 0 or hit.t >= left:
                break
            if scene.bodies[hit.prim].material != DIELECTRIC:
                seen = 0
                break
            left -= hit.t
            ray.origin += ray.direction * hit.t
            ray.prim = hit.prim
            ray.face = hit.face
        out_seen[i] = seen

    return look_straight


def in_sight(
    compiled: CompiledScene, eye: npt.ArrayLike, points: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Which of (n, 3) world points [m] nothing opaque hides from the `eye`, (3,) [m]."""
    device, vec3 = compiled.device, compiled.structs.vec3
    seen = wp.zeros(len(points), dtype=int, device=device)
    wp.launch(
        make_look_straight(compiled.precision, compiled.features),
        dim=len(points),
        inputs=[
            compiled.data,
            vec3(*compiled.to_local(eye)),
            wp.array(compiled.to_local(points), dtype=vec3, device=device),
        ],
        outputs=[seen],
        device=device,
    )
    return np.asarray(seen.numpy() == 1)
