"""One ray through a scene, followed by refraction: for tests, and for pictures of the paths.

It advances by the same `interact` step as photons and camera paths.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

import scenes
from sim.device import start_device
from sim.errors import SettingsError
from sim.ray_path import RayPath
from sim.scene_data import CompiledScene, compile_scene
from sim.scene_media import require_known
from sim.single_ray_kernel import EVENT_NAMES, REFLECT, REFRACT, make_trace_single

__all__ = ["trace_compiled_rays", "trace_ray"]

FloatArray = npt.NDArray[np.float64]

def trace_ray(
    scene: scenes.Scene,
    origin: npt.ArrayLike,
    direction: npt.ArrayLike,
    wavelength_nm: float,
    *,
    max_interactions: int = 256,
    branches: Sequence[str] = (),
    polarisation: scenes.Polarisation | None = None,
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
        polarisation: of the light that starts; None: natural light.
        precision: "float64" or "float32".
        device: "cpu", or a CUDA device.

    Raises:
        spectra.WavelengthOutOfRange: a medium has no index at the wavelength.
        SettingsError: origin or direction is not three finite numbers, direction is zero, a
            branch is neither "refract" nor "reflect", max_interactions is below 1, or the
            polarisation's `up` is parallel to the ray.
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
        polarisation=polarisation,
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
    polarisation: scenes.Polarisation | None = None,
) -> list[RayPath]:
    """Follow many rays, (n, 3) origins [m] and directions and (n,) wavelengths; see `trace_ray`."""
    if max_interactions < 1:
        raise SettingsError("max_interactions", max_interactions, "a whole number from 1")
    reflects = _reflects(branches)
    has_air = compiled.features.air_conversion
    require_known(compiled.scene, compiled.media, wavelengths_nm, has_air=has_air)
    light, ups = _start(polarisation, directions)
    structs, device, rays = compiled.structs, compiled.device, len(origins)
    size = (rays, max_interactions)
    local = compiled.to_local(origins)
    points = wp.zeros(size, dtype=structs.vec3, device=device)
    ways = wp.zeros(size, dtype=structs.vec3, device=device)
    events = wp.zeros(size, dtype=int, device=device)
    prims = wp.zeros(size, dtype=int, device=device)
    reflectances = wp.zeros(size, dtype=structs.real, device=device)
    absorbed = wp.zeros(size, dtype=structs.real, device=device)
    lights = wp.zeros(size, dtype=structs.vec3, device=device)
    frames = wp.zeros(size, dtype=structs.vec3, device=device)
    normals = wp.zeros(size, dtype=structs.vec3, device=device)
    counts = wp.zeros(rays, dtype=int, device=device)
    wp.launch(
        make_trace_single(
            compiled.precision, replace(compiled.features, polarisation=True, stokes=True)
        ),
        dim=rays,
        inputs=[
            compiled.data,
            wp.array(local, dtype=structs.vec3, device=device),
            wp.array(directions, dtype=structs.vec3, device=device),
            wp.array(wavelengths_nm, dtype=structs.real, device=device),
            wp.array(reflects, dtype=int, device=device),
            structs.vec3(*light),
            wp.array(ups, dtype=structs.vec3, device=device),
        ],
        outputs=[
            points, ways, events, prims, reflectances, absorbed, lights, frames, normals, counts,
        ],
        device=device,
    )
    record = _Record(
        compiled, local, points.numpy(), ways.numpy(), events.numpy(), prims.numpy(),
        reflectances.numpy(), absorbed.numpy(), lights.numpy(), frames.numpy(), normals.numpy(),
        counts.numpy(), wavelengths_nm,
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
    lights: npt.NDArray[Any]
    frames: npt.NDArray[Any]
    normals: npt.NDArray[Any]
    counts: npt.NDArray[Any]
    wavelengths_nm: FloatArray

    def path(self, i: int) -> RayPath:
        """Ray i as a RayPath in world coordinates."""
        n = int(self.counts[i])
        points = np.vstack([self.origins[i][None], self.points[i, :n]]).astype(np.float64)
        directions = self.ways[i, :n].astype(np.float64)
        events = [EVENT_NAMES[event] for event in self.events[i, :n]]
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
            polarisations=self.lights[i, :n].astype(np.float64),
            frames=self.frames[i, :n].astype(np.float64),
            normals=self.normals[i, :n].astype(np.float64),
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


def _start(
    polarisation: scenes.Polarisation | None, directions: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(q, u, v) of the light that starts, and (n, 3) what its angles are counted from."""
    if polarisation is None:
        return np.zeros(3), np.broadcast_to([0.0, 1.0, 0.0], directions.shape)
    ups = []
    for direction in directions:
        up = polarisation.reference(direction / np.linalg.norm(direction))
        if up is None:
            allowed = "a direction not parallel to the ray's"
            raise SettingsError("polarisation.up", polarisation.up, allowed)
        ups.append(up)
    return polarisation.stokes(), np.array(ups)


def _reflects(branches: Sequence[str]) -> npt.NDArray[np.int32]:
    """1 for every boundary at which the reflected branch is followed, 0 for the other."""
    allowed = (EVENT_NAMES[REFRACT], EVENT_NAMES[REFLECT])
    if isinstance(branches, str) or not all(branch in allowed for branch in branches):
        raise SettingsError("branches", branches, f"a sequence of {allowed[0]!r} or {allowed[1]!r}")
    return np.array([branch == EVENT_NAMES[REFLECT] for branch in branches], dtype=np.int32)


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
