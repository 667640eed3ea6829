"""How far each pixel may be off, as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from sim.image.accuracy import Accuracy

__all__ = ["plot_error_map"]

_LOWEST, _HIGHEST = 1e-3, 1.0


def plot_error_map(accuracy: Accuracy) -> Figure:
    """Plot each pixel's standard error and bias together, relative to its luminance.

    Args:
        accuracy: Of the picture.

    Returns:
        The figure: colours on a logarithmic scale from 0.1 % to 100 %; grey where there is no
        light or no error is known.
    """
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure
    from matplotlib.ticker import PercentFormatter

    bias2 = np.maximum(accuracy.bias**2 - accuracy.bias_noise**2, 0.0)
    error = np.sqrt(accuracy.noise**2 + bias2)
    lit = accuracy.luminance > 0.0
    relative = np.divide(error, accuracy.luminance, out=np.full_like(error, np.nan), where=lit)
    height, width = relative.shape
    figure = Figure(figsize=(8.0, 7.0 * height / width + 0.6), dpi=120, layout="constrained")
    axes = figure.add_subplot()
    axes.set_facecolor("0.5")
    image = axes.imshow(
        np.clip(relative, _LOWEST, _HIGHEST), norm=LogNorm(_LOWEST, _HIGHEST), cmap="viridis",
        interpolation="nearest",
    )
    axes.set_xticks([])
    axes.set_yticks([])
    scale = figure.colorbar(image, ax=axes, format=PercentFormatter(1.0, decimals=1))
    scale.set_label("standard error and bias of the luminance")
    axes.set_title(
        f"{accuracy.relative_error:.2%} in all, from {accuracy.replicates} replicates"
    )
    return figure
