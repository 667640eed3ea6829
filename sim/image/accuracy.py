"""How far a picture may be off, and why: noise from replicates, bias from a second kernel.

Passes are independent replicates, so the scatter of their means is the noise. The gather's kernel
blurs: what a kernel of half its area sees otherwise tells by how much, to second order in the
radius. That estimate is noisy itself, more than the picture is, and its noise is known the same
way; whatever is made of its square has that noise taken out.

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
        replicates: Independent estimates that were averaged.
    """

    luminance: FloatArray
    noise: FloatArray
    bias: FloatArray
    bias_noise: FloatArray
    replicates: int

    @property
    def relative_noise(self) -> float:
        """Root mean square of the noise over that of the luminance; NaN if it is not known."""
        return self._relative(_mean_square(self.noise))

    @property
    def relative_bias(self) -> float:
        """Root mean square of the bias over that of the luminance, its own noise taken out."""
        return self._relative(_mean_square(self.bias) - _mean_square(self.bias_noise))

    @property
    def relative_error(self) -> float:
        """Noise and bias together: the relative L² error of the luminance, as estimated."""
        return math.hypot(self.relative_noise, self.relative_bias)

    def half_width(self, level: float = 0.95) -> FloatArray:
        """Half of the interval that holds the true luminance with probability `level`.

        Student's t for the replicates there are, times the noise, and the bias so far as it is
        more than its own noise, added in squares. NaN from a single replicate.

        Args:
            level: Probability, between 0 and 1.
        """
        from scipy.stats import t

        quantile = float(t.ppf(0.5 + 0.5 * level, max(self.replicates - 1, 1)))
        bias2 = np.maximum(self.bias**2 - self.bias_noise**2, 0.0)
        half: FloatArray = np.sqrt((quantile * self.noise) ** 2 + bias2)
        return half

    def _relative(self, mean_square: float) -> float:
        scale = _mean_square(self.luminance)
        if scale == 0.0:
            return math.nan if math.isnan(mean_square) else 0.0
        return math.sqrt(max(mean_square, 0.0) / scale)


def _mean_square(values: FloatArray) -> float:
    return float(np.mean(np.square(values)))
