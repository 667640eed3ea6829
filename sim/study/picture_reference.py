"""The picture that a study's pictures are measured against: a long run at a smaller gather radius.

Its noise comes from the scatter of its parts, its bias from a second kernel.

References:
    Schucany & Sommers (1977), JASA 72, 420: a kernel's bias from a second kernel.
"""

from __future__ import annotations

import math
import time

import numpy as np
import numpy.typing as npt

from sim.study.references import FEWEST, Reference, mean_and_noise
from sim.study.setup import SeedSource, Setup
from sim.study.workshop import Workshop

__all__ = ["picture_reference"]

FloatArray = npt.NDArray[np.float64]

RADIUS_PARTS = (1 / 2, 1 / 4, 1 / 8)
"""Gather radii of a picture's reference, in those of the study."""


def picture_reference(
    workshop: Workshop, setup: Setup, seeds: SeedSource, *, goal: float, cpu_s: float
) -> Reference:
    """A long run, in independent parts of as many passes as the setup has.

    Its gather radius is a fraction of the setup's, such that bias and noise come out alike.

    Args:
        workshop: to run in.
        setup: the study's centre.
        seeds: none of which an estimate uses.
        goal: relative error of the luminance that is small enough.
        cpu_s: time to spend, in CPU-seconds.
    """
    end = time.process_time() + cpu_s
    for part in RADIUS_PARTS:
        run = _LongRun(workshop, setup, seeds, part)
        begin = time.process_time()
        run.extend(FEWEST)
        # With the time that is left, noise will be this much less.
        affordable = FEWEST * max(end - begin, 0.0) / (time.process_time() - begin)
        noise = run.noise * math.sqrt(FEWEST / max(affordable, FEWEST))
        if run.bias <= max(noise, goal):
            break
    while run.noise > goal and time.process_time() < end:
        run.extend(1)
    return run.reference()


class _LongRun:
    """A reference of a picture as it grows."""

    def __init__(self, workshop: Workshop, setup: Setup, seeds: SeedSource, part: float) -> None:
        """Begin, with this part of the setup's gather radius and four times its photons."""
        assert setup.settings.photons is not None
        self.workshop, self.seeds, self.part = workshop, seeds, part
        self.setup = setup.with_radius(part).with_settings(
            alpha=1.0, photons=4 * setup.settings.photons
        )
        self.colours: list[FloatArray] = []
        self.biases: list[FloatArray] = []

    def extend(self, runs: int) -> None:
        """Add independent runs."""
        for _ in range(runs):
            sample = self.workshop.run(self.setup, self.seeds.take(), ("picture",))
            assert sample.xyz is not None and sample.bias is not None
            self.colours.append(sample.xyz)
            self.biases.append(sample.bias)

    @property
    def noise(self) -> float:
        """Relative L2 noise of the mean luminance."""
        return mean_and_noise([one[..., 1] for one in self.colours])[1]

    @property
    def bias(self) -> float:
        """Relative L2 bias of the luminance by the second kernel, its own noise taken out."""
        bias, noise = mean_and_noise(self.biases)
        luminance = np.mean([one[..., 1] for one in self.colours], axis=0)
        square = float(np.sum(bias**2)) * (1.0 - min(noise**2, 1.0))
        return math.sqrt(square / float(np.sum(luminance**2)))

    def reference(self) -> Reference:
        """The mean, and how its error is known."""
        settings = self.setup.settings
        how = (
            f"{len(self.colours)} independent runs of {settings.passes} passes of "
            f"{settings.photons:,} photons at {self.part:g} of the gather radius, with other seeds "
            f"than any estimate; their scatter tells the noise of their mean, {self.noise:.2g}, "
            f"and a second kernel of half the area its bias, {self.bias:.2g}"
        )
        xyz: FloatArray = np.mean(self.colours, axis=0)
        return Reference(xyz, "long run", self.noise, self.bias, how)
