"""Pixel filters: how the light around a pixel's middle is weighed.

Camera rays are drawn as densely as the filter weighs, so that each counts alike: pixels stay
independent of each other and keep their error bars. A filter with negative lobes, such as that of
Mitchell & Netravali (1988), is no density, and is not offered: it would have to weigh samples.

Reference:
    Ernst, Stamminger & Greiner (2006), "Filter importance sampling", IEEE Symposium on Interactive
    Ray Tracing.
"""

from typing import Annotated, Literal

from pydantic import Field

from scenes.fields import Number
from scenes.model import SceneModel

__all__ = ["BoxFilter", "GaussianFilter", "PixelFilter", "TentFilter"]

_Pixels = Annotated[Number, Field(gt=0, le=16)]


class BoxFilter(SceneModel):
    """All of the pixel's square alike, and nothing else: what a detector's element sees."""

    type: Literal["box"] = Field(default="box", description="the pixel's own square")


class TentFilter(SceneModel):
    """Falls linearly to zero, along rows and along columns."""

    type: Literal["tent"] = Field(default="tent", description="falls linearly to zero")
    reach: _Pixels = Field(
        default=1.0, description="where it is zero, more than 0, at most 16 pixels from the middle"
    )


class GaussianFilter(SceneModel):
    """A Gaussian of the distance, cut off where it is small."""

    type: Literal["gaussian"] = Field(default="gaussian", description="falls as a Gaussian")
    sigma: _Pixels = Field(
        default=0.5, description="standard deviation, more than 0, at most 16 pixels"
    )
    reach: _Pixels = Field(
        default=1.5,
        description="where it is cut off, more than 0, at most 16 pixels from the middle",
    )


PixelFilter = Annotated[BoxFilter | TentFilter | GaussianFilter, Field(discriminator="type")]
"""Any pixel filter."""
