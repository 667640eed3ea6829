"""How far a picture may be off, and why: noise from replicates, bias from a second kernel.

Passes are independent replicates, so the scatter of their means is the noise. The gather's kernel
blurs: what a kernel of half its area sees otherwise tells by how much, to second order in the
radius. That estimate is noisy itself, more than the picture is, and its noise is known the same
way; whatever is made of its square has that noise taken out.

Intervals are those of the luminance less its bias, whose scatter is tallied as well: it is noisier
than the picture, but the truth lies inside as often as stated, blurred or not.

References:
    Student (1908), Biometrika 6, 1: the interval of a mean from few replicates.
    Schucany & Sommers (1977), JASA 72, 420: a kernel's bias from a second kernel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Accuracy"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Accuracy:
    """The luminance of a picture and how sure it is; every map has shape (height, width) [cd/m²].

    Attributes:
        luminance: The estimate, Y of the film's observer.
        noise: One standard deviation of it; NaN from a single replicate.
        bias: What the gather's blur has added, estimated.
        bias_noise: One standard deviation of that estimate.
        corrected_noise: One standard deviation of the luminance less its estimated bias.
        replicates: Independent estimates that were averaged.
    """

    luminance: FloatArray
    noise: FloatArray
    bias: FloatArray
    bias_noise: FloatArray
    corrected_noise: FloatArray
    replicates: int

    @property
    def relative_noise(self) -> float:
        """Root mean square over the pixels of noise / (luminance + the picture's mean luminance).

        The mean keeps dark pixels from counting for more than they show, and a focus that burns
        out counts for no more than its pixels. NaN from a single replicate.
        """
        return self._relative(self.noise**2)

    @property
    def relative_bias(self) -> float:
        """The same of the bias, its own noise taken out."""
        return self._relative(self.bias**2 - self.bias_noise**2)

    @property
    def relative_error(self) -> float:
        """Noise and bias together, as root mean square."""
        return math.hypot(self.relative_noise, self.relative_bias)

    def summary(self) -> dict[str, float | int | None]:
        """The picture's figures, ready for JSON; None where there is but one replicate."""
        figures = {
            "relative_error": self.relative_error,
            "relative_noise": self.relative_noise,
            "relative_bias": self.relative_bias,
        }
        known = {name: None if math.isnan(one) else one for name, one in figures.items()}
        return {**known, "replicates": self.replicates}

    def interval(self, level: float = 0.95) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest luminance between which the truth lies with probability `level`.

        Its middle is the luminance less its estimated bias, a jackknife in the radius, and its
        half width that one's noise, times Student's t for the replicates there are. NaN from a
        single replicate.

        Args:
            level: Probability, between 0 and 1.
        """
        from scipy.stats import t

        quantile = float(t.ppf(0.5 + 0.5 * level, max(self.replicates - 1, 1)))
        middle, half = self.luminance - self.bias, quantile * self.corrected_noise
        return middle - half, middle + half

    def _relative(self, squares: FloatArray) -> float:
        mean = float(np.mean(self.luminance))
        if mean == 0.0:
            return math.nan if self.replicates < 2 else 0.0
        return math.sqrt(max(float(np.mean(squares / (self.luminance + mean) ** 2)), 0.0))
