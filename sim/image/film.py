"""The film: radiance of each pixel and band, averaged over passes, with its spread."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from sim.image.accuracy import Accuracy
from sim.image.camera_path import make_film_struct, make_render_camera
from sim.launch import Range, cut_ranges, launch_ranges
from sim.named_arrays import NamedArrays
from sim.sampling.counter import fold_key
from sim.scene_data import CompiledScene

__all__ = ["Film", "create_film", "expose", "turns_of"]

FloatArray = npt.NDArray[np.float64]

_RANGE_SIZE = 1024
"""Pixels a launch: behind glass each costs a path a band."""

_CAMERA_KEY = 0xCA3E2A
"""Tells the camera's random numbers from the photons' of the same seed and pass."""


_SUMS = ("mean", "squares", "tally")
"""What a film adds up; its `sample` too, while a round of turns is under way."""


@dataclass
class Film:
    """Running mean and squared deviations over passes, on the device.

    Attributes:
        height, width: pixels.
        edges_nm: (bands + 1,) band edges [nm].
        data: the device-side Film struct.
        turns: passes that make one complete sample; see `sim.image.camera_path`.
        passes: passes exposed so far.
    """

    height: int
    width: int
    edges_nm: FloatArray
    data: Any
    turns: int = 1
    passes: int = 0

    @property
    def shape(self) -> tuple[int, int, int]:
        """(height, width, bands)."""
        return self.height, self.width, len(self.edges_nm) - 1

    @property
    def rounds(self) -> int:
        """Complete samples so far: independent replicates of each pixel."""
        return self.passes // self.turns

    def radiance(self) -> FloatArray:
        """Mean over passes, (height, width, bands) [W m⁻² sr⁻¹ nm⁻¹]."""
        mean: FloatArray = self.data.mean.numpy().reshape(self.shape)
        return mean

    def standard_error(self) -> FloatArray:
        """One σ of the mean, same shape and unit; NaN from a single sample."""
        return self._error_of(self.data.squares.numpy()).reshape(self.shape)

    def accuracy(self) -> Accuracy:
        """How sure the luminance of each pixel is, noise and bias apart."""
        tally = self.data.tally.numpy().reshape(*self.shape[:2], 6)
        return Accuracy(
            luminance=tally[..., 0].copy(),
            noise=self._error_of(tally[..., 1]),
            bias=tally[..., 2].copy(),
            bias_noise=self._error_of(tally[..., 3]),
            corrected_noise=self._error_of(tally[..., 5]),
            replicates=self.rounds,
        )

    def state(self) -> NamedArrays:
        """What it takes to go on after this pass, by name; views on the CPU, for the moment."""
        names = _SUMS if self.passes % self.turns == 0 else (*_SUMS, "sample")
        return {name: getattr(self.data, name).numpy() for name in names}

    def restore(self, passes: int, state: NamedArrays) -> None:
        """Be as another film was after some passes.

        Args:
            passes: how many.
            state: what its `state` was.

        Raises:
            ValueError: it is of a film of another size; says so.
        """
        names = _SUMS if passes % self.turns == 0 else (*_SUMS, "sample")
        for name in names:
            mine, other = getattr(self.data, name), state.get(name)
            if other is None or other.shape != mine.shape or other.dtype != np.float64:
                raise ValueError(f"its film's {name} has another shape")
            mine.assign(other)
        self.passes = passes

    def _error_of(self, squares: FloatArray) -> FloatArray:
        """Rounds are independent estimates: σ² = Σ(x − x̄)² / (n (n − 1)) of their mean."""
        n = self.rounds
        if n < 2:
            return np.full(squares.shape, np.nan)
        # In place: of a large picture each copy is half a gigabyte.
        error = squares / (n * (n - 1.0))
        return np.sqrt(error, out=error)


def create_film(
    edges_nm: FloatArray, lamps: int, device: str, *,
    radius_scale: npt.NDArray[np.float32], passes: int,
) -> Film:
    """An unexposed film, with scratch for the sums of lamps beside those of the bands.

    Args:
        edges_nm: (bands + 1,) band edges [nm].
        lamps: emitters that shine.
        device: where it lives.
        radius_scale: (height, width) each pixel's gather radius in that of the photon map.
        passes: how many passes it will be exposed to.
    """
    height, width = radius_scale.shape
    data = make_film_struct()()
    data.radius_scale = wp.array(radius_scale.ravel(), dtype=wp.float32, device=device)
    size = (height * width, len(edges_nm) - 1)
    data.sample = wp.zeros((size[0], size[1] + lamps + 1), dtype=wp.float64, device=device)
    data.mean = wp.zeros(size, dtype=wp.float64, device=device)
    data.squares = wp.zeros(size, dtype=wp.float64, device=device)
    data.tally = wp.zeros((size[0], 6), dtype=wp.float64, device=device)
    return Film(height, width, np.asarray(edges_nm, dtype=np.float64), data, turns_of(passes))


def turns_of(passes: int) -> int:
    """Turns in which the bands behind glass are sampled: two, if that leaves two replicates.

    They divide the number of passes, so that every band is sampled equally often: colours stay
    neutral exactly.
    """
    return 2 if passes % 2 == 0 and passes >= 4 else 1


def expose(
    film: Film,
    compiled: CompiledScene,
    camera: Any,
    lights: Any,
    *,
    seed: int,
    pass_index: int,
    threads: int,
    pixels: Sequence[Range] | None = None,
    on_done: Callable[[int], None] | None = None,
) -> None:
    """Expose `film` to one pass: a camera path a pixel, gathering from `lights`.

    Args:
        film: what the pass is averaged into.
        compiled: the scene.
        camera: the device-side Camera struct.
        lights: the device-side Lights struct, with this pass's photons.
        seed: the run's seed.
        pass_index: decides the position within the pixels and the bands; a round of turns starts
            at a multiple of their number.
        threads: CPU threads.
        pixels: ranges of those to expose, row by row; None: all.
        on_done: told of finished pixels.
    """
    data = film.data
    data.rounds_before = film.rounds
    data.round, data.turn = divmod(pass_index, film.turns)
    data.turns = film.turns
    data.key = fold_key(seed, _CAMERA_KEY)
    inputs = [compiled.data, camera, lights, data]
    launch_ranges(
        make_render_camera(compiled.precision, compiled.features),
        cut_ranges(film.height * film.width, _RANGE_SIZE) if pixels is None else pixels,
        lambda _: inputs,
        device=compiled.device,
        threads=threads,
        on_done=on_done,
    )
    film.passes += 1
