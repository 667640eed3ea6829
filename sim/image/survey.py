"""A survey of what the camera sees: how wide pixels are there, and where it is.

The widths set the gather radius. The points tell emission which part of a large receiver is in
the picture.

A pixel is as wide as the root of the area that it covers on what it sees. Rays to the middles of
its neighbours, right and below, tell that area: they are reflected and refracted where its own ray
is (finite differences in place of the derivatives of Igehy 1999, "Tracing ray differentials",
SIGGRAPH). What a lens enlarges has small pixels.
"""

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.features import Features
from sim.image.camera import make_camera_functions, make_camera_struct
from sim.scene_data import CompiledScene
from sim.transport import EVENT_BOUNDARY, EVENT_DEPOSIT, EVENT_PASS, make_transport

__all__ = ["Survey", "make_measure_footprints", "survey_view"]

FloatArray = npt.NDArray[np.float64]

_GRID = 128
_SURFACES = wp.constant(16)


@wp.func
def is_reflecting(i: int, samples: int):
    """1 for one sample in four, every other one of every other row: it looks at reflections."""
    return (i % samples) & (i // samples) & 1


@functools.cache
def make_measure_footprints(precision: str, features: Features) -> Any:
    """Kernel: width [m], place and object of sampled pixels on the receivers they see."""
    transport = make_transport(precision, features)
    real, vec3, interact = transport.real, transport.vec3, transport.interact
    media_indices = transport.media_indices
    scene_type, free_ray = transport.Scene, transport.free_ray
    camera_type = make_camera_struct(precision)
    look = make_camera_functions(precision, features).look

    @wp.func
    def land(
        scene: scene_type, camera: camera_type, wavelength_nm: real, x: real, y: real, way: int
    ):
        """Follow a pixel's ray: where it lands, on what, by which way, and as how wide a pixel.

        A way is a bit a boundary, 1 where the ray is reflected. `way` ≥ 0 is taken as it is; else
        the ray takes the stronger branch, after a reflection at the first boundary if it is −2.
        The width is that of a pixel at the end of a straight path of the same length.
        """
        ray = free_ray(camera.position, look(camera, x, y))
        # A pixel at the image's corner is smaller in angle: of its solid angle's cos³θ of the axis,
        # and 1/cos²θ of the distance squared, cosθ is left over the distance along the axis.
        forward = wp.normalize(wp.cross(camera.step_right, camera.step_down))
        cos_axis = wp.dot(ray.direction, forward)
        indices = media_indices(scene, wavelength_nm)
        axial = real(0.0)
        width = real(0.0)
        prim = int(-1)
        taken = int(0)
        boundaries = int(0)
        point = camera.position
        for _k in range(_SURFACES):
            met = interact(scene, ray, indices)
            axial += wp.abs(wp.dot(ray.direction, forward)) * met.t
            if met.event == EVENT_DEPOSIT:
                cos_theta = -wp.dot(ray.direction, met.normal)
                # The footprint is an ellipse: the radius of the disc of equal area.
                width = wp.length(camera.step_right) * axial
                width *= wp.sqrt(cos_axis / wp.max(cos_theta, real(0.05)))
                point = met.point
                prim = met.prim
            if met.event != EVENT_BOUNDARY and met.event != EVENT_PASS:
                break
            ray.origin = met.point
            ray.prim = met.prim
            ray.face = met.face
            ray.prim2 = met.prim2
            ray.face2 = met.face2
            if met.event == EVENT_BOUNDARY:
                reflects = met.reflectance > real(0.5) or (boundaries == 0 and way == -2)
                if way >= 0:
                    reflects = (way >> boundaries) & 1 == 1
                ray.direction = met.refracted
                if reflects:
                    ray.direction = met.reflected
                    taken = taken | (1 << boundaries)
                boundaries += 1
        return point, prim, taken, width

    @wp.kernel(module="unique", enable_backward=False)
    def measure_footprints(
        scene: scene_type,
        camera: camera_type,
        wavelength_nm: real,
        samples: int,
        out_width: wp.array(dtype=real),
        out_point: wp.array(dtype=vec3),
        out_prim: wp.array(dtype=int),
    ):
        i = wp.tid()
        step = real(samples)
        x = (real(i % samples) + real(0.5)) / step * real(camera.width)
        y = (real(i // samples) + real(0.5)) / step * real(camera.height)
        way = int(-1)
        if is_reflecting(i, samples) == 1:
            way = -2
        point, prim, taken, width = land(scene, camera, wavelength_nm, x, y, way)
        one = real(1.0)
        right, right_prim, _r, _s = land(scene, camera, wavelength_nm, x + one, y, taken)
        below, below_prim, _t, _u = land(scene, camera, wavelength_nm, x, y + one, taken)
        if right_prim == prim and below_prim == prim:
            area = wp.length(wp.cross(right - point, below - point))
            # Enlarged, a pixel is narrower than at the end of a straight path, and the photons in
            # its disc are as many fewer: half way between, on a scale of logarithms.
            own = wp.sqrt(area)
            width = wp.sqrt(own * wp.max(own, width))
        out_width[i] = width
        out_point[i] = point
        out_prim[i] = prim

    return measure_footprints


@dataclass(frozen=True)
class Survey:
    """What a grid of sampled pixels sees.

    Attributes:
        widths: (n,) width of the pixel on the receiver [m].
        points: (n, 3) where, in the local frame [m].
        objects: (n,) which object.
        width_grid: (rows, columns) the widths where the samples are in the picture; NaN of those
            that see no receiver, or look at what glass reflects first.
    """

    widths: FloatArray
    points: FloatArray
    objects: npt.NDArray[np.int32]
    width_grid: FloatArray

    def fraction(self, prim: int) -> float:
        """Fraction of the samples that see a receiver which see this one."""
        return float(np.mean(self.objects == prim)) if len(self.objects) else 0.0

    @property
    def samples(self) -> int:
        """How many samples see a receiver."""
        return len(self.objects)

    def seen_area(self, prim: int) -> float:
        """About how large the part of an object is that is seen [m²]: as wide and long as that."""
        points = self.points[self.objects == prim]
        if len(points) < 2:
            return 0.0
        extents = np.sort(np.ptp(points, axis=0))
        return float(extents[-1] * extents[-2])

    def density(
        self, prim: int, frame: FloatArray, centre: FloatArray, half: FloatArray, cells: int
    ) -> FloatArray:
        """(cells, cells) samples that see each part of a rectangle or one next to it.

        Args:
            prim: the object.
            frame: (3, 3), its rows u, v, normal.
            centre: (3,) in the local frame [m].
            half: (2,) half sizes [m].
            cells: parts a side, along u and along v.
        """
        inside = (self.points[self.objects == prim] - centre) @ frame[:2].T / half
        edges = np.linspace(-1.0, 1.0, cells + 1)
        counts: FloatArray = np.histogram2d(inside[:, 0], inside[:, 1], bins=(edges, edges))[0]
        # A cell that the picture's border cuts must not get few photons for the part it shows,
        # so each cell counts as its densest neighbour.
        padded = np.pad(counts, 1)
        shifts = [padded[i : i + cells, j : j + cells] for i in range(3) for j in range(3)]
        densest: FloatArray = np.max(shifts, axis=0)
        return densest


def survey_view(compiled: CompiledScene, camera: Any, wavelength_nm: float) -> Survey:
    """Follow a grid of pixels to the receivers they see."""
    types, device, count = compiled.structs, compiled.device, _GRID * _GRID
    widths = wp.zeros(count, dtype=types.real, device=device)
    points = wp.zeros(count, dtype=types.vec3, device=device)
    objects = wp.zeros(count, dtype=int, device=device)
    wp.launch(
        make_measure_footprints(compiled.precision, compiled.features),
        dim=count,
        inputs=[compiled.data, camera, wavelength_nm, _GRID],
        outputs=[widths, points, objects],
        device=device,
    )
    prims, width = objects.numpy(), widths.numpy().astype(np.float64)
    seen = (prims >= 0) & np.isfinite(width)
    sample = np.arange(count)
    straight = (sample % _GRID) & (sample // _GRID) & 1 == 0  # as `is_reflecting`
    return Survey(
        widths=width[seen],
        points=points.numpy()[seen].astype(np.float64),
        objects=prims[seen],
        width_grid=np.where(seen & straight, width, np.nan).reshape(_GRID, _GRID),
    )
