"""One ray through a scene, followed by refraction: for tests, and for pictures of the paths.

It advances by the same `interact` step as photons and camera paths.
"""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.device import start_device
from sim.errors import SettingsError
from sim.features import Features
from sim.ray_path import RayPath
from sim.scene_data import CompiledScene, compile_scene
from sim.transport import (
    EVENT_ABSORB,
    EVENT_BOUNDARY,
    EVENT_DEPOSIT,
    EVENT_PASS,
    make_transport,
)
from spectra import air_index

__all__ = ["trace_compiled_rays", "trace_ray"]

FloatArray = npt.NDArray[np.float64]

_ESCAPE = 0
_REFRACT = 1
_REFLECT = 2
_TOTAL = 3
_DEPOSIT = 4
_ABSORB = 5
_MIRROR = 6
_PASS = 7
_NAMES = (
    "escape", "refract", "reflect", "total internal reflection", "deposit", "absorb", "mirror",
    "pass",
)  # fmt: skip


@functools.cache
def make_trace_single(precision: str, features: Features) -> Any:
    """Kernel that follows one ray a thread and records its vertices."""
    transport = make_transport(precision, features)
    real, vec3, interact = transport.real, transport.vec3, transport.interact
    media_indices = transport.media_indices
    scene_type, ray_type = transport.Scene, transport.Ray

    @wp.kernel(module="unique", enable_backward=False)
    def trace_single(
        scene: scene_type,
        origins: wp.array(dtype=vec3),
        directions: wp.array(dtype=vec3),
        wavelengths_nm: wp.array(dtype=real),
        reflects: wp.array(dtype=int),
        out_points: wp.array2d(dtype=vec3),
        out_directions: wp.array2d(dtype=vec3),
        out_events: wp.array2d(dtype=int),
        out_prims: wp.array2d(dtype=int),
        out_reflectances: wp.array2d(dtype=real),
        out_absorbed: wp.array2d(dtype=real),
        out_counts: wp.array(dtype=int),
    ):
        i = wp.tid()
        ray = ray_type()
        ray.origin = origins[i]
        ray.direction = wp.normalize(directions[i])
        ray.prim = -1
        ray.face = -1
        ray.prim2 = -1
        indices = media_indices(scene, wavelengths_nm[i])
        count = int(0)
        boundaries = int(0)
        for step in range(out_events.shape[1]):
            met = interact(scene, ray, indices)
            out_directions[i, step] = ray.direction
            out_points[i, step] = met.point
            out_prims[i, step] = met.prim
            out_absorbed[i, step] = met.absorbed
            count += 1
            ray.origin = met.point
            ray.prim = met.prim
            ray.face = met.face
            ray.prim2 = met.prim2
            ray.face2 = met.face2
            if met.event == EVENT_PASS:
                out_events[i, step] = _PASS
            elif met.event != EVENT_BOUNDARY:
                out_events[i, step] = _ESCAPE
                if met.event == EVENT_DEPOSIT:
                    out_events[i, step] = _DEPOSIT
                elif met.event == EVENT_ABSORB:
                    out_events[i, step] = _ABSORB
                break
            else:
                out_reflectances[i, step] = met.reflectance
                out_events[i, step] = _REFRACT
                if met.total == 1:
                    out_events[i, step] = _TOTAL
                    if met.opaque == 1:
                        out_events[i, step] = _MIRROR
                    ray.direction = met.reflected
                else:
                    ray.direction = met.refracted
                    if boundaries < reflects.shape[0]:
                        if reflects[boundaries] == 1:
                            out_events[i, step] = _REFLECT
                            ray.direction = met.reflected
                boundaries += 1
        out_counts[i] = count

    return trace_single


def trace_ray(
    scene: scenes.Scene,
    origin: npt.ArrayLike,
    direction: npt.ArrayLike,
    wavelength_nm: float,
    *,
    max_interactions: int = 256,
    branches: Sequence[str] = (),
    precision: str = "float64",
    device: str = "cpu",
) -> RayPath:
    """Follow one ray: it refracts where it can, and reflects where reflection is total.

    Args:
        scene: objects are enough; emitters and a camera are not needed.
        origin: (3,) start [m].
        direction: (3,), of any length.
        wavelength_nm: must lie in the range of every medium of the scene.
        max_interactions: surfaces to follow the ray through.
        branches: which branch to follow at the first boundaries, one by one, "refract" or
            "reflect"; the ray refracts at all later ones. Where reflection is total there is
            no other branch, and the entry is passed over. ("refract", "reflect") in a water
            drop is the primary rainbow.
        precision: "float64" or "float32".
        device: "cpu", or a CUDA device.

    Raises:
        spectra.WavelengthOutOfRange: a medium has no index at the wavelength.
        SettingsError: origin or direction is not three finite numbers, direction is zero, a
            branch is neither "refract" nor "reflect", or max_interactions is below 1.
        DeviceError: the device does not exist.
    """
    compiled = _compiled(scene, precision, start_device(device))
    return trace_compiled_rays(
        compiled,
        _three_numbers("origin", origin)[None],
        _direction(direction)[None],
        np.array([wavelength_nm], dtype=np.float64),
        max_interactions=max_interactions,
        branches=branches,
    )[0]


_recent: list[tuple[scenes.Scene, str, str, CompiledScene]] = []


def _compiled(scene: scenes.Scene, precision: str, device: str) -> CompiledScene:
    """Compile `scene`, or take the one compiled last: rays mostly come in bundles."""
    if _recent and _recent[0][0] is scene and _recent[0][1:3] == (precision, device):
        return _recent[0][3]
    compiled = compile_scene(scene, precision=precision, device=device)
    _recent[:] = [(scene, precision, device, compiled)]
    return compiled


def trace_compiled_rays(
    compiled: CompiledScene,
    origins: FloatArray,
    directions: FloatArray,
    wavelengths_nm: FloatArray,
    *,
    max_interactions: int = 256,
    branches: Sequence[str] = (),
) -> list[RayPath]:
    """Follow many rays, (n, 3) origins [m] and directions and (n,) wavelengths; see `trace_ray`."""
    if max_interactions < 1:
        raise SettingsError("max_interactions", max_interactions, "a whole number from 1")
    reflects = _reflects(branches)
    _require_indices(compiled, wavelengths_nm)
    structs, device, rays = compiled.structs, compiled.device, len(origins)
    size = (rays, max_interactions)
    local = compiled.to_local(origins)
    points = wp.zeros(size, dtype=structs.vec3, device=device)
    ways = wp.zeros(size, dtype=structs.vec3, device=device)
    events = wp.zeros(size, dtype=int, device=device)
    prims = wp.zeros(size, dtype=int, device=device)
    reflectances = wp.zeros(size, dtype=structs.real, device=device)
    absorbed = wp.zeros(size, dtype=structs.real, device=device)
    counts = wp.zeros(rays, dtype=int, device=device)
    wp.launch(
        make_trace_single(compiled.precision, compiled.features),
        dim=rays,
        inputs=[
            compiled.data,
            wp.array(local, dtype=structs.vec3, device=device),
            wp.array(directions, dtype=structs.vec3, device=device),
            wp.array(wavelengths_nm, dtype=structs.real, device=device),
            wp.array(reflects, dtype=int, device=device),
        ],
        outputs=[points, ways, events, prims, reflectances, absorbed, counts],
        device=device,
    )
    record = _Record(
        compiled, local, points.numpy(), ways.numpy(), events.numpy(), prims.numpy(),
        reflectances.numpy(), absorbed.numpy(), counts.numpy(), wavelengths_nm,
    )
    return [record.path(i) for i in range(rays)]


@dataclass(frozen=True)
class _Record:
    """The kernel's output on the host."""

    compiled: CompiledScene
    origins: FloatArray
    points: npt.NDArray[Any]
    ways: npt.NDArray[Any]
    events: npt.NDArray[Any]
    prims: npt.NDArray[Any]
    reflectances: npt.NDArray[Any]
    absorbed: npt.NDArray[Any]
    counts: npt.NDArray[Any]
    wavelengths_nm: FloatArray

    def path(self, i: int) -> RayPath:
        """Ray i as a RayPath in world coordinates."""
        n = int(self.counts[i])
        points = np.vstack([self.origins[i][None], self.points[i, :n]]).astype(np.float64)
        directions = self.ways[i, :n].astype(np.float64)
        events = [_NAMES[event] for event in self.events[i, :n]]
        if events[-1] == "escape":
            points[-1] = self._exit_point(points[-2], directions[-1])
        elif events[-1] not in ("deposit", "absorb"):
            events[-1] = "limit"
        names = [item.name for item in self.compiled.scene.objects]
        return RayPath(
            points=points + self.compiled.origin,
            directions=directions,
            events=tuple(events),
            objects=tuple(names[prim] if prim >= 0 else "" for prim in self.prims[i, :n]),
            reflectances=self.reflectances[i, :n].astype(np.float64),
            absorptances=self.absorbed[i, :n].astype(np.float64),
            wavelength_nm=float(self.wavelengths_nm[i]),
        )

    def _exit_point(self, start: FloatArray, direction: FloatArray) -> FloatArray:
        """Where a ray leaves the sphere of the scene's bounds, twice as large for the eye."""
        reach = 2.0 * self.compiled.bounding_radius
        along = float(np.dot(start, direction))
        closest2 = float(np.dot(start, start)) - along * along
        half_chord = np.sqrt(max(reach * reach - closest2, 0.0))
        exit_point: FloatArray = start + max(half_chord - along, 0.5 * reach) * direction
        return exit_point


def _require_indices(compiled: CompiledScene, wavelengths_nm: FloatArray) -> None:
    """Raise `spectra.WavelengthOutOfRange` where some medium of the scene has no index."""
    for medium in reversed(compiled.media):  # those of the objects first
        medium.eta(wavelengths_nm)
    if compiled.features.air_conversion:
        air_index(wavelengths_nm)


def _reflects(branches: Sequence[str]) -> npt.NDArray[np.int32]:
    """1 for every boundary at which the reflected branch is followed, 0 for the other."""
    allowed = (_NAMES[_REFRACT], _NAMES[_REFLECT])
    if isinstance(branches, str) or not all(branch in allowed for branch in branches):
        raise SettingsError("branches", branches, f"a sequence of {allowed[0]!r} or {allowed[1]!r}")
    return np.array([branch == _NAMES[_REFLECT] for branch in branches], dtype=np.int32)


def _three_numbers(name: str, value: npt.ArrayLike) -> FloatArray:
    """`value` as (3,) finite float64."""
    vector = np.asarray(value, dtype=np.float64)
    if vector.shape != (3,) or not np.all(np.isfinite(vector)):
        raise SettingsError(name, value, "three finite numbers")
    return vector


def _direction(value: npt.ArrayLike) -> FloatArray:
    """`value` as (3,) of a length near 1, so that its square neither overflows nor vanishes."""
    vector = _three_numbers("direction", value)
    if not np.any(vector):
        raise SettingsError("direction", value, "three finite numbers, not all zero")
    _, exponent = np.frexp(np.max(np.abs(vector)))
    scaled: FloatArray = np.ldexp(vector, -exponent)  # a power of two: no digit changes
    return scaled
